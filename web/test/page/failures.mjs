// Whatever fails is told by a code and a sentence, and the element can be used afterwards.

import { check, equal } from "../harness.mjs";
import { expectFailure, open, outcome, shown } from "./open.mjs";

/** A route that answers with these bytes. */
const answer = (body) => (route) => route.fulfill({ status: 200, contentType: "application/octet-stream", body });

export async function failures(harness, context) {
  const { bytes } = context;
  const damaged = Buffer.from(bytes);
  damaged[damaged.length >> 1] ^= 0x10;
  const cases = {
    a_wrong_file: { code: "not-rbn", body: Buffer.from("glTF, or something else that is no baked scene") },
    an_empty_file: { code: "not-rbn", body: Buffer.alloc(0) },
    a_truncated_file: { code: "truncated", body: bytes.subarray(0, Math.floor(bytes.length * 0.6)) },
    a_truncated_header: { code: "truncated", body: bytes.subarray(0, 20) },
    a_damaged_file: { code: "corrupt", body: damaged },
    a_missing_file: { code: "http" },
    a_broken_connection: { code: "network", abort: true },
  };
  // One page for all: its pipelines are compiled once.
  const { page, faults } = await open(context, { query: "?src=missing.rbn" });
  await expectFailure(page, "http");
  for (const [name, { code, body, abort }] of Object.entries(cases)) {
    await harness.test(`page::failures::${name}`, async () => {
      const route = abort ? (r) => r.abort() : answer(body);
      if (body || abort) await page.route("**/bad.rbn", route);
      await page.evaluate(() => {
        events.length = 0;
        viewer.src = "bad.rbn";
      });
      await expectFailure(page, code);
      await page.unroute("**/bad.rbn");
      // The browser itself reports answers that are no success.
      const own = faults.filter((fault) => !fault.startsWith("Failed to load resource"));
      equal(own.join("\n"), "", "faults");
      // The same element shows a good file afterwards.
      await page.evaluate(() => (document.querySelector("rebounce-viewer").src = "scene.rbn"));
      const event = await outcome(page, 1);
      equal(event.type, "load", event.message ?? "the event after the failure");
      equal((await shown(page)).alert, "", "the message after loading");
      faults.length = 0;
    });
  }
  await page.close();

  await harness.test("page::failures::no_device", async () => {
    const prepare = () => (GPUAdapter.prototype.requestDevice = () => Promise.reject(new Error("none <b>left</b>")));
    const { page, faults } = await open(context, { prepare });
    await expectFailure(page, "no-device");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::failures::a_download_that_breaks_off", async () => {
    const prepare = () => {
      const original = window.fetch;
      window.fetch = async (address, options) => {
        if (!String(address).endsWith("scene.rbn")) return original(address, options);
        const pull = (controller) => controller.error(new TypeError("network error"));
        const bytes = new Uint8Array(await (await original(address, options)).arrayBuffer());
        const start = (controller) => controller.enqueue(bytes.subarray(0, 1000));
        return new Response(new ReadableStream({ start, pull }));
      };
    };
    const { page, faults } = await open(context, { prepare });
    await expectFailure(page, "truncated");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::failures::a_frame_that_was_asked_for_before_does_not_tell_of_another_failure", async () => {
    const { page } = await open(context, { routes: { "**/bad.rbn": answer(damaged) } });
    equal((await outcome(page)).type, "load", "the event");
    const told = await page.evaluate(async () => {
      await still();
      // The frame that this change wants comes only after the next file has failed.
      const original = requestAnimationFrame;
      const held = [];
      window.requestAnimationFrame = (work) => held.push(work);
      await until(() => {
        viewer.exposure += 0.125;
        return held.length > 0;
      });
      viewer.src = "bad.rbn";
      await outcome(1);
      for (const work of held) work(performance.now());
      window.requestAnimationFrame = original;
      await pause(500);
      return { held: held.length, codes: events.filter(({ type }) => type === "error").map(({ code }) => code) };
    });
    check(told.held > 0, "no frame was asked for");
    equal(told.codes.join(" "), "corrupt", "what was told");
    check((await shown(page)).alert.includes("damaged"), "another sentence is shown");
    await page.close();
  });

  await harness.test("page::failures::a_name_is_text_and_never_markup", async () => {
    const { page } = await open(context, { query: `?src=${encodeURIComponent("<img src=x onerror=alert(1)>.rbn")}` });
    await expectFailure(page, "http");
    await page.close();
  });

  await harness.test("page::failures::reading_before_loading_rejects_with_a_code", async () => {
    const { page, faults } = await open(context, { query: "?src=missing.rbn" });
    await outcome(page);
    const code = await page.evaluate(() =>
      document.querySelector("rebounce-viewer").readIndirect(8, 8).then(() => "none", (error) => error.code),
    );
    equal(code, "no-scene", "the code");
    check(!faults.some((fault) => fault.includes("Uncaught")), faults.join("\n"));
    await page.close();
  });

  await harness.test("page::failures::an_element_that_is_removed_says_nothing", async () => {
    const { page, faults } = await open(context);
    const events = await page.evaluate(async () => {
      const viewer = document.querySelector("rebounce-viewer");
      let told = 0;
      viewer.addEventListener("error", () => (told += 1));
      viewer.src = "scene.rbn?again";
      viewer.remove();
      await new Promise((later) => setTimeout(later, 1000));
      globalThis.events.length = 0;
      document.body.append(viewer);
      return { told, outcome: await globalThis.outcome() };
    });
    equal(events.told, 0, "errors");
    equal(events.outcome.type, "load", "the event when it is back");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });
}
