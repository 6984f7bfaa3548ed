// The GPU's memory and limits: what does not fit is said in numbers, and frees what it has taken.

import { spread, within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { PLAIN, expectFailure, outcome, shown } from "./open.mjs";
import { alike, counted } from "./sharing.mjs";

/** In the page: while `full` is set, everything that is asked of the device finds no memory. */
function fullMemory() {
  const stacks = new WeakMap();
  const stack = (device) => stacks.get(device) ?? stacks.set(device, []).get(device);
  const { pushErrorScope, popErrorScope } = GPUDevice.prototype;
  GPUDevice.prototype.pushErrorScope = function (filter) {
    stack(this).push(filter);
    return pushErrorScope.call(this, filter);
  };
  GPUDevice.prototype.popErrorScope = async function () {
    const filter = stack(this).pop();
    const error = await popErrorScope.call(this);
    if (!globalThis.full) return error;
    if (filter === "out-of-memory") return new GPUOutOfMemoryError("no memory");
    // What uses a buffer that could not be made is refused as well.
    return filter === "validation" ? new GPUValidationError("an invalid buffer") : error;
  };
}

/** Runs the tests. */
export async function memory(harness, context) {
  const full = (set) => (page) => page.evaluate((value) => (globalThis.full = value), set);
  const opened = async (html) => {
    const it = await counted(context, html);
    await it.page.evaluate(`(${fullMemory})()`);
    return it;
  };

  await harness.test("page::memory::a_scene_that_finds_none_says_so_frees_all_and_leaves_others_alone", async () => {
    const { page, faults } = await opened(PLAIN);
    await outcome(page);
    const before = await page.evaluate(async () => (await still(), { ...(await settled()), picture: await look(viewer) }));
    await full(true)(page);
    const told = await within("the second one", page.evaluate(async () => {
      globalThis.second = add();
      const detail = await new Promise((done) => second.addEventListener("error", (event) => done(event.detail)));
      globalThis.full = false;
      const alert = second.shadowRoot.querySelector("[role=alert]");
      return { ...detail, alert: alert.hidden ? "" : alert.querySelector("p").textContent, first: viewer.loaded };
    }));
    equal(told.code, "out-of-memory", told.message);
    check(/memory is full/.test(told.alert), told.alert);
    check(told.first, "the first one has lost its scene");
    const { alive, bytes } = await page.evaluate(() => settled());
    same({ alive, bytes }, { alive: before.alive, bytes: before.bytes }, "what is alive after it");
    alike(await page.evaluate(() => look(viewer)), before.picture, "the first one's picture");
    // There is memory again.
    await page.evaluate(() => second.shadowRoot.querySelector("[role=alert] button").click());
    await within("the second one", page.evaluate(() => until(() => second.loaded)));
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::memory::a_larger_picture_that_finds_none_says_so_and_trying_again_helps", async () => {
    const { page, faults } = await opened(PLAIN);
    await outcome(page);
    await page.evaluate(() => still());
    await full(true)(page);
    await page.evaluate(() => Object.assign(viewer.style, { width: "250px", height: "140px" }));
    await expectFailure(page, "out-of-memory", 1);
    same(await page.evaluate(() => settled()), { alive: 0, bytes: 0 }, "what is alive after it");
    await full(false)(page);
    await page.getByRole("button", { name: "Try again" }).click();
    equal((await outcome(page, 2)).type, "load", "the event after trying again");
    const picture = await page.evaluate(() => look(viewer));
    check(spread(picture).deviation > 4, "the picture is blank");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  for (const [limit, least] of [["maxBufferSize", 60_000], ["maxStorageBufferBindingSize", 40_000]]) {
    await harness.test(`page::memory::a_file_beyond_${limit}_is_refused_with_both_numbers_before_it_is_uploaded`, async () => {
      const { page, faults } = await counted(context, "<p></p>");
      await page.evaluate(([name, value]) => {
        Object.defineProperty(GPUSupportedLimits.prototype, name, { get: () => value });
        globalThis.sections = [];
        const { createBuffer } = GPUDevice.prototype;
        GPUDevice.prototype.createBuffer = function (descriptor) {
          if (/^[A-Z]{4}$/.test(descriptor.label)) sections.push(descriptor.label);
          return createBuffer.call(this, descriptor);
        };
        add();
      }, [limit, least]);
      await expectFailure(page, "too-large");
      const { alert } = await shown(page);
      const [, section, bytes, most] = /section (\w{4}) takes (\d+) bytes.* holds (\d+)/i.exec(alert) ?? [];
      check(section && Number(bytes) > least, alert);
      equal(Number(most), least, "the limit in the message");
      same(await page.evaluate(() => sections), [], "sections that were uploaded");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });
  }
}
