#!/usr/bin/env node
/** The command: the native program where there is one, otherwise the baker as WebAssembly. */

import { spawn } from "node:child_process";
import { constants } from "node:os";
import { native, PLATFORM, type Native } from "./native.js";
import { VERSION } from "./version.js";
import { runCommand } from "./wasm/command.js";

/** Runs the native program; resolves with its exit code, or `undefined` if it does not start. */
function runNative(program: string, words: readonly string[]): Promise<number | undefined> {
  if (words[0] === "bake" && !words.some((word) => /^(-h|--help|-v|-V|--version)$/.test(word))) {
    process.stderr.write(`rebounce ${VERSION}: native program for ${PLATFORM}\n`);
  }
  return new Promise((resolve) => {
    const child = spawn(program, words, { stdio: "inherit" });
    // A terminal sends Ctrl-C to both; the program ends by itself.
    process.on("SIGINT", () => undefined);
    process.on("SIGTERM", () => child.kill("SIGTERM"));
    child.on("error", () => resolve(undefined));
    child.on("exit", (code, signal) => resolve(code ?? 128 + (signal ? constants.signals[signal] : 0)));
  });
}

const words = process.argv.slice(2);
let found: Native;
try {
  found = native();
  const code = found.program ? await runNative(found.program, words) : undefined;
  process.exitCode = code ?? (await runCommand(words, found.why ?? "the native program does not start"));
} catch (error) {
  process.stderr.write(`rebounce: ${error instanceof Error ? error.message : String(error)}\n`);
  process.exitCode = 1;
}
