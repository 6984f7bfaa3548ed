// The npm packages as others have them: their tarballs, installed into small apps that are built and opened.

import { execFile, spawn } from "node:child_process";
import { cp, mkdir, readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { promisify } from "node:util";
import { HANGS, launch, spread, within } from "./browser.mjs";
import { check, equal } from "./harness.mjs";
import { commandTests } from "./command.mjs";
import { threeApps } from "./package-three.mjs";
import { serveFolder } from "./serve.mjs";

const APPS = new URL("apps/", import.meta.url);

/** Runs the tests of the packages. `paths`: a folder to work in, the program rebounce, the tarballs. */
export async function runPackageTests(harness, { work, rebounce, viewer, command, native }) {
  const scene = path.join(work, "package.rbn");
  await exec(rebounce, ["bake", "builtin:cornell-box", "--preset", "draft", "--functions", "4000", "-o", scene]);
  const glb = path.join(work, "package.glb");
  await exec(rebounce, ["export", scene, "--lightmap-texture", "--max-size", "64", "-o", glb]);
  const browser = await launch();
  const context = { browser, work, tarball: viewer, scene };
  const tools = {
    exec,
    scene: { glb },
    install: (name, tarballs) => install({ work }, name, tarballs),
    served: (folder) => served(context, folder),
    developed: (folder) => developed(context, folder),
  };
  try {
    if (native === "none") console.log("tests of the command: left out, there is no native package for this machine");
    else await commandTests(harness, { work, rebounce, viewer, command, native, tools });
    await contents(harness, context);
    await harness.test("package::a_plain_page_shows_the_scene", async () => {
      await served(context, await install(context, "plain"));
    });
    await harness.test("package::a_vite_app_in_strict_typescript_shows_the_scene", async () => {
      const folder = await build(context, "vite");
      await served(context, folder, hasAddedALamp);
    });
    await harness.test("package::vites_development_server_shows_the_scene", async () => {
      await developed(context, path.join(work, "apps/vite"), hasAddedALamp);
    });
    await harness.test("package::a_react_app_in_tsx_shows_the_scene", async () => {
      const folder = await build(context, "react");
      await served(context, folder, async (page) => {
        await page.waitForFunction(() => document.querySelector("output").textContent !== "nothing yet");
        const told = await page.evaluate(() => document.querySelector("output").textContent);
        check(/\/scene\.rbn: 1 light$/.test(told), `the app says: ${told}`);
        check(await page.evaluate(() => document.querySelector("rebounce-viewer").controls), "no controls");
      });
    });
    await threeApps(harness, { browser, work, rebounce, tools: { exec, install: (name) => install(context, name) } });
  } finally {
    await browser.close();
  }
}

/** What is in the tarball, and what its package.json and manifest say of it. */
async function contents(harness, context) {
  const app = await install(context, "plain");
  const folder = path.join(app, "node_modules/rebounce-viewer");
  const { stdout } = await exec("tar", ["-tzf", context.tarball]);
  const files = stdout.split("\n").filter(Boolean).map((file) => file.replace(/^package\//, ""));

  await harness.test("package::holds_the_element_its_types_its_papers_and_nothing_else", async () => {
    for (const name of ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "LICENSE-OTHERS", "custom-elements.json", "react.d.ts"]) {
      check(files.includes(name), `${name} is not in the package`);
    }
    const known = /^(package\.json|README\.md|LICENSE-\w+|custom-elements\.json|react\.d\.ts|dist\/([\w-]+\.(js|wasm)|(\w+\/)?[\w-]+\.d\.ts|integrity\.json))$/;
    const others = files.filter((file) => !known.test(file) || /^dist\/page[./]/.test(file));
    equal(others.join(" "), "", "files that do not belong there");
  });

  await harness.test("package::every_export_is_there", async () => {
    const { exports, sideEffects } = JSON.parse(await readFile(path.join(folder, "package.json"), "utf8"));
    const targets = Object.values(exports).flatMap((target) => (typeof target === "string" ? [target] : Object.values(target)));
    const named = [...targets, ...sideEffects].map((target) => target.replace(/^\.\//, ""));
    const missing = named.filter((target) => !target.includes("*") && !files.includes(target));
    equal(missing.join(" "), "", "files that package.json names and the package lacks");
  });

  await harness.test("package::on_a_server_the_import_defines_nothing", async () => {
    const script = `
      const before = Object.getOwnPropertyNames(globalThis);
      const { RebounceViewer } = await import("rebounce-viewer");
      const { sun } = await import("rebounce-viewer/daylight");
      const more = Object.getOwnPropertyNames(globalThis).filter((name) => !before.includes(name));
      console.log(JSON.stringify({ more, element: typeof RebounceViewer, up: -sun({ hour: 12, latitude: 0 }).direction[1] }));`;
    const { stdout, stderr } = await exec(process.execPath, ["--input-type=module", "-e", script], { cwd: app });
    const { more, element, up } = JSON.parse(stdout);
    equal(more.join(), "", "new names of the global object");
    equal(element, "function", "the class");
    check(up > 0.99, `at noon on the equator in spring the sun's height is ${up}`);
    equal(stderr, "", "what is said");
  });

  await harness.test("package::the_manifest_lists_what_the_element_has", async () => {
    const { modules } = JSON.parse(await readFile(path.join(folder, "custom-elements.json"), "utf8"));
    equal(modules.length, 1, "modules");
    check(files.includes(modules[0].path), `${modules[0].path} is not in the package`);
    const element = modules[0].declarations.find(({ customElement }) => customElement);
    equal(element.tagName, "rebounce-viewer", "the element");
    const names = (list) => list.map(({ name }) => name);
    const server = await serveFolder(app);
    const page = await context.browser.newPage();
    await page.goto(server.address);
    const real = await page.evaluate(async () => {
      const element = await customElements.whenDefined("rebounce-viewer");
      const members = [];
      for (let { prototype } = element; prototype !== HTMLElement.prototype; prototype = Object.getPrototypeOf(prototype)) {
        members.push(...Object.getOwnPropertyNames(prototype));
      }
      return { members, attributes: element.observedAttributes };
    });
    await page.close();
    server.end();
    equal(names(element.attributes).sort().join(), real.attributes.sort().join(), "attributes");
    const missing = names(element.members).filter((name) => !real.members.includes(name));
    equal(missing.join(), "", "members that the element lacks");
    for (const list of ["slots", "cssParts", "cssProperties"]) check(element[list].length >= 3, `${list}: ${names(element[list])}`);
    const { slots, cssParts, cssProperties } = element;
    const silent = [...element.members, ...element.events, ...element.attributes, ...slots, ...cssParts, ...cssProperties].filter((one) => !one.description);
    equal(names(silent).join(), "", "entries without a description");
  });
}

/** Copies an app of test/apps into the work folder and installs tarballs into it; where it lies. */
async function install({ work, tarball }, name, tarballs = [tarball]) {
  const folder = path.join(work, "apps", name);
  const modules = path.join(folder, "node_modules");
  await mkdir(folder, { recursive: true });
  const from = new URL(`${name}/`, APPS).pathname;
  const lock = await readFile(path.join(from, "package-lock.json"), "utf8").catch(() => "");
  const stamp = path.join(modules, ".rebounce-lock");
  const installed = await readFile(stamp, "utf8").catch(() => undefined);
  await cp(from, folder, { recursive: true, filter: (file) => !file.includes("node_modules") });
  const quiet = ["--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"];
  if (installed !== lock) {
    await rm(modules, { recursive: true, force: true });
    if (lock) await exec("npm", ["ci", ...quiet], { cwd: folder });
  }
  for (const one of tarballs) await rm(path.join(modules, path.basename(one).replace(/-\d.*/, "")), { recursive: true, force: true });
  await exec("npm", ["install", "--no-save", "--no-package-lock", ...quiet, ...tarballs], { cwd: folder });
  await writeFile(stamp, lock);
  return folder;
}

/** Builds an app as its author would; the folder to put on a server. */
async function build(context, name) {
  const folder = await install(context, name);
  await exec("npm", ["run", "build"], { cwd: folder });
  return path.join(folder, "dist");
}

/** What the Vite app does once the scene is there. */
async function hasAddedALamp(page) {
  await page.waitForFunction(() => document.title.endsWith("/scene.rbn"));
  equal(await page.evaluate(() => document.querySelector("rebounce-viewer").lights.length), 2, "lights");
}

/** Serves a folder with the scene in it under a strict policy, and looks at the page. */
async function served({ browser, scene }, folder, more) {
  await cp(scene, path.join(folder, "scene.rbn"));
  const { address, end } = await serveFolder(folder);
  try {
    await shows(browser, address, more);
  } finally {
    end();
  }
}

/** Starts Vite's development server on an app with the scene in it, and looks at the page. */
async function developed({ browser, scene }, folder, more) {
  await mkdir(path.join(folder, "public"), { recursive: true });
  await cp(scene, path.join(folder, "public/scene.rbn"));
  const args = ["node_modules/vite/bin/vite.js", "--host", "127.0.0.1"];
  const vite = spawn(process.execPath, args, { cwd: folder, env: { ...process.env, NO_COLOR: "1" } });
  try {
    const address = new Promise((resolve, reject) => {
      let text = "";
      vite.stdout.on("data", (data) => {
        text += data;
        const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(text);
        if (found) resolve(found[0]);
      });
      vite.on("error", reject);
      vite.on("exit", (code) => reject(new Error(`vite ended (${code}): ${text}`)));
    });
    await shows(browser, await within("vite", address), more);
  } finally {
    vite.kill();
  }
}

/** Opens a page, waits for its scene, and looks at the picture. */
async function shows(browser, address, more = () => undefined) {
  const page = await browser.newPage({ viewport: { width: 320, height: 240 } });
  page.setDefaultTimeout(1000 * HANGS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  // A browser asks for an icon by itself.
  const isFault = (message) => message.type() === "error" && !message.location().url.endsWith("/favicon.ico");
  page.on("console", (message) => isFault(message) && faults.push(message.text()));
  try {
    await page.addInitScript(() => {
      globalThis.outcome = new Promise((resolve) => {
        for (const type of ["load", "error"]) {
          const note = (event) => event.target.localName === "rebounce-viewer" && resolve({ type, ...event.detail });
          document.addEventListener(type, note, true);
        }
      });
    });
    await page.goto(address);
    const event = await within("the scene", page.evaluate(() => globalThis.outcome));
    equal(event.type, "load", event.message ?? "the event");
    const read = page.evaluate(async () => Array.from(await document.querySelector("rebounce-viewer").readPixels(128, 72)));
    const { mean, deviation } = spread(await within("the picture", read));
    check(deviation > 4, `brightness ${mean.toFixed(1)} +- ${deviation.toFixed(1)} of 255`);
    await more(page);
    equal(faults.join("\n"), "", "faults");
  } catch (error) {
    throw faults.length > 0 ? new Error(`${error.message}\n${faults.join("\n")}`) : error;
  } finally {
    await page.close();
  }
}

/** Runs a program to its end; where it fails, with what it said. */
async function exec(program, args, options = {}) {
  try {
    return await promisify(execFile)(program, args, { maxBuffer: 1 << 26, ...options });
  } catch (error) {
    const said = `${error.stdout ?? ""}${error.stderr || error.message}`;
    throw new Error(`${path.basename(program)} ${args.join(" ")}: ${said.slice(0, 3000)}`);
  }
}
