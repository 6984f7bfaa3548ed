/** Writes files: the whole file, or no change. */

import { closeSync, existsSync, fsyncSync, mkdtempSync, openSync, renameSync, rmSync, statSync, writeSync } from "node:fs";
import path from "node:path";

/** Why a file cannot be written; `undefined` if it can: what `CommandHost` of baker/wasm expects. */
export function placeProblem(file: string): string | undefined {
  const there = statSync(file, { throwIfNoEntry: false });
  if ((there && !there.isFile()) || path.basename(file) === "") return "not-a-file";
  const folder = path.dirname(file);
  if (!statSync(folder, { throwIfNoEntry: false })?.isDirectory()) return "no-folder";
  try {
    rmSync(mkdtempSync(path.join(folder, `.${path.basename(file)}.`)), { recursive: true });
    return undefined;
  } catch (error) {
    return (error as NodeJS.ErrnoException).code ?? String(error);
  }
}

/** Writes to a file beside it and renames that. Throws an error with a sentence; then the file is as it was before. */
export function writeWhole(file: string, bytes: Uint8Array): void {
  const beside = path.join(path.dirname(file), `.${path.basename(file)}.${process.pid}.tmp`);
  try {
    const handle = openSync(beside, "w");
    try {
      for (let at = 0; at < bytes.length; ) at += writeSync(handle, bytes, at);
      fsyncSync(handle);
    } finally {
      closeSync(handle);
    }
    renameSync(beside, file);
  } catch (error) {
    if (existsSync(beside)) rmSync(beside, { force: true });
    throw new Error(`${file}: ${(error as Error).message}; the file is as it was before`, { cause: error });
  }
}
