// How `cargo xtask soak` tells a leak from what goes up and down by itself.

import { equal } from "../harness.mjs";
import { grown } from "../soak.mjs";

/** Runs the tests. */
export async function soak(harness) {
  /** An hour of samples, after one as it is before anything has settled. */
  const hour = (sample) => [{ wasm: 1, gpu: 1, alive: 1, heap: 1, processes: 1 }, ...Array.from({ length: 60 }, (_, i) => sample(i))];
  // As measured: up and down, a spike now and then.
  const steady = (i) => ({ wasm: 7e6, gpu: 4e7 - (i % 3) * 1e6, alive: 44, heap: 2e6 + (i % 5) * 4e4, processes: 3e8 + (i % 7 === 0 ? 1e8 : i % 4) });
  const names = (samples) => grown(samples).map((text) => text.split(" ")[0]).join(" ");

  await harness.test("soak::what_goes_up_and_down_is_no_growth", () => {
    equal(names(hour(steady)), "", "what has grown");
  });

  await harness.test("soak::a_leak_is_found_in_each_figure", () => {
    // A minute's worth: a page of wasm, a texture, a buffer, some objects a frame, half a megabyte of a process.
    const leaks = { wasm: 65536, gpu: 1e4, alive: 1, heap: 1e4, processes: 5e5 };
    for (const [name, bytes] of Object.entries(leaks)) {
      const leaking = (i) => ({ ...steady(i), [name]: steady(i)[name] + i * bytes });
      equal(names(hour(leaking)), name, "what has grown");
    }
  });

  await harness.test("soak::a_system_that_does_not_tell_of_processes_is_no_leak", () => {
    equal(names(hour((i) => ({ ...steady(i), processes: undefined }))), "", "what has grown");
  });
}
