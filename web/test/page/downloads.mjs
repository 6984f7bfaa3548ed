// Bad networks and wrong files, from a real server: a code, a sentence with the file's name, and the next file is shown.

import { readFile } from "node:fs/promises";
import { HANGS, within } from "../browser.mjs";
import { check, equal } from "../harness.mjs";
import { document, serveStrictly } from "../strict.mjs";
import { expectFailure, open, outcome, shown } from "./open.mjs";

const GLB = new URL("../../../baker/tests/gltf/plain.glb", import.meta.url);
/** What an endless server may get rid of before the element has seen enough, bytes: what lies in buffers on the way. */
const ENOUGH = 64e6;

/**
 * In the page, before its scripts: a minute's patience ends when `losePatience()` is called, and not by itself; nothing else
 * waits as long. `patience` has how often it began anew, and how many wait now.
 */
function holdTime() {
  const { setTimeout: set, clearTimeout: clear } = window;
  const waiting = new Map();
  globalThis.patience = { begun: 0, waiting: () => waiting.size };
  window.setTimeout = (work, ms = 0, ...rest) => {
    if (ms < 60_000) return set.call(window, work, ms, ...rest);
    patience.begun += 1;
    waiting.set(-patience.begun, work);
    return -patience.begun;
  };
  window.clearTimeout = (id) => waiting.delete(id) || clear.call(window, id);
  globalThis.losePatience = () => {
    const works = [...waiting.values()];
    waiting.clear();
    for (const work of works) work();
  };
}

/** Faults by the name of the file: what the server does, and what comes of it. */
function faults(bytes, glb) {
  const third = bytes.subarray(0, Math.floor(bytes.length / 3));
  const headers = { "content-type": "application/octet-stream" };
  const damaged = Buffer.from(bytes);
  damaged[damaged.length >> 1] ^= 0x10;
  const whole = (code, words, body, more) => ({ code, words, answer: (_, response) => response.writeHead(200, { ...headers, ...more }).end(body) });
  const status = (code, number) => ({ code, words: String(number), answer: (_, response) => response.writeHead(number).end("no") });
  const endless = (first) => (request, response) => {
    response.writeHead(200, headers);
    response.write(first);
    const more = Buffer.alloc(1 << 20);
    const fill = () => {
      while (!response.destroyed && sent.bytes < ENOUGH * 4 && response.write(more)) sent.bytes += more.length;
    };
    response.on("drain", fill);
    request.on("close", () => (sent.closed = true));
    fill();
  };
  const sent = { bytes: 0, closed: false, asked: () => undefined };
  return {
    sent,
    cases: {
      missing: status("http", 404),
      forbidden: status("http", 403),
      broken_server: status("http", 500),
      web_page: whole("not-rbn", "a web page came in its place", "<!doctype html><title>Not found</title>", { "content-type": "text/html; charset=utf-8" }),
      web_page_without_type: whole("not-rbn", "rebounce bake", "<!doctype html><title>Not found</title>"),
      glb: whole("not-rbn", "rebounce bake", glb),
      empty: whole("not-rbn", "rebounce bake", ""),
      cut_short: whole("truncated", String(bytes.length), third),
      damaged: whole("corrupt", "damaged", damaged),
      no_gzip: whole("truncated", "broke off", bytes, { "content-encoding": "gzip" }),
      broken_off: {
        code: "truncated",
        words: `of ${bytes.length} bytes`,
        answer: (_, response) => {
          response.writeHead(200, { ...headers, "content-length": bytes.length });
          response.write(third, () => setTimeout(() => response.destroy(), 100));
        },
      },
      never_answered: { code: "stalled", words: "0 bytes", stallsAt: 0, answer: () => sent.asked() },
      stalled: {
        code: "stalled",
        words: `after ${third.length} of ${bytes.length} bytes`,
        stallsAt: third.length,
        answer: (_, response) => {
          response.writeHead(200, { ...headers, "content-length": bytes.length });
          response.write(third);
        },
      },
      closed_at_once: { code: "network", words: "could not be fetched", answer: (request) => request.socket.destroy() },
      going_in_circles: { code: "network", words: "could not be fetched", answer: (request, response) => response.writeHead(302, { location: request.url }).end() },
      endless_zeros: { code: "not-rbn", words: "rebounce bake", answer: endless(Buffer.alloc(100)), ends: true },
      endless: { code: "corrupt", words: "follow the file's end", answer: endless(bytes), ends: true },
    },
  };
}

