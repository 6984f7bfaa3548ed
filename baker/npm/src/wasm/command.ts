/** The command `rebounce bake` with the baker as WebAssembly. */

import { rmSync } from "node:fs";
import { PLATFORM } from "../native.js";
import { VERSION } from "../version.js";
import { writeWhole } from "../write.js";
import { bakeInWorkers, parsed, workersFor, type Next, type Tidings } from "./bake.js";

/** Columns of the bar. */
const BAR = 30;

/** Runs the command; resolves with the exit code. `why`: the reason why the native program does not run. */
export async function runCommand(words: readonly string[], why: string): Promise<number> {
  const next = await parsed(words, [], process.stderr.isTTY ?? false);
  if (next.do === "print") {
    (next.isError ? process.stderr : process.stdout).write(next.text);
    return next.code;
  }
  const size = await workersFor(next.workers);
  process.stderr.write(`rebounce ${VERSION}: WebAssembly on ${PLATFORM}, ${size} ${size === 1 ? "worker" : "workers"}; ${why}\n`);
  onSignals(next);
  const isBar = (process.stderr.isTTY ?? false) && !next.isJson;
  const clear = (): void => void (isBar && process.stderr.write("\r\x1b[K"));
  try {
    const done = await bakeInWorkers(words, [], size, (tidings) => show(tidings, next, isBar, clear));
    clear();
    writeWhole(next.output, done.file);
    if (next.preview) rmSync(next.preview, { force: true });
    if (next.report) writeReport(next.report, next.output, done.report);
    if (next.isJson) process.stdout.write(`${done.lastLine}\n`);
    else process.stdout.write(`${done.summary}\nwrote         ${next.output}\n`);
    return 0;
  } catch (error) {
    clear();
    const message = error instanceof Error ? error.message : String(error);
    process.stderr.write(`rebounce: ${message}\n`);
    if (next.isJson) process.stdout.write(`${JSON.stringify({ stage: "failed", error: message })}\n`);
    return 1;
  }
}

function writeReport(file: string, output: string, report: string): void {
  try {
    writeWhole(file, new TextEncoder().encode(report));
  } catch (error) {
    throw new Error(`${output} is written, its report is not: ${(error as Error).message}`, { cause: error });
  }
}

function show(tidings: Tidings, next: Next & { do: "bake" }, isBar: boolean, clear: () => void): void {
  switch (tidings.type) {
    case "line":
      if (tidings.isJson) process.stdout.write(`${tidings.text}\n`);
      else if (!isBar) process.stderr.write(`${tidings.text}\n`);
      break;
    case "progress":
      if (isBar) {
        const { stage, ratio, secondsLeft } = tidings;
        const done = "=".repeat(Math.round(BAR * ratio)).padEnd(BAR);
        process.stderr.write(`\r\x1b[K[${done}] ${Math.round(100 * ratio)}%, ${stage}, ${Math.round(secondsLeft)} s left`);
      }
      break;
    case "preview":
      if (next.preview) writeWhole(next.preview, tidings.file);
      break;
    default:
      clear();
      process.stderr.write(`${tidings.type}: ${tidings.sentence}\n`);
  }
}

/** Ends the program at Ctrl-C and SIGTERM, with the exit codes that shells expect. */
function onSignals({ isJson }: Next & { do: "bake" }): void {
  for (const [signal, code] of [["SIGINT", 130], ["SIGTERM", 143]] as const) {
    process.once(signal, () => {
      process.stderr.write("rebounce: stopped; nothing of the bake is kept: only the native program goes on with --resume\n");
      if (isJson) process.stdout.write(`${JSON.stringify({ stage: "stopped", checkpoint: null })}\n`);
      process.exit(code);
    });
  }
}
