// The site as `cargo xtask site` builds it: every page opened, in both colour schemes.

import { mkdtemp, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { DEVICE_PIXELS, HANGS, launch, spread, within } from "./browser.mjs";
import { check, equal } from "./harness.mjs";
import { serveFolder } from "./serve.mjs";

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];

/** Runs the tests of the site in a folder. */
export async function runSiteTests(harness, folder) {
  const pages = (await readdir(folder)).filter((name) => name.endsWith(".html"));
  const server = await serveFolder(folder);
  const browser = await launch();
  const context = { browser, folder, address: server.address, axe: await readFile(AXE, "utf8") };
  try {
    await harness.test("site::all_links_resolve", () => links(context, pages));
    for (const name of pages) {
      await harness.test(`site::${name.replace(".html", "")}_is_sound_and_accessible`, () => sound(context, name));
    }
    await harness.test("site::the_sun_and_the_lamps_follow_the_hour", () => apartment(context));
    await harness.test("site::the_figure_walks_and_its_light_with_it", () => walk(context));
    await harness.test("site::the_comparison_moves_by_keyboard", () => comparison(context));
    await harness.test("site::the_hero_fills_its_frame", () => hero(context));
    await harness.long("site::a_visitor_bakes_a_sample_and_saves_it", () => sample(context));
    await harness.test("site::a_wrong_file_and_cancel_leave_the_page_sound", () => wrongFiles(context));
    await harness.test("site::the_gallery_has_four_scenes_with_their_figures", () => gallery(context));
    await harness.test("site::a_phone_scrolls_past_every_viewer", () => phone(context));
    await harness.test("site::the_hall_in_three_has_bounced_light", () => hall(context));
    await harness.test("site::without_webgpu_the_pages_say_so_and_stay_sound", () => withoutWebgpu(context));
  } finally {
    await browser.close();
    server.end();
  }
}

