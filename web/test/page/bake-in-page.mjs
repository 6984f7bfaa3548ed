// Scenes baked in the page and in Node.js, by workers: the bytes of the command, and what goes wrong.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { Worker } from "node:worker_threads";
import { exec } from "../agreement.mjs";
import { check, equal } from "../harness.mjs";
import { serveFolder } from "../serve.mjs";

const DIST = path.resolve("dist");
/** A plate, a wall and a tube. */
const STEP = path.resolve("../baker/tests/step/tube.step");
/** Few functions, so that a bake takes seconds; several levels, so that workers share all kinds of parts. */
const SMALL = { preset: "draft", functions: 2000 };
/** Writes the Cornell box as a .glb file with its materials. */
export async function cornellBox({ work, rebounce, baked }) {
  const file = path.join(work, "box.glb");
  await exec(rebounce, ["export", baked, "--lightmap-texture", "--max-size", "64", "-o", file]);
  return file;
}

/** Bakes with the command; its bytes. */
export async function commandBake({ work, rebounce }, file, { preset, functions, seed, solver, groups = {} }) {
  const out = path.join(work, "of-command.rbn");
  const single = [functions && ["--functions", String(functions)], seed && ["--seed", String(seed)], solver && ["--solver", solver]];
  const more = [...single.filter(Boolean).flat(), ...Object.entries(groups).flatMap(([name, density]) => ["--group", `${name}=${density}`])];
  await exec(rebounce, ["bake", file, "--preset", preset, ...more, "-o", out]);
  return readFile(out);
}

/** Opens a page of the folder that has the baker; in it, `bakeBytes` bakes base64 and gives base64. */
async function opened(browser, address) {
  const page = await browser.newPage();
  await page.goto(`${address}integrity.json`);
  await page.evaluate(async () => {
    const { bake } = await import("/bake.js");
    globalThis.bake = bake;
    globalThis.bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    globalThis.textOf = (bytes) => {
      let text = "";
      for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
      return btoa(text);
    };
  });
  return page;
}

/** In a page: `running` holds its workers from their first message to their end. */
export function countWorkers() {
  globalThis.running = new Set();
  const { terminate, postMessage } = Worker.prototype;
  Worker.prototype.postMessage = function (...args) {
    running.add(this);
    return postMessage.apply(this, args);
  };
  Worker.prototype.terminate = function () {
    running.delete(this);
    return terminate.apply(this);
  };
}

/** Bakes in the page; its bytes. */
async function inPage(page, file, options) {
  const scene = (await readFile(file)).toString("base64");
  const text = await page.evaluate(
    async ([scene, options]) => textOf(await bake(bytesOf(scene), options)),
    [scene, { ...options, name: path.basename(file) }],
  );
  return Buffer.from(text, "base64");
}

