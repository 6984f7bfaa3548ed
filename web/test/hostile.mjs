// node test/hostile.mjs WORK REBOUNCE COPIES SEED: damaged scenes through the baker as WebAssembly and the native program, which must come to
// the same: the same bytes, or the same sentence. Never a trap.

import { execFile } from "node:child_process";
import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { check, equal } from "./harness.mjs";

/** Scenes in every wrapping that is read, among them compressed and quantized meshes. */
const CASES = new URL("../../baker/tests/gltf/", import.meta.url);
/** Few functions: what is damaged is what is read. */
const SMALL = ["--preset", "draft", "--functions", "60", "--threads", "1"];
/** Numbers that are often forgotten. */
const ODD = ["-1", "0", "1", "5121", "5126", "65536", "1073741824", "4294967295", "4294967296", "18446744073709551615", "1e38", "1e308", "null", '"x"', "[]"];
/** Bytes that are turned over. */
const TURNED = 40;

/** Random bits of a seed (Marsaglia's xorshift). */
function* bits(seed) {
  for (let state = seed | 1; ; yield state >>> 0) {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
  }
}

/** Returns a damaged copy of a .glb: cut off, bytes turned over, or with odd numbers in its JSON. */
export function damaged(glb, seed) {
  const random = bits(seed * 2654435761);
  for (let i = 0; i < 8; i += 1) random.next();
  const below = (count) => random.next().value % count;
  const length = glb.readUInt32LE(12);
  const kind = below(8);
  if (kind === 0) return glb.subarray(0, below(glb.length));
  if (kind < 4) {
    const copy = Buffer.from(glb);
    // Behind the header, or all would be refused for its length.
    for (let i = 0; i < TURNED; i += 1) copy[20 + below(glb.length - 20)] ^= 1 << below(8);
    return copy;
  }
  let json = glb.subarray(20, 20 + length).toString("latin1");
  for (let i = 1 + below(3); i > 0; i -= 1) {
    const numbers = [...json.matchAll(/(?<=[[:,])-?\d[\d.e+-]*/g)];
    const { index, 0: old } = numbers[below(numbers.length)];
    json = json.slice(0, index) + ODD[below(ODD.length)] + json.slice(index + old.length);
  }
  return glbOf(Buffer.from(json.trimEnd(), "latin1"), glb.subarray(20 + length));
}

/** A .glb of a JSON and the chunks behind it. */
function glbOf(json, rest) {
  const padded = Buffer.concat([json, Buffer.alloc(-json.length & 3, " ")]);
  const header = Buffer.alloc(20);
  header.write("glTF");
  header.writeUInt32LE(2, 4);
  header.writeUInt32LE(20 + padded.length + rest.length, 8);
  header.writeUInt32LE(padded.length, 12);
  header.write("JSON", 16);
  return Buffer.concat([header, padded, rest]);
}

/** Sentences of what is a fault of ours. */
const FAULT = /fault of the baker|more memory|ended before/;

/**
 * Bakes `copies` damaged copies of each scene with both programs. `bake`: of the package; `bakeInPage`: of the viewer's package, whose
 * program is another build. Returns how many were refused, of how many.
 */
export async function bakeDamaged({ bake, bakeInPage, rebounce, work, copies, seed }) {
  const names = (await readdir(CASES)).filter((name) => name.endsWith(".glb"));
  check(names.length > 10, `${names.length} scenes`);
  await mkdir(work, { recursive: true });
  const [file, out] = [path.join(work, "damaged.glb"), path.join(work, "damaged.rbn")];
  let refused = 0;
  for (const [i, name] of names.entries()) {
    const whole = await readFile(new URL(name, CASES));
    for (let copy = 0; copy < copies; copy += 1) {
      const number = seed + copies * i + copy;
      const bytes = damaged(whole, number);
      await writeFile(file, bytes);
      const options = { preset: "draft", functions: 60, threads: 1, program: "wasm" };
      const asWasm = await bake(file, options).then((made) => ({ made }), ({ message }) => ({ message }));
      const natively = await promisify(execFile)(rebounce, ["bake", file, ...SMALL, "-o", out]).then(
        async () => ({ made: await readFile(out) }),
        ({ stderr }) => ({ message: stderr.split("\n").filter((line) => !/^(warning|note): |^ *\d+%, /.test(line)).join("\n").replace(/^rebounce: /, "").trim() }),
      );
      const which = `${name}, copy ${number}`;
      const inPage = await bakeInPage(bytes, { preset: "draft", functions: 60, workers: 1, name }).then(() => "", ({ message }) => message);
      for (const message of [asWasm.message ?? "", inPage]) check(!FAULT.test(message), `${which}: ${message}`);
      equal(inPage === "", asWasm.message === undefined, `${which}: whether a page bakes it (${inPage})`);
      // WebAssembly refuses a number beyond 32 bits where it reads it, the native program where it uses it, if it does.
      if (/expected usize/.test(asWasm.message ?? "")) {
        refused += 1;
        continue;
      }
      equal(asWasm.message, natively.message, `${which}: what is said`);
      check(!natively.made || natively.made.equals(asWasm.made), `${which}: other bytes`);
      refused += Number(natively.message !== undefined);
    }
  }
  return { refused, count: names.length * copies };
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [work, rebounce, copies, seed] = process.argv.slice(2);
  const { bake } = await import(new URL("../../baker/npm/dist/index.js", import.meta.url).href);
  const { bake: bakeInPage } = await import(new URL("../dist/bake.js", import.meta.url).href);
  const { refused, count } = await bakeDamaged({ bake, bakeInPage, rebounce, work, copies: Number(copies), seed: Number(seed) });
  console.log(`${count} damaged scenes: ${refused} refused, ${count - refused} baked, the same with both programs`);
}
