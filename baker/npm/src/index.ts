/** Bakes scenes from scripts: with the native program where there is one, otherwise with the baker as WebAssembly. */

import { mkdir, mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { bakeNatively } from "./by-native.js";
import { native } from "./native.js";
import { plain } from "./plain.js";
import type { BakeOptions, BakeReport, Call, SceneSource } from "./types.js";
import { bakeInWorkers, parsed, workersFor } from "./wasm/bake.js";
import { words } from "./words.js";

export type { CommandOptions } from "./options.js";
export type { BakeOptions, BakeProgress, BakeReport, Program, SceneSource } from "./types.js";
export { VERSION as version } from "./version.js";

/**
 * Bakes a scene; resolves with the .rbn file. Rejects with an error whose message is a sentence, and with the signal's reason when that aborts.
 */
export async function bake(scene: SceneSource, options: BakeOptions = {}): Promise<Uint8Array> {
  const { name, files, program, onProgram, onProgress, onWarning, onReport, signal, ...command } = options;
  signal?.throwIfAborted();
  const flags = words(command);
  const found = native(program);
  onProgram?.(found.program ? "native" : "wasm");
  const call = (spec: string): Call => {
    const told = { onProgress, onWarning, onReport, signal };
    return { words: ["bake", ...flags, "--", spec], ...(Object.fromEntries(Object.entries(told).filter(([, one]) => one)) as Omit<Call, "words">) };
  };
  if (typeof scene === "string" || scene instanceof URL) {
    const spec = scene instanceof URL ? fileURLToPath(scene) : scene;
    return found.program ? bakeNatively(found.program, call(spec)) : bakeAsWasm(call(spec), []);
  }
  const all = kept(name ?? "scene.glb", scene, files ?? {});
  if (!found.program) return bakeAsWasm(call(all[0]![0]), all);
  const folder = await mkdtemp(path.join(tmpdir(), "rebounce-"));
  try {
    for (const [file, bytes] of all) {
      await mkdir(path.dirname(path.join(folder, file)), { recursive: true });
      await writeFile(path.join(folder, file), bytes);
    }
    return await bakeNatively(found.program, call(path.join(folder, all[0]![0])));
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

/** The files of a scene that is given as bytes, by path; the scene's own first. */
function kept(name: string, scene: Uint8Array | ArrayBuffer, files: NonNullable<BakeOptions["files"]>): [string, Uint8Array][] {
  return [[name, scene] as const, ...Object.entries(files)].map(([file, bytes]) => {
    const plain = path.normalize(file);
    if (path.isAbsolute(plain) || plain.split(path.sep).includes("..")) {
      throw new TypeError(`bake: the file ${JSON.stringify(file)} is outside of the scene's folder`);
    }
    return [plain, bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes)];
  });
}

async function bakeAsWasm({ words: line, onProgress, onWarning, onReport, signal }: Call, files: [string, Uint8Array][]): Promise<Uint8Array> {
  // Nothing is written.
  const next = await parsed([...line.slice(0, 1), `--output=${path.join(tmpdir(), "scene.rbn")}`, ...line.slice(1)], files, false);
  if (next.do === "print") throw new Error(plain(next.text));
  let ratio = 0;
  const told = (one: Parameters<Parameters<typeof bakeInWorkers>[3]>[0]): void => {
    if (one.type === "warning" || one.type === "note") onWarning?.(one.sentence);
    if (one.type !== "progress") return;
    // The estimate of the time left may grow; what is done does not become less.
    ratio = Math.max(ratio, one.ratio);
    onProgress?.({ stage: one.stage, ratio, secondsLeft: one.secondsLeft });
  };
  const done = await bakeInWorkers(line, files, await workersFor(next.workers), told, signal);
  onReport?.(JSON.parse(done.report) as BakeReport);
  return done.file;
}