/** Runs the tests. */
export async function bakeInPage(harness, context) {
  const served = await serveFolder(DIST);
  const { bake } = await import(path.join(DIST, "bake.js"));
  const file = await cornellBox(context);
  const scene = new Uint8Array(await readFile(file));
  const name = path.basename(file);
  try {
    const page = await opened(context.browser, served.address);
    for (const workers of [1, 2, 3]) {
      const kind = workers === 3 ? "long" : "test";
      await harness[kind](`bake-in-page::${workers}_workers_make_the_bytes_of_the_command`, async () => {
        const options = { ...SMALL, seed: workers };
        const expected = await commandBake(context, file, options);
        check((await inPage(page, file, { ...options, workers })).equals(expected), "other bytes in the page");
        check(Buffer.from(await bake(scene, { ...options, workers, name })).equals(expected), "other bytes in Node.js");
      });
    }

    await harness.test("bake-in-page::a_step_file_has_the_bytes_of_the_command_and_a_baker_of_its_own", async () => {
      const asked = [];
      page.on("request", (request) => asked.push(path.basename(new URL(request.url()).pathname)));
      const expected = await commandBake(context, STEP, SMALL);
      check((await inPage(page, STEP, { ...SMALL, workers: 2 })).equals(expected), "other bytes in the page");
      const bytes = new Uint8Array(await readFile(STEP));
      check(Buffer.from(await bake(bytes, { ...SMALL, workers: 2, name: "tube.step" })).equals(expected), "other bytes in Node.js");
      check(asked.includes("rebounce_baker_step_bg.wasm"), `asked for ${asked}`);
      const message = await bake(bytes.slice(0, 9000), { ...SMALL, workers: 1, name: "cut.stp" }).then(() => "baked", (error) => error.message);
      check(/cut\.stp/.test(message) && !/fault of the baker/.test(message), message);
    });

    await harness.test("bake-in-page::points_alone_and_groups_are_those_of_the_command", async () => {
      const document = JSON.parse(Buffer.from(scene.buffer, 20, new DataView(scene.buffer).getUint32(12, true)).toString("utf8"));
      const group = document.materials[0].name;
      for (const more of [{ solver: "radiosity" }, { groups: { [group]: 3 } }]) {
        const options = { ...SMALL, ...more };
        const ours = await inPage(page, file, { ...options, workers: 2 });
        check(ours.equals(await commandBake(context, file, options)), `other bytes: ${JSON.stringify(more)}`);
        check(!ours.equals(await commandBake(context, file, SMALL)), `those of no option: ${JSON.stringify(more)}`);
      }
      for (const [options, says] of [[{ solver: "magic" }, /solver/], [{ groups: { [group]: 0 } }, /density/]]) {
        const message = await bake(scene, { ...SMALL, ...options, name }).then(() => "baked", (error) => error.message);
        check(says.test(message), message);
      }
    });

    await harness.long("bake-in-page::progress_rises_and_previews_come_first", async () => {
      const told = await page.evaluate(
        async ([scene, options]) => {
          const progress = [];
          const previews = [];
          const onProgress = (step) => progress.push(step);
          const onPreview = (file) => previews.push(String.fromCharCode(...file.subarray(0, 2080)));
          await bake(bytesOf(scene), { ...options, onProgress, onPreview });
          return { progress, previews };
        },
        [Buffer.from(scene).toString("base64"), { preset: "draft", functions: 16000, workers: 2 }],
      );
      const { progress, previews } = told;
      check(progress.some(({ stage }) => stage === "gathering links"), "no stage is told");
      check(progress.every(({ ratio, secondsLeft }) => ratio >= 0 && ratio <= 1 && secondsLeft >= 0), JSON.stringify(progress));
      check(progress.every(({ ratio }, i) => i === 0 || ratio >= progress[i - 1].ratio), "the ratio falls");
      check(previews.length >= 2, `${previews.length} previews`);
      const magic = String.fromCharCode(...(await readFile(context.baked)).subarray(0, 4));
      for (const preview of previews) equal(preview.slice(0, 4), magic, "a preview's first bytes");
      // The first has points and reflectances, and no links yet: light comes by radiosity.
      equal(JSON.stringify(previews.map((preview) => preview.includes("REFL"))), JSON.stringify(previews.map((_, i) => i === 0)), "previews for radiosity");
    });

    await harness.test("bake-in-page::what_is_no_scene_is_refused_with_a_sentence", async () => {
      for (const [bytes, says] of [
        [new Uint8Array([1, 2, 3]), /broken\.glb/],
        [scene.slice(0, 300), /broken\.glb/],
        [new Uint8Array(), /broken\.glb/],
      ]) {
        const message = await bake(bytes, { ...SMALL, workers: 2, name: "broken.glb" }).then(() => "baked", (error) => error.message);
        check(says.test(message) && !/fault of the baker/.test(message), `${bytes.length} bytes: ${message}`);
      }
      const message = await page.evaluate(() => bake(new Uint8Array([1, 2, 3])).then(() => "baked", (error) => error.message));
      check(/scene\.glb/.test(message), message);
      for (const options of [{ preset: "good" }, { workers: 0 }, { seed: -1 }, { functions: 1.5 }]) {
        const error = await bake(scene, options).then(() => undefined, (error) => error);
        check(error instanceof TypeError && error.message.startsWith("bake: "), `${JSON.stringify(options)}: ${error}`);
      }
    });

    await harness.test("bake-in-page::what_needs_more_memory_than_a_worker_has_is_refused_before_it_is_baked", async () => {
      const { message, stages } = await page.evaluate(
        async ([scene]) => {
          const stages = [];
          const options = { functions: 1 << 24, workers: 2, onProgress: ({ stage }) => stages.push(stage) };
          return { message: await bake(bytesOf(scene), options).then(() => "baked", (error) => error.message), stages };
        },
        [Buffer.from(scene).toString("base64")],
      );
      check(/^scene\.glb needs about \d+\.\d GB of memory in each worker, more than the 2 GB that pages may use: .*; simplify that, choose/.test(message), message);
      equal(stages.join(), "", "what was begun");
    });

    await harness.test("bake-in-page::an_abort_ends_the_bake_and_its_workers", async () => {
      await page.evaluate(countWorkers);
      const { name, workers } = await page.evaluate(
        async ([scene]) => {
          const abort = new AbortController();
          let most = 0;
          const onProgress = ({ stage }) => {
            most = Math.max(most, running.size);
            if (stage === "gathering links") abort.abort();
          };
          const ended = bake(bytesOf(scene), { preset: "draft", functions: 16000, workers: 2, onProgress, signal: abort.signal });
          const name = await ended.then(() => "baked", (error) => error.name);
          return { name, workers: [most, running.size] };
        },
        [Buffer.from(scene).toString("base64")],
      );
      equal(name, "AbortError", "the reason");
      equal(workers.join(), "2,0", "workers before and after");
    });

    await harness.test("bake-in-page::a_worker_that_dies_is_told_in_a_sentence", async () => {
      const post = Worker.prototype.postMessage;
      Worker.prototype.postMessage = function (start, ports) {
        post.call(this, start, ports);
        if (start.rank === 1) void this.terminate();
      };
      try {
        const message = await bake(scene, { preset: "draft", workers: 2, name }).then(() => "baked", (error) => error.message);
        check(/^a worker of the bake ended before its work: .*; bake with/.test(message), message);
      } finally {
        Worker.prototype.postMessage = post;
      }
    });
    await page.close();
  } finally {
    served.end();
  }
}
