// Scenes that the element bakes itself: what `src` names, what is opened and what is dropped.

import { cp, mkdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { check, equal } from "../harness.mjs";
import { serveFolder } from "../serve.mjs";
import { document as pageWith } from "../strict.mjs";
import { outcome, open } from "./open.mjs";
import { commandBake, cornellBox, countWorkers } from "./bake-in-page.mjs";

const HEAD = '<link rel="icon" href="data:,"><script type="module" src="rebounce-viewer.js"></script>';

/** A folder with the viewer's modules, a page with the element, and scenes. */
async function folder(context) {
  const root = path.join(context.work, "bake-element");
  await cp(path.resolve("dist"), root, { recursive: true });
  await writeFile(path.join(root, "index.html"), pageWith("<rebounce-viewer drop></rebounce-viewer>", HEAD));
  const box = await cornellBox(context);
  await cp(box, path.join(root, "box.glb"));
  await mkdir(path.join(root, "split/parts"), { recursive: true });
  await split(new Uint8Array(await readFile(box)), path.join(root, "split"));
  await writeFile(path.join(root, "notes.txt"), "no scene");
  return { root, box };
}

/** Writes a .glb as a .gltf whose buffer and pictures are files of a folder beside it. */
async function split(glb, out) {
  const view = new DataView(glb.buffer);
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + length)));
  const binary = glb.subarray(28 + length, 28 + length + view.getUint32(20 + length, true));
  json.buffers[0].uri = "parts/the%20buffer.bin";
  await writeFile(path.join(out, "parts/the buffer.bin"), binary);
  for (const [i, image] of (json.images ?? []).entries()) {
    const { byteOffset = 0, byteLength } = json.bufferViews[image.bufferView];
    await writeFile(path.join(out, `parts/${i}.png`), binary.subarray(byteOffset, byteOffset + byteLength));
    delete image.bufferView;
    image.uri = `parts/${i}.png`;
  }
  await writeFile(path.join(out, "room.gltf"), JSON.stringify(json));
}

/** Drops files or folders of this machine on the element. */
async function drop(page, ...files) {
  const client = await page.context().newCDPSession(page);
  const { x, y } = await page.evaluate(() => {
    const { left, top } = viewer.getBoundingClientRect();
    return { x: left + 20, y: top + 20 };
  });
  const data = { items: [], files, dragOperationsMask: 1 };
  for (const type of ["dragEnter", "dragOver", "drop"]) await client.send("Input.dispatchDragEvent", { type, x, y, data });
  await client.detach();
}

/** Opens the page; in it `steps` are the `bake-progress` events, and `baked()` resolves with base64 of the file. */
async function opened(context, address) {
  const { page, faults } = await open({ ...context, address }, {
    prepare: () => {
      globalThis.steps = [];
      document.addEventListener("bake-progress", ({ target, detail }) => {
        steps.push(detail);
        if (detail.stage === "done") globalThis.atEnd = target.toRbn()?.length;
      }, true);
      globalThis.baked = async () => {
        await until(() => viewer.toRbn() || events.some(({ type }) => type === "error"));
        let text = "";
        const bytes = viewer.toRbn() ?? new Uint8Array();
        for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
        return btoa(text);
      };
    },
  });
  const baked = async () => Buffer.from(await page.evaluate(() => baked()), "base64");
  return { page, faults, baked };
}

