/** Bakes with the native program. */

import { spawn } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";
import { plain } from "./plain.js";
import type { BakeReport, Call } from "./types.js";

/** Exit codes with which a file is written. */
const WRITTEN = [0, 3, 4];

/** Runs the program; resolves with the file. */
export async function bakeNatively(program: string, { words, onProgress, onWarning, onReport, signal }: Call): Promise<Uint8Array> {
  const folder = await mkdtemp(path.join(tmpdir(), "rebounce-"));
  const [output, report] = [path.join(folder, "scene.rbn"), path.join(folder, "report.json")];
  const own = [`--output=${output}`, `--report=${report}`, "--json-progress"];
  try {
    await run(program, [...words.slice(0, 1), ...own, ...words.slice(1)], { onProgress, onWarning }, signal);
    onReport?.(JSON.parse(await readFile(report, "utf8")) as BakeReport);
    return new Uint8Array(await readFile(output));
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

/** Runs the program to its end. Rejects with what it says, and with the signal's reason. */
function run(
  program: string,
  words: string[],
  { onProgress, onWarning }: { [name in "onProgress" | "onWarning"]: Call[name] | undefined },
  signal: AbortSignal | undefined,
): Promise<void> {
  return new Promise((resolve, reject) => {
    const child = spawn(program, words, { stdio: ["ignore", "pipe", "pipe"] });
    const stop = (): void => void child.kill("SIGTERM");
    signal?.addEventListener("abort", stop, { once: true });
    const said: string[] = [];
    createInterface(child.stdout).on("line", (line) => {
      const { stage, fraction, seconds_left: secondsLeft } = JSON.parse(line) as { stage: string; fraction?: number; seconds_left?: number };
      if (fraction !== undefined) onProgress?.({ stage, ratio: fraction, secondsLeft: secondsLeft ?? 0 });
    });
    createInterface(child.stderr).on("line", (line) => {
      const sentence = /^(?:warning|note): (.*)/.exec(line)?.[1];
      if (sentence) onWarning?.(sentence);
      else said.push(line);
    });
    child.on("error", (error) => reject(new Error(`the native program does not start: ${error.message}`, { cause: error })));
    child.on("close", (code, killed) => {
      signal?.removeEventListener("abort", stop);
      if (signal?.aborted) reject(signal.reason);
      else if (code !== null && WRITTEN.includes(code)) resolve();
      else reject(new Error(plain(said.join("\n")) || `the native program ended with ${killed ?? `exit code ${code}`}`));
    });
  });
}
