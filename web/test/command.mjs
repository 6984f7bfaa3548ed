// The npm package of the command, from its tarballs: the command, the function and the plugin, with the native program and as
// WebAssembly. Both do the same, to the byte.

import { execFile, spawn } from "node:child_process";
import { cp, mkdir, readFile, readdir, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { within } from "./browser.mjs";
import { block } from "./guide.mjs";
import { check, equal, same } from "./harness.mjs";
import { bakeDamaged } from "./hostile.mjs";

/** Few functions, so that a bake takes seconds. */
const SMALL = ["--preset", "draft", "--functions", "1500"];
const QUIET = ["--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"];
const NATIVE = { REBOUNCE_PROGRAM: "native" };
const WASM = { REBOUNCE_PROGRAM: "wasm" };

/** Runs the tests. `tools`: what the tests of the packages share. */
export async function commandTests(harness, { work, rebounce, command, native, viewer, tools }) {
  const folder = await tools.install("command", [viewer, command, native]);
  const bare = path.join(work, "apps/command-bare");
  const run = (words, env, cwd = folder) => ended(path.join(folder, "node_modules/.bin/rebounce"), words, { cwd, env });
  await cp(tools.scene.glb, path.join(folder, "room.glb"));
  const expected = async (words) => {
    const out = path.join(work, "expected.rbn");
    await tools.exec(rebounce, ["bake", "room.glb", ...words, "-o", out], { cwd: folder });
    return readFile(out);
  };

  await harness.test("command::the_package_holds_its_programs_types_and_papers_and_nothing_else", async () => {
    const { stdout } = await tools.exec("tar", ["-tzf", command]);
    const files = stdout.split("\n").filter(Boolean).map((file) => file.replace(/^package\//, ""));
    const known = /^(package\.json|README\.md|LICENSE-\w+|client\.d\.ts|dist\/[\w-]+\.(js|wasm|d\.ts))$/;
    equal(files.filter((file) => !known.test(file)).join(" "), "", "files that do not belong there");
    const { exports, bin } = JSON.parse(await readFile(path.join(folder, "node_modules/rebounce-cli/package.json"), "utf8"));
    const targets = Object.values(exports).flatMap((target) => (typeof target === "string" ? [target] : Object.values(target)));
    const missing = [...targets, ...Object.values(bin)].filter((target) => !files.includes(target.replace(/^\.\//, "")));
    equal(missing.join(" "), "", "files that package.json names and the package lacks");
  });

  await harness.test("command::the_native_program_and_webassembly_write_the_bytes_of_rebounce_and_say_who_they_are", async () => {
    const bytes = await expected(SMALL);
    for (const [env, says] of [[NATIVE, /^rebounce [\d.]+: native program for linux-x64\n/], [WASM, /^rebounce [\d.]+: WebAssembly on linux-x64, \d+ workers?; it was chosen\n/]]) {
      const { code, stdout, stderr } = await run(["bake", "room.glb", ...SMALL], env);
      equal(code, 0, stderr);
      check(says.test(stderr), stderr);
      check(/^scene  .*\nwrote         room\.rbn\n$/s.test(stdout), stdout);
      check(bytes.equals(await readFile(path.join(folder, "room.rbn"))), `other bytes: ${says}`);
      await rm(path.join(folder, "room.rbn"));
    }
  });

  await harness.test("command::without_the_native_package_webassembly_bakes", async () => {
    await rm(bare, { recursive: true, force: true });
    await mkdir(bare, { recursive: true });
    await writeFile(path.join(bare, "package.json"), "{}");
    await tools.exec("npm", ["install", "--omit=optional", ...QUIET, command], { cwd: bare });
    await cp(tools.scene.glb, path.join(bare, "room.glb"));
    const { code, stderr } = await ended("npx", ["--no-install", "rebounce-cli", "bake", "room.glb", ...SMALL], { cwd: bare });
    equal(code, 0, stderr);
    check(/: WebAssembly on linux-x64, .*; there is no native program for linux-x64 here \(package rebounce-cli-linux-x64\)/.test(stderr), stderr);
    check((await expected(SMALL)).equals(await readFile(path.join(bare, "room.rbn"))), "other bytes");
    const other = await ended("npx", ["--no-install", "rebounce-cli", "info", "room.rbn"], { cwd: bare });
    equal(other.code, 2, "exit code of a verb that is not there");
    check(/info is a verb of the native program alone/.test(other.stderr), other.stderr);
    const wanted = await ended("npx", ["--no-install", "rebounce-cli", "bake", "room.glb"], { cwd: bare, env: NATIVE });
    equal(wanted.code, 1, wanted.stderr);
  });

  await harness.test("command::help_and_what_goes_wrong_are_the_same_with_both_programs", async () => {
    await mkdir(path.join(folder, "sub"), { recursive: true });
    await writeFile(path.join(folder, "broken.glb"), "glTF, but not really");
    await writeFile(path.join(folder, "black.hdr"), hdr(4, 2, () => [0, 0, 0, 0]));
    await writeFile(path.join(folder, "shot.json"), '{"camera": {"colour": 1}}');
    await writeFile(path.join(folder, "baked.rbn"), await expected(SMALL));
    const cases = [
      ["bake", "--help"],
      ["bake", "-h"],
      ["bake"],
      ["bake", "room.glb", "--presett", "draft"],
      ["bake", "room.glb", "--preset", "best"],
      ["bake", "room.glb", "--functions", "many"],
      ["bake", "room.glb", "--viewpoint", "1,2"],
      ["bake", "room.glb", "--environment-rotation", "20"],
      ["bake", "none.glb"],
      ["bake", "broken.glb"],
      ["bake", "baked.rbn"],
      ["bake", "builtin:nowhere"],
      ["bake", "room.glb", "-o", "none/room.rbn"],
      ["bake", "room.glb", "-o", "room.glb"],
      ["bake", "room.glb", "-o", "sub/../room.rbn", "--report", "room.txt"],
      ["bake", "room.glb", "--scene", "9"],
      ["bake", "room.glb", "--environment", "black.hdr"],
      ["bake", "room.glb", "--environment", "none.hdr"],
      ["bake", "room.glb", "--shot", "shot.json"],
      ["bake", "room.glb", "--max-bytes", "1K"],
    ];
    for (const words of cases) {
      const [a, b] = [await run(words, NATIVE), await run(words, WASM)];
      const own = (text) => text.replace(/^rebounce [\d.]+: (native program|WebAssembly).*\n/, "").replace(/ \(os error \d+\)/g, "").toLowerCase();
      const line = words.join(" ");
      equal(b.code, a.code, `${line}: exit code (${b.stderr})`);
      check(a.code !== 0 || words.some((word) => word.startsWith("-h") || word === "--help"), `${line} works`);
      equal(own(b.stdout), own(a.stdout), `${line}: standard output`);
      equal(own(b.stderr), own(a.stderr), `${line}: standard error`);
    }
    for (const option of [["--resume"], ["--target-error", "0.1"]]) {
      const { code, stderr } = await run(["bake", "room.glb", ...option], WASM);
      check(code === 2 && stderr.includes(`${option[0]} is an option of the native program alone`), stderr);
    }
  });

  await harness.test("command::options_mean_the_same_with_both_programs", async () => {
    await writeFile(path.join(folder, "sky.hdr"), hdr(8, 4, (x, y) => [40 + 20 * x, 90, 30 + 40 * y, 129]));
    const camera = { position: [0.2, 1, 2], target: [0, 1, 0], yfov_deg: 50 };
    await writeFile(path.join(folder, "view.json"), JSON.stringify({ camera, lights: [] }));
    const cases = [
      ["--environment", "sky.hdr", "--environment-rotation", "30", "--environment-intensity", "2", "--shot", "view.json", "--seed", "7"],
      ["--sky", "48,172,15.5", "--viewpoint", "0,1,0", "--viewpoint", "-0.2,0.5,0.1", "--levels", "4", "--rays", "64,32", "--epsilon", "0.03"],
      ["--no-sources", "--max-bytes", "200K", "--bounces", "2", "--albedo", "0.5", "--significance", "2", "--fine-overlap", "1.8"],
    ];
    for (const words of cases) {
      const files = [];
      const notes = [];
      for (const env of [NATIVE, WASM]) {
        const { code, stderr } = await run(["bake", "room.glb", ...SMALL, ...words, "--report", "report.json"], env);
        equal(code, 0, `${words.join(" ")}: ${stderr}`);
        files.push(await readFile(path.join(folder, "room.rbn")));
        notes.push(stderr.split("\n").filter((line) => /^(warning|note): /.test(line)).join("\n"));
        const { functions, file_bytes: bytes } = JSON.parse(await readFile(path.join(folder, "report.json"), "utf8"));
        check(functions > 0 && bytes === files.at(-1).length, `the report says ${functions} functions, ${bytes} bytes`);
      }
      check(files[0].equals(files[1]), `other bytes with ${words.join(" ")}`);
      equal(notes[1], notes[0], `warnings and notes with ${words.join(" ")}`);
    }
  });

  await harness.test("command::progress_for_programs_has_the_same_members", async () => {
    const of = async (env) => {
      const { code, stdout, stderr } = await run(["bake", "room.glb", ...SMALL, "--json-progress"], env);
      equal(code, 0, stderr);
      const lines = stdout.trim().split("\n").map((line) => JSON.parse(line));
      const last = lines.at(-1);
      check(last.stage === "done" && last.fraction === 1, stdout);
      for (const [i, { fraction }] of lines.entries()) check(i === 0 || fraction >= lines[i - 1].fraction, "the fraction falls");
      return { members: Object.keys(last), stages: [...new Set(lines.map(({ stage }) => stage))].sort() };
    };
    same(await of(WASM), await of(NATIVE), "members and stages");
    const failed = await run(["bake", "broken.glb", "--json-progress"], WASM);
    equal(JSON.parse(failed.stdout.trim()).stage, "failed", failed.stdout);
  });

  await harness.test("command::ctrl_c_ends_webassembly_with_130_and_leaves_no_file", async () => {
    await rm(path.join(folder, "room.rbn"), { force: true });
    for (const [signal, code] of [["SIGINT", 130], ["SIGTERM", 143]]) {
      const child = spawn(process.execPath, ["node_modules/rebounce-cli/dist/bin.js", "bake", "room.glb", "--preset", "standard", "--json-progress"], {
        cwd: folder,
        env: { ...process.env, ...WASM },
      });
      let stdout = "";
      const begun = new Promise((resolve) => child.stdout.on("data", (data) => ((stdout += data), resolve())));
      const end = new Promise((resolve) => child.on("close", resolve));
      await within("the first line", begun);
      child.kill(signal);
      equal(await within("the end", end), code, "exit code");
      equal(JSON.parse(stdout.trim().split("\n").at(-1)).stage, "stopped", stdout);
      const left = (await readdir(folder)).filter((name) => /room\.(rbn|preview)|\.tmp$/.test(name));
      equal(left.join(), "", "files that are left");
    }
  });

  await harness.long("command::the_scripts_of_the_guide_bake", async () => {
    const bytes = await expected(["--preset", "draft", "--max-bytes", "4M"]);
    for (const file of ["bake.mjs", "optimise.mjs"]) await writeFile(path.join(folder, file), await block("npm.md", file));
    const baked = await ended(process.execPath, ["bake.mjs"], { cwd: folder, env: WASM });
    equal(baked.code, 0, baked.stderr);
    check(/^\d+%, .*, \d+ s left$/m.test(baked.stdout) && /^\d+ functions, \d+ links$/m.test(baked.stdout), baked.stdout);
    check(bytes.equals(await readFile(path.join(folder, "room.rbn"))), "other bytes");
    // The package of the viewer bakes in Node.js, too.
    await writeFile(path.join(folder, "node.mjs"), await block("in-the-page.md", "node.mjs"));
    await tools.exec(process.execPath, ["node.mjs"], { cwd: folder });
    check((await expected(["--preset", "draft"])).equals(await readFile(path.join(folder, "room.rbn"))), "other bytes with the viewer's package");
    const { code, stderr } = await ended(process.execPath, ["optimise.mjs"], { cwd: folder });
    equal(code, 0, stderr);
    const { stdout } = await tools.exec(rebounce, ["info", "optimised.rbn"], { cwd: folder });
    check(/^links +\d+/m.test(stdout), stdout);
  });

  await harness.test("command::a_scene_in_memory_has_the_bytes_of_the_file", async () => {
    const { bake } = await import(pathToFileURL(path.join(folder, "node_modules/rebounce-cli/dist/index.js")).href);
    const options = { preset: "draft", functions: 1500, rays: [64, 32] };
    const scene = await readFile(path.join(folder, "room.glb"));
    const bytes = await expected(["--preset", "draft", "--functions", "1500", "--rays", "64,32"]);
    const { json, binary } = split(scene);
    for (const program of ["native", "wasm"]) {
      const told = [];
      const whole = await bake(scene, { ...options, program, name: "room.glb", onProgram: (it) => told.push(it) });
      check(bytes.equals(whole), `other bytes of the .glb (${program})`);
      equal(told.join(), program, "what is told");
      const parts = await bake(new TextEncoder().encode(json), { ...options, program, name: "room.gltf", files: { "parts/room.bin": binary } });
      check(bytes.equals(parts), `other bytes of the .gltf with its file (${program})`);
      const refused = async (more, what = scene) => bake(what, { ...options, program, ...more }).then(() => "baked", (error) => error);
      check((await refused({ speed: 3 })) instanceof TypeError, "an unknown option");
      check((await refused({ functions: {} })) instanceof TypeError, "a value that is none");
      check((await refused({ files: { "../x.bin": binary } })) instanceof TypeError, "a file outside");
      check(/many/.test((await refused({ functions: "many" })).message), "a wrong number");
      check(/none\.glb/.test((await refused({}, path.join(folder, "none.glb"))).message), "a file that is not there");
      const why = new Error("enough");
      equal(await refused({ signal: AbortSignal.abort(why) }), why, "the reason");
      const stop = new AbortController();
      equal(await refused({ functions: 50_000, signal: stop.signal, onProgress: () => stop.abort(why) }), why, "the reason, while baking");
    }
  });

  await harness.long("command::damaged_scenes_come_to_the_same_with_both_programs", async () => {
    const [{ bake }, { bake: bakeInPage }] = await Promise.all(
      ["rebounce-cli/dist/index.js", "rebounce-viewer/dist/bake.js"].map((file) => import(pathToFileURL(path.join(folder, "node_modules", file)).href)),
    );
    const { refused, count } = await bakeDamaged({ bake, bakeInPage, rebounce, work: path.join(work, "hostile"), copies: 4, seed: 1 });
    check(refused > 0 && refused < count, `${refused} of ${count} are refused`);
  });

  await harness.test("command::the_vite_app_of_the_guide_bakes_once_and_shows_the_scene", async () => {
    for (const file of ["vite.config.js", "main.js", "index.html"]) await writeFile(path.join(folder, file), await block("npm.md", file));
    await rm(path.join(folder, "node_modules/.vite"), { recursive: true, force: true });
    // Few functions: the app of the guide has the preset's.
    const config = (await block("npm.md", "vite.config.js")).replace("rebounce()", "rebounce({ functions: 1500 })");
    check(config.includes("1500"), "the guide's configuration is another than this test knows");
    await writeFile(path.join(folder, "vite.config.js"), config);
    const build = () => tools.exec(process.execPath, ["node_modules/vite/bin/vite.js", "build"], { cwd: folder });
    const [first, second] = [await build(), await build()];
    check(/rebounce: baking room\.glb \(standard, native\)/.test(first.stdout), first.stdout);
    check(!/baking/.test(second.stdout), `it is baked again:\n${second.stdout}`);
    const assets = await readdir(path.join(folder, "dist/assets"));
    const baked = assets.find((name) => /^room-.*\.rbn$/.test(name));
    check(baked, `no scene among ${assets.join(" ")}`);
    check((await expected(["--functions", "1500"])).equals(await readFile(path.join(folder, "dist/assets", baked))), "other bytes");
    await tools.served(path.join(folder, "dist"));
    await tools.developed(folder);
    // A scene that changes is baked again; one that cannot be baked ends the build with the reason.
    await writeFile(path.join(folder, "room.glb"), "glTF, but not really");
    const failed = await ended(process.execPath, ["node_modules/vite/bin/vite.js", "build"], { cwd: folder });
    check(failed.code !== 0 && /room\.glb/.test(failed.stderr), `${failed.code}: ${failed.stderr}`);
    await cp(tools.scene.glb, path.join(folder, "room.glb"));
  });

  await harness.test("command::typescript_knows_options_and_imports", async () => {
    await tools.exec(process.execPath, ["node_modules/typescript/bin/tsc", "--project", "tsconfig.json"], { cwd: folder });
  });
}

/** Runs a program to its end, whatever its exit code. */
async function ended(program, words, { cwd, env = {} }) {
  try {
    const { stdout, stderr } = await promisify(execFile)(program, words, { cwd, env: { ...process.env, ...env }, maxBuffer: 1 << 26 });
    return { code: 0, stdout, stderr };
  } catch (error) {
    if (error.stdout === undefined) throw error;
    return { code: error.code, stdout: error.stdout, stderr: error.stderr };
  }
}

/** A picture in the RGBE format, without compression. */
function hdr(width, height, texel) {
  const texels = Array.from({ length: width * height }, (_, i) => texel(i % width, Math.floor(i / width))).flat();
  return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`), Buffer.from(texels)]);
}

/** The JSON of a .glb with its binary chunk as a file of its own, and that. */
function split(glb) {
  const length = glb.readUInt32LE(12);
  const json = JSON.parse(glb.subarray(20, 20 + length).toString());
  const at = 20 + length + 8;
  json.buffers[0].uri = "parts/room.bin";
  return { json: JSON.stringify(json), binary: Uint8Array.from(glb.subarray(at, at + json.buffers[0].byteLength)) };
}
