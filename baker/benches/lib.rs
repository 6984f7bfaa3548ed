//! Benchmarks of the baker; `cargo bench --package rebounce-benches --bench kernels` runs one.
