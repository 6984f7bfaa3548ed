// What a file says besides its light: names of lights and cameras, the backdrop of an object; and that the command's PNG looks
// as the page does.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { exec } from "../agreement.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";
import { QUICK, squares } from "./pictures.mjs";

const SIZE = [96, 54];

/** A red screen and a bluish one over a dark floor, two lamps and a camera, all but one of them with names. */
function scene() {
  const gltf = JSON.parse(squares([[0, 3, [0, 0, 0], 1], [0.6, 0.8, [0.9, 0.1, 0.05], 1], [1.2, 0.5, [0.1, 0.3, 0.8], 1]]));
  gltf.materials[0].pbrMetallicRoughness = { baseColorFactor: [0.6, 0.6, 0.5, 1], metallicFactor: 0 };
  for (const material of gltf.materials) material.extensions = { KHR_materials_specular: { specularFactor: 0 } };
  const light = (light) => ({ translation: [1.5 - 3 * light, 2.5, 1.5], extensions: { KHR_lights_punctual: { light } } });
  const camera = { name: "Entrance", camera: 0, translation: [0, 2, 6], rotation: [-0.13, 0, 0, 0.9915] };
  gltf.nodes.push(light(0), light(1), camera);
  gltf.scenes[0].nodes.push(3, 4, 5);
  gltf.cameras = [{ type: "perspective", perspective: { yfov: 0.9, znear: 0.1 } }];
  const lights = [{ type: "point", name: "Key, warm", intensity: 9, color: [1, 0.8, 0.6] }, { type: "point", intensity: 4 }];
  gltf.extensions = { KHR_lights_punctual: { lights } };
  gltf.extensionsUsed = ["KHR_lights_punctual", "KHR_materials_specular"];
  return JSON.stringify(gltf);
}

/** Runs the tests. */
export async function shown(harness, context) {
  const file = (ending) => path.join(context.work, `shown.${ending}`);
  await writeFile(file("gltf"), scene());
  await exec(context.rebounce, ["bake", file("gltf"), ...QUICK, "-o", file("rbn")]);
  const body = await readFile(file("rbn"));
  const html = '<rebounce-viewer src="shown.rbn" controls></rebounce-viewer>';
  const { page, faults } = await loaded(context, html, { routes: { "**/shown.rbn": (route) => route.fulfill({ body }) } });

  await harness.test("shown::lights_have_the_names_of_the_file_and_keep_them", async () => {
    const found = await page.evaluate(async () => {
      const names = () => viewer.lights.map(({ name }) => name ?? null);
      const steps = [names()];
      const link = viewer.stateLink();
      viewer.addLight({ type: "point", name: "Rim", position: [0, 1, 2], intensity: 1 }, 1);
      steps.push(names());
      viewer.removeLight(0);
      steps.push(names());
      viewer.lights = viewer.lights.map((light) => ({ ...light, intensity: 3 }));
      steps.push(names());
      viewer.shot = { ...viewer.shot, lights: [{ type: "point", name: "Only", position: [0, 2, 2], intensity: 5 }] };
      steps.push(viewer.shot.lights.map(({ name }) => name));
      let refused;
      try {
        viewer.lights = [{ type: "point", name: 7, position: [0, 2, 2], intensity: 5 }];
      } catch (error) {
        refused = error.code;
      }
      await viewer.reload();
      await outcome(1);
      steps.push(names());
      viewer.restoreState(link);
      steps.push(names());
      return { steps, refused };
    });
    // The two screens are lights, too; a shot that does not name them leaves them on.
    const own = ["Key, warm", null, null, null];
    const changed = ["Rim", ...own.slice(1)];
    same(found.steps, [own, ["Key, warm", ...changed], changed, changed, ["Only", null, null], own, own], "names");
    equal(found.refused, "bad-json", "a name that is no text");
  });

  await harness.test("shown::the_panel_lists_lights_by_name", async () => {
    await page.getByText("Lights and settings").click();
    const names = ["Key, warm point", "Lamp 2 point"];
    for (const name of names) await page.getByRole("button", { name }).waitFor();
  });

  await harness.test(
    "shown::an_object_stands_before_a_backdrop_that_can_be_turned_off",
    async () => {
      const [auto, none, back] = await page.evaluate(async ([width, height]) => {
        const pixels = async (backdrop) => {
          viewer.backdrop = backdrop;
          await still();
          return Array.from(await viewer.readPixels(width, height));
        };
        return [await pixels("auto"), await pixels("none"), await pixels("auto")];
      }, SIZE);
      const corner = (pixels, at) => pixels.slice(4 * at, 4 * at + 3);
      const [first, last] = [0, SIZE[0] * SIZE[1] - 1];
      check(corner(auto, first).every((c) => c > 80 && c < 220), `above: ${corner(auto, first)}`);
      check(corner(auto, last)[0] > corner(auto, first)[0], "it is lighter below");
      same([corner(none, first), corner(none, last)], [[0, 0, 0], [0, 0, 0]], "without");
      same(back, auto, "turned on again");
      // Where there is a surface nothing changes.
      const middle = 4 * (Math.floor(SIZE[1] / 2) * SIZE[0] + SIZE[0] / 2);
      same(auto.slice(middle, middle + 4), none.slice(middle, middle + 4), "the middle");
    },
    "attribute backdrop",
  );

  await harness.test("shown::the_commands_picture_looks_as_the_pages", async () => {
    const png = file("png");
    await exec(context.rebounce, ["render", file("rbn"), "-o", png, "--size", SIZE.join("x"), "--spp", "64"]);
    const base64 = (await readFile(png)).toString("base64");
    const [ours, theirs] = await page.evaluate(async ([size, base64]) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
      const context = new OffscreenCanvas(...size).getContext("2d");
      context.drawImage(bitmap, 0, 0);
      return [Array.from(await viewer.readPixels(...size)), Array.from(context.getImageData(0, 0, ...size).data)];
    }, [SIZE, base64]);
    const color = (pixels) => pixels.filter((_, i) => i % 4 < 3);
    const mean = (bytes) => bytes.reduce((sum, byte) => sum + byte, 0) / bytes.length;
    const [a, b] = [color(ours), color(theirs)];
    check(Math.abs(mean(a) - mean(b)) < 2, `means ${mean(a)}, ${mean(b)}`);
    // Away from edges: where no neighbour differs by more than 24.
    const [width, height] = SIZE;
    const even = (picture, x, y) =>
      [-1, 0, 1].every((dx) =>
        [-1, 0, 1].every((dy) =>
          [0, 1, 2].every((c) => Math.abs(picture[3 * (y * width + x) + c] - picture[3 * ((y + dy) * width + x + dx) + c]) <= 24),
        ),
      );
    const apart = [];
    for (let y = 1; y < height - 1; y += 1) {
      for (let x = 1; x < width - 1; x += 1) {
        if (!even(a, x, y) || !even(b, x, y)) continue;
        apart.push(Math.max(...[0, 1, 2].map((c) => Math.abs(a[3 * (y * width + x) + c] - b[3 * (y * width + x) + c]))));
      }
    }
    apart.sort((p, q) => p - q);
    const most = apart[Math.floor(0.99 * apart.length)];
    check(apart.length > 0.5 * width * height && most <= 6, `${apart.length} even pixels, 99% within ${most}`);
  });

  equal(faults.join("\n"), "", "faults");
  await page.close();
}