/** Runs the tests. */
export async function bakeElement(harness, context) {
  const { root, box } = await folder(context);
  const server = await serveFolder(root);
  const expected = await commandBake(context, box, { preset: "draft" });
  await writeFile(path.join(root, "box.rbn"), expected);
  try {
    await harness.long("bake-element::a_glb_is_lit_while_it_is_baked_and_has_the_commands_bytes", async () => {
      const { page, faults, baked } = await opened(context, server.address);
      await page.evaluate(() => (viewer.src = "box.glb"));
      equal((await outcome(page)).type, "load", "the event");
      const early = await page.evaluate(() => {
        const { camera } = viewer;
        camera.position[0] += 0.05;
        viewer.camera = camera;
        return { done: steps.some(({ stage }) => stage === "done"), x: viewer.camera.position[0], file: viewer.toRbn(), solver: viewer.stats().solver };
      });
      equal(early.solver, "radiosity", "what lights the first picture");
      check(!early.done && early.file === undefined, "the first picture came with the finished file");
      check((await baked()).equals(expected), "other bytes");
      equal(await page.evaluate(() => viewer.stats().solver), "operator", "what lights the last one");
      const late = await page.evaluate(() => ({ steps, atEnd, x: viewer.camera.position[0], loads: events.filter(({ type }) => type === "load").length }));
      equal(late.x, early.x, "the camera after the last file");
      equal(late.atEnd, expected.length, "bytes of the file at the last step");
      equal(late.loads, 1, "load events");
      check(late.steps.every(({ ratio }, i) => i === 0 || ratio >= late.steps[i - 1].ratio), "the ratio falls");
      equal(JSON.stringify(late.steps.at(-1)), JSON.stringify({ stage: "done", ratio: 1, secondsLeft: 0 }), "the last step");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    }, "attribute src, event bake-progress, method toRbn");

    await harness.test("bake-element::a_gltf_brings_its_files", async () => {
      const { page, faults } = await opened(context, server.address);
      await page.evaluate(() => (viewer.src = "split/room.gltf"));
      equal((await outcome(page)).type, "load", "the event");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });

    await harness.long("bake-element::what_is_dropped_does_what_is_expected", async () => {
      for (const [name, files, says] of [
        ["a .glb", ["box.glb"], undefined],
        ["a .gltf and its folder", ["split/room.gltf", "split/parts"], undefined],
        ["a folder", ["split"], undefined],
        ["a .rbn", ["box.rbn"], undefined],
        ["a .gltf alone", ["split/room.gltf"], /buffer\.bin/],
        ["something else", ["notes.txt"], /"notes\.txt" is no scene: drop a \.glb/],
      ]) {
        const { page, baked } = await opened(context, server.address);
        // The listener comes with a module of its own.
        await page.evaluate(() => until(() => performance.getEntriesByName(new URL("bake-drop.js", location.href).href).length > 0));
        await page.evaluate(() => pause(100));
        await drop(page, ...files.map((file) => path.join(root, file)));
        const event = await outcome(page);
        if (says) {
          equal(event.type, "error", `the event for ${name}`);
          check(says.test(event.message), `${name}: ${event.message}`);
        } else {
          equal(event.type, "load", `the event for ${name}: ${event.message}`);
          if (name === "a .rbn") check((await baked()).equals(expected), "other bytes");
        }
        await page.close();
      }
    }, "attribute drop, property drop");

    await harness.test("bake-element::files_are_opened_in_place_of_src", async () => {
      const { page, baked } = await opened(context, server.address);
      await page.evaluate(async () => {
        const response = await fetch("box.rbn");
        viewer.open(new File([await response.arrayBuffer()], "any.rbn"));
      });
      equal((await outcome(page)).type, "load", "the event");
      check((await baked()).equals(expected), "other bytes");
      await page.close();
    }, "method open");

    await harness.long("bake-element::cancel_keeps_the_preview_and_ends_the_workers", async () => {
      const { page } = await opened(context, server.address);
      await page.evaluate(countWorkers);
      await page.evaluate(() => {
        viewer.preset = "fine";
        viewer.drop = true;
        viewer.src = "box.glb";
      });
      equal((await outcome(page)).type, "load", "the event");
      const before = await page.evaluate(() => running.size);
      await page.evaluate(() => viewer.cancel());
      await page.evaluate(() => until(() => running.size === 0));
      check(before > 0, "no workers");
      const after = await page.evaluate(async () => {
        const { length } = steps;
        await pause(1000);
        return { more: steps.length - length, loaded: viewer.loaded, file: viewer.toRbn(), errors: events.filter(({ type }) => type === "error").length };
      });
      equal(JSON.stringify(after), JSON.stringify({ more: 0, loaded: true, errors: 0 }), "after cancel");
      await page.close();
    }, "method cancel, attribute preset, property preset");

    await harness.test("bake-element::a_bake_that_fails_says_why", async () => {
      const { page } = await opened(context, server.address);
      await writeFile(path.join(root, "broken.glb"), expected.subarray(0, 100));
      for (const [seen, src, code, says] of [
        [0, "missing.glb", "http", /missing\.glb could not be loaded: it is not there/],
        [1, "broken.glb", "bake", /broken\.glb/],
      ]) {
        await page.evaluate((src) => (viewer.src = src), src);
        const event = await outcome(page, seen);
        equal(event.code, code, event.message);
        check(says.test(event.message), event.message);
      }
      await page.close();
    });
  } finally {
    server.end();
  }
}
