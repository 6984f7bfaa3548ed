/** The native program, where there is one for this machine. */

import { accessSync, constants } from "node:fs";
import { createRequire } from "node:module";

/** What bakes: the native program, or why there is none. */
export type Native = { program: string; why?: undefined } | { program?: undefined; why: string };

/** Name of this machine, as in the names of the packages: `linux-x64`. */
export const PLATFORM = `${process.platform}-${process.arch}`;

/** Variable of the environment that chooses the program: `native` or `wasm`. */
const CHOICE = "REBOUNCE_PROGRAM";

/**
 * Finds the native program. `choice`: `"wasm"` wants none, `"native"` no other; the environment's variable REBOUNCE_PROGRAM when absent. Throws where the
 * native program is wanted and not there.
 */
export function native(choice = process.env[CHOICE] ?? ""): Native {
  if (choice === "wasm") return { why: "it was chosen" };
  if (choice && choice !== "native") throw new Error(`${CHOICE} is "native" or "wasm", not ${JSON.stringify(choice)}`);
  const found = search();
  if (choice === "native" && !found.program) throw new Error(`the native program cannot run: ${found.why}`);
  return found;
}

function search(): Native {
  const name = `rebounce-cli-${PLATFORM}`;
  const none = `there is no native program for ${PLATFORM} here (package ${name})`;
  // Programs for glibc do not run with another C library.
  const { header } = process.report.getReport() as unknown as { header: { glibcVersionRuntime?: string } };
  if (process.platform === "linux" && !header.glibcVersionRuntime) return { why: `${none}: this Linux has no glibc` };
  try {
    const program = createRequire(import.meta.url).resolve(`${name}/bin/rebounce${process.platform === "win32" ? ".exe" : ""}`);
    accessSync(program, constants.X_OK);
    return { program };
  } catch {
    return { why: none };
  }
}
