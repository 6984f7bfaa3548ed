// The browser's light is the CPU's.

import { agreement, difference } from "../agreement.mjs";
import { within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { open, outcome } from "./open.mjs";

/** Pictures are compared at this size; the browser's is averaged from FINER times as many pixels a
 * side, since the CPU takes 64 samples a pixel. */
const SIZE = [48, 27];
const FINER = 2;
/** The most that the browser's indirect light may differ from the CPU's, relative RMS; and that of lookup from that of splats. */
const TOLERANCE = 0.01;
/** The same with detail, which the browser has from its depth buffer and the CPU by rays. */
const DETAILED = 0.02;

const CAMERA = { position: [0.4, 2.9, 3.2], target: [-0.2, 2.3, -3], up: [0, 1, 0], yfov_deg: 65 };
const SPOT = {
  type: "spot",
  position: [-1.2, 4.6, -2.2],
  direction: [-0.8, -1, 0.1],
  outer_cone_deg: 40,
  inner_cone_deg: 30,
  intensity: 150,
  color: [1, 0.9, 0.8],
};
const SHOTS = {
  "a spot on the red wall": { camera: CAMERA, lights: [SPOT] },
  "the spot moved to the green wall": {
    camera: CAMERA,
    lights: [{ ...SPOT, position: [1.0, 3.6, -1.6], direction: [1, -0.5, -0.3] }],
  },
};

export async function light(harness, context) {
  const { page } = await open(context);
  const files = [];
  for (const [name, shot] of Object.entries(SHOTS)) {
    await harness.test(`page::indirect_light_is_that_of_the_cpu: ${name}`, async () => {
      equal((await outcome(page)).type, "load", "the event");
      const { file, difference } = await agreement(page, context, name, shot, SIZE, FINER, 256, false);
      console.log(`    ${name}: ${JSON.stringify(difference)}`);
      files.push(file);
      const rms = difference.error;
      check(rms <= TOLERANCE, `relative RMS difference ${rms}, at most ${TOLERANCE} is allowed`);
    });
  }
  await harness.test(
    "page::detail_is_that_of_the_cpu_and_can_be_left_out",
    async () => {
      const [[name, shot]] = Object.entries(SHOTS);
      const { file, difference: found } = await agreement(page, context, `${name}, detailed`, shot, SIZE, FINER);
      console.log(`    ${name}, with detail: ${JSON.stringify(found)}`);
      check(found.error <= DETAILED, `relative RMS difference ${found.error}, at most ${DETAILED} is allowed`);
      const { error: changed } = await difference(context, file, files[0]);
      check(changed > 0.001, `the picture without it differs by ${changed} only`);
    },
    "attribute detail",
  );
  await harness.test("page::moving_the_light_changes_the_picture", async () => {
    equal(files.length, 2, "pictures");
    const { error: rms } = await difference(context, files[0], files[1]);
    check(rms > 0.3, `the two shots differ by ${rms} only`);
    const told = await page.evaluate(() => events.filter((event) => event.type === "light-change").length);
    check(told > 0, "no light-change event");
  });
  await harness.long(
    "page::light_is_the_same_looked_up_and_splatted",
    async () => {
      const read = async (shot) => {
        viewer.shot = shot;
        const pictures = [];
        const told = [];
        for (const way of ["lookup", "splat", "auto"]) {
          viewer.setAttribute("display", way);
          // Software looks up of itself: one picture of that is enough.
          if (way !== "auto") pictures.push(await viewer.readIndirect(160, 90));
          else await viewer.readIndirect(16, 9);
          told.push(viewer.stats().display);
        }
        viewer.removeAttribute("display");
        const [lookup, splat] = pictures.map((pixels) => pixels.filter((_, i) => i % 4 < 3));
        const power = lookup.reduce((sum, value) => sum + value ** 2, 0);
        const error = lookup.reduce((sum, value, i) => sum + (value - splat[i]) ** 2, 0);
        return { told, rms: Math.sqrt(error / power) };
      };
      for (const [name, shot] of Object.entries(SHOTS)) {
        const { told, rms } = await within(name, page.evaluate(read, shot));
        console.log(`    ${name}: ${rms}`);
        same(told, ["lookup", "splat", "lookup"], "what stats() tells; of itself software looks up");
        check(rms <= TOLERANCE, `${name}: relative RMS difference ${rms}, at most ${TOLERANCE} is allowed`);
      }
    },
    "attribute display",
  );
  await page.close();
}