/** Runs the tests. */
export async function downloads(harness, context) {
  const { sent, cases } = faults(context.bytes, await readFile(GLB));
  const answers = Object.fromEntries(Object.entries(cases).map(([name, { answer }]) => [`${name}.rbn`, answer]));
  answers["good.rbn"] = (_, response) => response.writeHead(200).end(context.bytes);
  const server = await serveStrictly({ pages: { "": document("<rebounce-viewer></rebounce-viewer>") }, faults: answers });
  try {
    // One page for all: its pipelines are compiled once.
    const { page, faults } = await open({ ...context, address: server.address }, { prepare: holdTime });
    for (const [name, { code, words, ends, stallsAt }] of Object.entries(cases)) {
      await harness.test(`page::downloads::${name}`, async () => {
        await page.evaluate(() => (events.length = 0));
        faults.length = 0;
        const asked = new Promise((done) => (sent.asked = done));
        await page.evaluate((file) => (viewer.src = file), `${name}.rbn`);
        if (stallsAt === 0) await within("the request", asked);
        if (stallsAt > 0) await page.evaluate((bytes) => until(() => events.some(({ loaded }) => loaded === bytes)), stallsAt);
        if (stallsAt !== undefined) await page.evaluate(() => losePatience());
        await expectFailure(page, code);
        const { alert } = await shown(page);
        check(alert.includes(words), `the sentence has no "${words}": ${alert}`);
        if (ends) {
          for (const end = Date.now() + 1000 * HANGS; Date.now() < end && !sent.closed; ) await page.waitForTimeout(50);
          check(sent.closed && sent.bytes < ENOUGH, `${sent.bytes} bytes were taken, and the connection is ${sent.closed ? "closed" : "open"}`);
          Object.assign(sent, { bytes: 0, closed: false });
        }
        await page.evaluate(() => (viewer.src = "good.rbn"));
        const event = await outcome(page, 1);
        equal(event.type, "load", event.message ?? "the event after the failure");
        equal((await shown(page)).alert, "", "the message after loading");
        const own = faults.filter((fault) => !fault.startsWith("Failed to load resource"));
        equal(own.join("\n"), "", "faults");
      });
    }
    await page.close();

    await harness.test("page::downloads::slow_is_not_stalled", async () => {
      let asked;
      const slow = new Promise((done) => (asked = done));
      answers["slow.rbn"] = (_, response) => asked(response.writeHead(200));
      const { page } = await open({ ...context, address: server.address }, { prepare: holdTime });
      await page.evaluate(() => (viewer.src = "slow.rbn"));
      const response = await within("the request", slow);
      const size = 1 + (context.bytes.length >> 3);
      let begun = 0;
      for (let at = 0; at < context.bytes.length; at += size) {
        const to = Math.min(at + size, context.bytes.length);
        response.write(context.bytes.subarray(at, to));
        await page.evaluate((bytes) => until(() => events.some(({ loaded }) => loaded === bytes)), to);
        // Each piece that comes gives it another minute, and only one of them runs.
        const now = await page.evaluate(() => [patience.begun, patience.waiting()]);
        check(now[0] > begun && now[1] === 1, `patience began ${begun} and then ${now[0]} times, ${now[1]} wait`);
        [begun] = now;
      }
      response.end();
      const event = await outcome(page);
      equal(event.type, "load", event.message ?? "the event");
      const steps = await page.evaluate(() => events.filter(({ type }) => type === "progress").map(({ total }) => total));
      // No header says the length; the file does.
      equal(steps.at(-1), context.bytes.length, "the total");
      check(steps.filter((total) => total > 0).length > 4, `progress: ${steps}`);
      await page.close();
    });

    await harness.test("page::downloads::without_the_program_that_is_said_and_trying_again_helps", async () => {
      for (const [fault, body] of [[{ status: 404 }, "none"], [{ status: 200, contentType: "application/wasm" }, Buffer.from("\0asm\x01\0\0\0")]]) {
        const { page } = await open({ ...context, address: server.address }, {
          routes: { "**/*.wasm": (route) => route.fulfill({ ...fault, body }) },
        });
        await page.evaluate(() => (viewer.src = "good.rbn"));
        await expectFailure(page, "network");
        check((await shown(page)).alert.includes("program"), (await shown(page)).alert);
        await page.unroute("**/*.wasm");
        await page.getByRole("button", { name: "Try again" }).click();
        equal((await outcome(page, 1)).type, "load", "the event after trying again");
        await page.close();
      }
    });
  } finally {
    server.end();
  }
}
