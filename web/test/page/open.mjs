// Opens the page and looks at what the element makes of it.

import { DEVICE_PIXELS, HANGS, within } from "../browser.mjs";
import { check, equal } from "../harness.mjs";

/** The page's element without its panel: quicker. */
export const PLAIN = '<rebounce-viewer src="scene.rbn"></rebounce-viewer>';

/**
 * Opens the page; `prepare` may change it before any of its scripts run. `html` stands in for the element.
 * Faults are gathered. In the page, `viewer` is the element and `events` what it has told.
 */
export async function open(context, options = {}) {
  const { query = "", prepare, argument, routes = {}, html, viewport = { width: 320, height: 180 }, media } = options;
  const page = await context.browser.newPage({ viewport, deviceScaleFactor: DEVICE_PIXELS, ...media });
  page.setDefaultTimeout(1000 * HANGS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  await page.addInitScript((hangs) => {
    globalThis.events = [];
    Object.defineProperty(globalThis, "viewer", { get: () => document.querySelector("rebounce-viewer") });
    globalThis.pause = (ms) => new Promise((later) => setTimeout(later, ms));
    // Resolves when the claim holds, and after it has not for as long as something that hangs rejects.
    globalThis.until = async (claim) => {
      for (const end = Date.now() + 1000 * hangs; Date.now() < end; await pause(50)) if (await claim()) return;
      throw new Error(`never: ${claim}`);
    };
    // Resolves when what the GPU was given is done, and frames that were asked for meanwhile have had their turn.
    const queues = new Set();
    const { requestAnimationFrame: request } = window;
    const submit = globalThis.GPUQueue?.prototype.submit;
    if (submit) {
      GPUQueue.prototype.submit = function (...args) {
        queues.add(this);
        return submit.apply(this, args);
      };
    }
    globalThis.idle = async () => {
      for (const queue of queues) await queue.onSubmittedWorkDone().catch(() => queues.delete(queue));
      for (let i = 0; i < 3; i += 1) await new Promise((done) => request.call(window, done));
    };
    // Resolves with the count of frames when no further ones are drawn.
    globalThis.still = async () => {
      const count = () => [...document.querySelectorAll("rebounce-viewer")].reduce((sum, it) => sum + (it.stats()?.frames ?? 0), 0);
      for (let before = -1; before !== count(); await pause(500)) {
        before = count();
        await idle();
      }
      return viewer.stats().frames;
    };
    // Resolves when the browser has told whether an element can be seen, and so has told the element.
    globalThis.seen = (element, expected) =>
      new Promise((done) => {
        const observer = new IntersectionObserver((entries) => {
          if (entries.at(-1).isIntersecting !== expected) return;
          observer.disconnect();
          setTimeout(done);
        });
        observer.observe(element);
      });
    const types = ["load", "error", "progress", "camera-change", "light-change", "light-hover", "light-select", "play", "pause", "finished"];
    for (const type of types) {
      const note = (event) => event.target.localName === "rebounce-viewer" && events.push({ type, ...event.detail });
      document.addEventListener(type, note, true);
    }
    // Resolves with the next outcome after the first `seen` ones.
    globalThis.outcome = async (seen = 0) => {
      for (;;) {
        const outcomes = events.filter((event) => event.type === "load" || event.type === "error");
        if (outcomes.length > seen) return outcomes[seen];
        await new Promise((later) => setTimeout(later, 50));
      }
    };
  }, HANGS);
  if (html) {
    context.served ??= await served(context.address);
    const { headers, text } = context.served;
    const body = text.replace(/<rebounce-viewer[^]*<\/rebounce-viewer>/, html);
    await page.route(context.address + query.replace(/#.*/, ""), (route) => route.fulfill({ headers, body }));
  }
  if (prepare) await page.addInitScript(prepare, argument);
  for (const [pattern, route] of Object.entries(routes)) await page.route(pattern, route);
  await page.goto(context.address + query);
  return { page, faults };
}

/** The page as it is served, with the headers that matter. */
async function served(address) {
  const response = await fetch(address);
  const names = ["content-type", "content-security-policy"];
  const headers = Object.fromEntries(names.map((name) => [name, response.headers.get(name) ?? ""]));
  check(headers["content-security-policy"] !== "", "the page is served without a content security policy");
  return { headers, text: await response.text() };
}

/** The next load or error event after the first `seen` ones. */
export const outcome = (page, seen = 0) =>
  within("the scene", page.evaluate((count) => globalThis.outcome(count), seen));

/** What the element shows of a failure. */
export const shown = (page) =>
  page.evaluate(() => {
    const { shadowRoot } = document.querySelector("rebounce-viewer");
    const alert = shadowRoot.querySelector("[role=alert]");
    const canvas = shadowRoot.querySelector("canvas");
    return {
      alert: alert.hidden ? "" : alert.querySelector("p").textContent,
      markup: alert.querySelectorAll("p *").length,
      canvas: getComputedStyle(canvas).visibility === "visible",
    };
  });

/** The next outcome is this failure: an event with the code, and a sentence where the picture was. */
export async function expectFailure(page, code, seen = 0) {
  const event = await outcome(page, seen);
  equal(event.type, "error", "the event");
  equal(event.code, code, `the code (${event.message})`);
  const { alert, markup, canvas } = await shown(page);
  equal(alert, event.message, "the message in the page");
  check(/^\S.{15,}[.!?]$/s.test(alert), `no sentence: ${alert}`);
  equal(markup, 0, "elements made from the message");
  check(!canvas, "a blank canvas is shown");
}

/** Opens the page with this element and waits for the scene. */
export async function loaded(context, html = PLAIN, options = {}) {
  const opened = await open(context, { html, ...options });
  const event = await outcome(opened.page);
  equal(event.type, "load", event.message ?? "the event");
  return opened;
}
