//! The verbs of the command line, one a file. They read arguments, call the library and print.

pub mod bake;