/** Opens a page of the site; what goes wrong in it is gathered. */
async function open({ browser, address }, name, { prepare, ...options } = {}) {
  const page = await browser.newPage({ viewport: { width: 480, height: 640 }, deviceScaleFactor: DEVICE_PIXELS, ...options });
  page.setDefaultTimeout(1000 * HANGS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on("requestfailed", (request) => {
    // An element that can show nothing breaks its download off.
    const { errorText } = request.failure();
    if (errorText !== "net::ERR_ABORTED") faults.push(`${request.url()}: ${errorText}`);
  });
  page.on("request", (request) => {
    const { protocol, origin } = new URL(request.url());
    const own = ["data:", "blob:"].includes(protocol) || `${origin}/` === address;
    if (!own) faults.push(`a request to ${request.url()}`);
  });
  await page.addInitScript(() => {
    globalThis.violations = [];
    document.addEventListener("securitypolicyviolation", (event) =>
      violations.push(`${event.violatedDirective}: ${event.blockedURI} ${event.sample}`),
    );
  });
  if (prepare) await page.addInitScript(prepare);
  await page.goto(address + name);
  return { page, faults };
}

/** Waits until every viewer of the page that names a file has loaded; throws what one of them says instead. */
async function loaded(page) {
  const wait = page.evaluate(async () => {
    const viewers = [...document.querySelectorAll("rebounce-viewer[src]")];
    for (const viewer of viewers) viewer.loading = "eager";
    const message = (viewer) => viewer.shadowRoot.querySelector("[role=alert]").textContent;
    for (;;) {
      const failed = viewers.map(message).find(Boolean);
      if (failed || viewers.every((viewer) => viewer.loaded)) return failed ?? "";
      await new Promise((later) => setTimeout(later, 50));
    }
  });
  equal(await within("the scene", wait), "", "the viewer's message");
}

/** What axe finds, one line each. */
async function violations(page, axe) {
  // An injected script element would break the page's policy; this does not.
  if (!(await page.evaluate(() => "axe" in globalThis))) await page.evaluate(axe);
  return page.evaluate(async (values) => {
    const { violations } = await axe.run(document, { runOnly: { type: "tag", values } });
    return violations.flatMap(({ id, help, nodes }) => nodes.map(({ target }) => `${id}: ${help}: ${target.flat().join(" ")}`));
  }, RULES);
}

/** Every viewer of the page that names a file has a poster of its own shape. */
async function posters(page, name) {
  const shapes = await page.evaluate(() => {
    const each = [...document.querySelectorAll("rebounce-viewer[src]")].map(async (viewer) => {
      const image = new Image();
      image.src = viewer.poster;
      await image.decode();
      const { aspectRatio } = getComputedStyle(viewer);
      const [width, height] = aspectRatio.split("/").map(Number);
      return { poster: viewer.getAttribute("poster"), picture: image.naturalWidth / image.naturalHeight, stage: width / height };
    });
    return Promise.all(each);
  });
  for (const { poster, picture, stage } of shapes) {
    check(Math.abs(picture / stage - 1) < 0.02, `${name}: ${poster} is ${picture}:1, the stage ${stage}:1`);
  }
}

async function sound(context, name) {
  const { page, faults } = await open(context, name, { colorScheme: "light" });
  await posters(page, name);
  await loaded(page);
  const viewers = await page.locator("rebounce-viewer[src]").count();
  for (let i = 0; i < viewers; i += 1) {
    const pixels = await page.evaluate(
      async (i) => Array.from(await document.querySelectorAll("rebounce-viewer[src]")[i].readPixels(64, 36)),
      i,
    );
    const { mean, deviation } = spread(pixels);
    check(deviation > 4, `viewer ${i}: brightness ${mean.toFixed(1)} +- ${deviation.toFixed(1)} of 255`);
  }
  // The panel of the element, open.
  await page.evaluate(() => {
    for (const { shadowRoot } of document.querySelectorAll("rebounce-viewer")) {
      for (const details of shadowRoot.querySelectorAll("details")) details.open = true;
    }
  });
  const found = [];
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    for (const line of await violations(page, context.axe)) found.push(`${colorScheme}: ${line}`);
  }
  equal(found.join("\n"), "", "what axe finds");
  // Narrow as a phone, nothing sticks out.
  await page.setViewportSize({ width: 320, height: 640 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  check(wide <= 320, `the page is ${wide} pixels wide on a screen of 320`);
  equal((await page.evaluate(() => globalThis.violations)).join("\n"), "", "violations of the policy");
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

/** Every address that a page names, but for other sites', is a file of the folder or an id of a page. */
async function links(context, pages) {
  const missing = [];
  for (const name of pages) {
    const { page } = await open(context, name, { javaScriptEnabled: false });
    const named = await page.evaluate(() =>
      [...document.querySelectorAll("[href], [src], [poster]")].flatMap((element) =>
        ["href", "src", "poster"].map((attribute) => element.getAttribute(attribute)).filter(Boolean),
      ),
    );
    await page.close();
    check(named.length > 5, `${name} names ${named.length} addresses`);
    for (const address of named) {
      const url = new URL(address, context.address + name);
      if (`${url.origin}/` !== context.address) {
        equal(url.origin, "https://github.com", "another site");
        continue;
      }
      const file = path.join(context.folder, decodeURIComponent(url.pathname));
      const text = await readFile(file, "utf8").catch(() => undefined);
      const id = url.hash.slice(1);
      if (text === undefined || (id && !text.includes(`id="${id}"`))) missing.push(`${name}: ${address}`);
    }
  }
  equal(missing.join("\n"), "", "addresses that lead nowhere");
}

async function apartment(context) {
  const { page, faults } = await open(context, "apartment.html");
  await loaded(page);
  const at = async (hour) => {
    await page.locator("#hour").fill(String(hour));
    return page.evaluate(async () => {
      const viewer = document.querySelector("rebounce-viewer");
      const pixels = await viewer.readPixels(64, 36);
      return { lights: viewer.lights, clock: document.getElementById("clock").value, pixels: Array.from(pixels) };
    });
  };
  const noon = await at(12);
  equal(noon.clock, "12:00", "the clock");
  const of = ({ lights }, type) => lights.find((light) => light.type === type);
  const lamps = ({ lights }) => lights.filter(({ type }) => !["directional", "environment"].includes(type));
  const sun = of(noon, "directional");
  check(sun.intensity > 10 && sun.direction[1] < -0.5, `the sun at noon: ${JSON.stringify(sun)}`);
  equal(lamps(noon).length, 8, "lamps, shades and the television");
  check(lamps(noon).every(({ intensity }) => intensity === 0), "a lamp is on at noon");
  const morning = await at(8);
  const { direction } = of(morning, "directional");
  check(direction[0] < -0.3, `in the morning the light comes from ${JSON.stringify(direction)}`);
  // The sky turns with the sun, and is dimmer when that is low.
  const [early, high] = [morning, noon].map((hour) => of(hour, "environment"));
  const azimuth = ({ direction: [x, , z] }) => (Math.atan2(x, z) * 180) / Math.PI;
  const more = high.rotation_deg - early.rotation_deg - azimuth(sun) + azimuth({ direction });
  check(Math.cos((more * Math.PI) / 180) > 0.9999, `the sky turned by ${more} degrees more than the sun`);
  check(early.intensity < 0.95 * high.intensity, `the sky at 8 has ${early.intensity}, at noon ${high.intensity}`);
  const night = await at(22);
  equal(night.clock, "22:00", "the clock");
  check(of(night, "directional").intensity < 1, "the sun shines at night");
  check(of(night, "environment").intensity < 0.05 * high.intensity, "the sky shines at night");
  check(lamps(night).every(({ intensity }) => intensity >= 1), "a lamp is off at night");
  const moved = noon.pixels.filter((value, i) => Math.abs(value - night.pixels[i]) > 20).length;
  check(moved > noon.pixels.length / 10, `noon and night differ in ${moved} of ${noon.pixels.length} values`);
  // A lamp is switched by hand, and stays so.
  await page.locator("#lamps input").first().uncheck();
  const dark = await at(23);
  const off = lamps(dark).filter(({ intensity }) => intensity === 0);
  equal(off.map(({ name }) => name).join(), "Living room,Lamp shade", "what is switched off");
  await page.locator("#hour").focus();
  await page.keyboard.press("ArrowLeft");
  equal(await page.locator("#hour").getAttribute("aria-valuetext"), "22:45", "the hour after a key");
  await page.getByRole("button", { name: "Study" }).click();
  const camera = await page.evaluate(() => document.querySelector("rebounce-viewer").camera);
  check(Math.abs(camera.position[0] - 6.4) < 0.01, `the camera is at ${camera.position}`);
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

async function walk(context) {
  const { page, faults } = await open(context, "walk.html");
  await loaded(page);
  await page.locator("#walk").waitFor();
  const seen = () =>
    page.evaluate(async () => {
      const viewer = document.getElementById("viewer");
      const pixels = Array.from(await viewer.readPixels(64, 36));
      const { solver, antiradiance } = viewer.stats();
      return { pixels, solver, links: antiradiance?.links, time: viewer.shot.time };
    });
  const apart = (a, b) => a.pixels.filter((value, i) => Math.abs(value - b.pixels[i]) > 8).length / a.pixels.length;
  const first = await seen();
  equal(first.solver, "antiradiance", "what computes bounced light");
  check(Math.abs(first.time - 1.8) < 1e-6, `it begins at ${first.time} s`);
  await page.locator("#moment").fill("3.2");
  const later = await seen();
  equal(await page.locator("#seconds").textContent(), "3.2 s", "the moment");
  check(apart(first, later) > 0.02, `${apart(first, later)} of the picture has changed`);
  check(later.links > 0 && later.links !== first.links, `${first.links} links, then ${later.links}`);
  await page.getByRole("radio", { name: "does not" }).check();
  equal((await seen()).solver, "operator", "what computes bounced light without the figure");
  await page.getByRole("radio", { name: "Afternoon sun" }).check();
  check(apart(later, await seen()) > 0.2, "the sun changes little");
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

async function comparison(context) {
  const { page, faults } = await open(context, "compare.html");
  const slider = page.locator("#at");
  await slider.waitFor({ state: "attached" });
  const line = () => page.evaluate(() => getComputedStyle(document.querySelector(".pair")).getPropertyValue("--at"));
  equal(await line(), "50%", "the line at first");
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  equal(await line(), "51%", "the line after a key");
  await page.keyboard.press("Home");
  equal(await line(), "0%", "the line at the start");
  const clip = await page.evaluate(() => getComputedStyle(document.getElementById("right")).clipPath);
  check(/0%\)$/.test(clip), `the right picture is cut to ${clip}`);
  check(/0 percent/.test(await slider.getAttribute("aria-valuetext")), "the value is not told");
  await page.getByRole("radio", { name: "Direct light only" }).first().check();
  equal(await page.locator("#left-tag").textContent(), "Direct light only", "the left picture");
  check((await page.locator("#left").getAttribute("src")).endsWith("compare-direct.png"), "the left file");
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

/** Waits until a viewer shows the shot that the page names. */
const shot = (page, i = 0) =>
  page.waitForFunction(async (i) => {
    const viewer = document.querySelectorAll("rebounce-viewer")[i];
    const { camera } = await (await fetch(viewer.dataset.shot)).json();
    return viewer.loaded && camera.position.every((x, k) => Math.abs(x - viewer.camera.position[k]) < 1e-3);
  }, i);

async function hero(context) {
  const { page, faults } = await open(context, "index.html");
  await loaded(page);
  await shot(page);
  const size = 48;
  const pixels = await page.evaluate(async (size) => Array.from(await document.querySelector("rebounce-viewer").readPixels(size, size)), size);
  const rim = [...Array(size * size).keys()].filter((i) => [0, size - 1].includes(i % size) || i < size || i >= size * (size - 1));
  const black = rim.filter((i) => pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2] < 12);
  equal(black.length, 0, "black pixels on the rim");
  const rows = await page.locator("#browsers").locator("xpath=..").locator("tbody tr").allTextContents();
  check(rows.length > 5 && rows.every((row) => /\d|not yet/.test(row)), rows.join("\n"));
  const lightAt = async (hour) => {
    await page.locator("#hour").fill(String(hour));
    return page.evaluate(() => document.querySelector("rebounce-viewer").lights);
  };
  const [morning, evening] = [await lightAt(9), await lightAt(17)];
  for (const i of [0, 1]) check(JSON.stringify(morning[i]) !== JSON.stringify(evening[i]), `light ${i} is the same at 9 and at 17`);
  for (const browser of ["Chrome", "Edge", "Safari", "Firefox"]) check(rows.some((row) => row.includes(browser)), `no ${browser}`);
  check(/20\d\d/.test(await page.locator("caption").textContent()), "the table has no date");
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

/** What the page has fetched of the baker and of scenes to be baked. */
const fetched = (page) =>
  page.evaluate(() => {
    const names = performance.getEntriesByType("resource").map(({ name }) => new URL(name).pathname);
    return names.filter((name) => /\/bake[^/]*\.js$|baker|\.gl(b|tf)$/.test(name)).join(" ");
  });

/** In the page: writes down what the visitor's viewer and the lines below it tell. */
function record() {
  const viewer = document.getElementById("own-viewer");
  globalThis.told = { stages: [], line: [], said: [], errors: [] };
  viewer.addEventListener("bake-progress", ({ detail }) => told.stages.push(detail.stage));
  viewer.addEventListener("error", ({ detail }) => told.errors.push(detail.message));
  for (const name of ["line", "said"]) {
    const element = document.getElementById(`own-${name}`);
    new MutationObserver(() => told[name].push(element.textContent)).observe(element, { childList: true });
  }
}

async function sample(context) {
  const { page, faults } = await open(context, "index.html");
  await loaded(page);
  await page.locator("#own").scrollIntoViewIfNeeded();
  equal(await fetched(page), "", "fetched before the visitor asks");
  await page.evaluate(record);
  const height = () => page.evaluate(() => document.body.scrollHeight);
  const before = await height();
  const early = page.evaluate(async () => {
    const viewer = document.getElementById("own-viewer");
    await new Promise((done, failed) => {
      viewer.addEventListener("load", done, { once: true });
      viewer.addEventListener("error", ({ detail }) => failed(new Error(detail.message)), { once: true });
    });
    const [isDone, file] = [told.stages.includes("done"), viewer.toRbn()];
    return { isDone, isFile: file !== undefined, pixels: Array.from(await viewer.readPixels(64, 40)) };
  });
  await page.getByRole("button", { name: "Red and green" }).click();
  const { isDone, isFile, pixels } = await within("the first picture", early);
  check(!isDone && !isFile, "the first picture comes with the baked file");
  const { mean, deviation } = spread(pixels);
  check(deviation > 4, `the first picture: brightness ${mean.toFixed(1)} +- ${deviation.toFixed(1)} of 255`);
  const save = page.getByRole("button", { name: "Save red-and-green.rbn" });
  await save.waitFor();
  const { stages, line, said, errors } = await page.evaluate(() => told);
  equal(errors.join("\n"), "", "errors");
  equal(stages.at(-1), "done", "the last stage");
  check(line.some((text) => /^[A-Z][a-z ]+.*: \d+%/.test(text)), `no progress in ${JSON.stringify(line.slice(0, 5))}`);
  check(said.length > 1 && said.length < 8, `screen readers hear ${JSON.stringify(said)}`);
  check(/^Baked in \d+ s/.test(said.at(-1)), said.at(-1));
  equal(await height(), before, "the page's height");
  const download = page.waitForEvent("download");
  await save.click();
  const file = await download;
  equal(file.suggestedFilename(), "red-and-green.rbn", "the file's name");
  equal((await readFile(await file.path())).subarray(0, 8).toString("latin1"), "REBOUNCE", "the file's first bytes");
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    equal((await violations(page, context.axe)).join("\n"), "", `what axe finds, ${colorScheme}`);
  }
  equal((await page.evaluate(() => globalThis.violations)).join("\n"), "", "violations of the policy");
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

/** Drops files of this machine on an element. */
async function drop(page, locator, files) {
  await locator.scrollIntoViewIfNeeded();
  const box = await locator.boundingBox();
  const client = await page.context().newCDPSession(page);
  const at = { x: box.x + box.width / 2, y: box.y + box.height / 2, data: { items: [], files, dragOperationsMask: 1 } };
  for (const type of ["dragEnter", "dragOver", "drop"]) await client.send("Input.dispatchDragEvent", { type, ...at });
  await client.detach();
}

async function wrongFiles(context) {
  // Without it the page is still scrolling when something is dropped.
  const { page, faults } = await open(context, "index.html", { reducedMotion: "reduce" });
  const viewer = page.locator("#own-viewer");
  const says = (words) =>
    page.waitForFunction((words) => document.getElementById("own-viewer").shadowRoot.querySelector("[role=alert]").textContent.includes(words), words);
  const isIdle = () => page.evaluate(() => ["progress", "cancel", "save"].every((name) => document.getElementById(`own-${name}`).hidden));
  const folder = await mkdtemp(path.join(tmpdir(), "rebounce-site-"));
  try {
    const [notes, broken] = ["notes.txt", "broken.glb"].map((name) => path.join(folder, name));
    for (const file of [notes, broken]) await writeFile(file, "no scene");
    await page.evaluate(record);
    await drop(page, viewer, [notes]);
    await says('"notes.txt" is no scene');
    check(await isIdle(), "something goes on after a wrong file");
    equal((await violations(page, context.axe)).join("\n"), "", "what axe finds beside an error");
    await page.locator("#own-files-input").setInputFiles([broken]);
    await says("is not a glTF 2.0 file");
    check(await isIdle(), "something goes on after a broken file");
  } finally {
    await rm(folder, { recursive: true });
  }
  // Beside the viewer, a file does not take the page's place.
  await drop(page, page.locator("#how"), [path.join(context.folder, "icon.svg")]);
  equal(await page.evaluate(() => location.pathname), "/index.html", "the page after a drop beside the viewer");
  // By keys alone: a sample, Cancel, and what is next.
  await page.getByRole("button", { name: "Courtyard" }).focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.getElementById("own-viewer").loaded);
  await page.getByRole("button", { name: "Cancel" }).focus();
  await page.keyboard.press("Enter");
  equal(await page.locator("#own-said").textContent(), "Cancelled. What you see is the last preview.", "what is said");
  check(await isIdle(), "something goes on after Cancel");
  equal(await page.evaluate(() => document.activeElement.id), "own-files", "what has the focus after Cancel");
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

async function gallery(context) {
  const { page, faults } = await open(context, "gallery.html");
  const figures = () => page.evaluate(() => [...document.querySelectorAll(".figures")].map((list) => [...list.querySelectorAll("dt, dd")].map(({ textContent }) => textContent.trim()).join(" ")));
  const built = await figures();
  equal(built.length, 4, "scenes");
  for (const text of built) check(/^File [\d.]+ MB Bake [\d.]+ s Frame [\d.]+ ms$/.test(text), `figures: ${text}`);
  await loaded(page);
  for (let i = 0; i < 4; i += 1) await shot(page, i);
  // This browser's adapter tells how long its frames take.
  const tells = await page.evaluate(() => Object.keys(document.querySelector("rebounce-viewer").stats().milliseconds).length > 0);
  if (tells) {
    await page.waitForFunction(() => [...document.querySelectorAll("[data-frame]")].every(({ textContent }) => /^[\d.]+ ms here$/.test(textContent)));
    check((await page.locator("#frame-words").textContent()).includes("this browser"), "the words are still of the build");
  }
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

/** At a phone's size nothing sticks out, and a finger that begins on a viewer scrolls the page. */
async function phone(context) {
  for (const name of ["index.html", "gallery.html", "apartment.html", "embed.html"]) {
    const { page, faults } = await open(context, name, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    check(wide <= 390, `${name} is ${wide} pixels wide`);
    await page.locator("rebounce-viewer").first().scrollIntoViewIfNeeded();
    const box = await page.locator("rebounce-viewer").first().boundingBox();
    const before = await page.evaluate(() => scrollY);
    const client = await page.context().newCDPSession(page);
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const send = (type, at) => client.send("Input.dispatchTouchEvent", { type, touchPoints: at === undefined ? [] : [{ x, y: y + at }] });
    await send("touchStart", 0);
    for (const at of [-20, -40, -60, -80, -100]) await send("touchMove", at);
    await send("touchEnd");
    await within("scrolling", page.waitForFunction((from) => scrollY > from + 40, before));
    equal(faults.join("\n"), "", "faults");
    await page.close();
  }
}

async function hall(context) {
  const { page, faults } = await open(context, "three.html");
  await page.waitForFunction(() => document.getElementById("status").textContent.includes("lit by probes"));
  const brightness = () =>
    within("a picture of the hall", page.evaluate(async () => {
      const canvas = document.getElementById("hall");
      const next = () => new Promise(requestAnimationFrame);
      // What was changed is drawn in the next picture; it can be read before the browser shows it.
      await next();
      await next();
      const [width, height] = [64, 36];
      const context = new OffscreenCanvas(width, height).getContext("2d");
      context.drawImage(canvas, 0, 0, width, height);
      const { data } = context.getImageData(0, 0, width, height);
      return data.reduce((sum, x, i) => sum + (i % 4 < 3 ? x : 0), 0) / (3 * width * height);
    }));
  const lit = await brightness();
  await page.locator("#bounced").uncheck();
  const dark = await brightness();
  check(lit > 50 && dark < 0.5 * lit, `brightness ${lit} with bounced light, ${dark} without`);
  await page.locator("#bounced").check();
  await page.locator("#turn").fill("-40");
  const turned = await brightness();
  check(turned > 50, `brightness ${turned} with the sun turned`);
  equal(faults.join("\n"), "", "faults");
  await page.close();
}

async function withoutWebgpu(context) {
  const prepare = () => delete Navigator.prototype.gpu;
  const { page, faults } = await open(context, "three.html", { prepare });
  await page.waitForFunction(() => document.getElementById("status").textContent.includes("no WebGPU"));
  equal(faults.join("\n"), "", "faults");
  await page.close();
  for (const name of ["index.html", "apartment.html"]) {
    const { page, faults } = await open(context, name, { prepare });
    await page.waitForFunction(() => document.querySelector("rebounce-viewer").shadowRoot.querySelector("[role=alert]").textContent);
    const seen = await page.evaluate(() => {
      const { shadowRoot } = document.querySelector("rebounce-viewer");
      const poster = shadowRoot.querySelector("[part=poster] img");
      return { poster: poster.checkVisibility() && poster.naturalWidth > 0, words: shadowRoot.querySelector("[role=alert]").textContent };
    });
    check(seen.poster, "the poster is gone");
    check(seen.words.includes("needs WebGPU"), seen.words);
    equal((await violations(page, context.axe)).join("\n"), "", "what axe finds");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  }
}
