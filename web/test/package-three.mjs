// The package in apps with three.js and with React Three Fiber, as others have them.

import { cp, mkdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { HANGS, within } from "./browser.mjs";
import { block } from "./guide.mjs";
import { check, equal } from "./harness.mjs";
import { serveFolder } from "./serve.mjs";
import { room } from "./three/rooms.mjs";

const PAGE = "three.md";

/** Runs the tests. `tools`: runs programs, installs an app. */
export async function threeApps(harness, { browser, work, rebounce, tools }) {
  const [glb, rbn] = ["room.glb", "room.rbn"].map((name) => path.join(work, name));
  await writeFile(glb, await room(false).glb());
  await tools.exec(rebounce, ["bake", glb, "--preset", "draft", "--functions", "6000", "-o", rbn]);

  /** Serves a folder with the room in it, and looks at the page once `shown` says so. */
  const opened = async (folder, shown, look) => {
    for (const file of [glb, rbn]) await cp(file, path.join(folder, path.basename(file)));
    const { address, end } = await serveFolder(folder);
    const page = await browser.newPage({ viewport: { width: 320, height: 240 } });
    page.setDefaultTimeout(1000 * HANGS);
    const faults = [];
    page.on("pageerror", (error) => faults.push(String(error)));
    page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    try {
      await page.goto(address);
      await within("the scene", page.waitForFunction(shown));
      await look(page);
      equal(faults.join("\n"), "", "faults");
    } catch (error) {
      throw faults.length > 0 ? new Error(`${error.message}\n${faults.join("\n")}`) : error;
    } finally {
      await page.close();
      end();
    }
  };

  await harness.test("package::a_vite_app_with_three_in_strict_typescript_is_lit", async () => {
    const folder = await tools.install("three");
    await tools.exec("npm", ["run", "build"], { cwd: folder });
    await opened(path.join(folder, "dist"), () => /^(lit|dark)$/.test(document.title), async (page) => {
      equal(await page.title(), "lit", "probes");
    });
  });

  await harness.long("package::an_app_with_react_three_fiber_is_lit", async () => {
    const folder = await tools.install("fiber");
    await mkdir(path.join(folder, "src"), { recursive: true });
    for (const file of ["Rebounce.jsx", "main.jsx"]) await writeFile(path.join(folder, "src", file), await block(PAGE, file));
    await tools.exec("npm", ["run", "build"], { cwd: folder });
    await opened(path.join(folder, "dist"), () => document.querySelector("canvas"), async (page) => {
      let ceiling = 0;
      for (let i = 0; i < 600 && ceiling <= 10; i += 1) {
        ceiling = await within("a frame", page.evaluate(brightnessAtTop));
        await new Promise((later) => setTimeout(later, 100));
      }
      check(ceiling > 10, `the ceiling, which no lamp reaches, has ${ceiling}`);
    });
  });
}

/** In a page: brightness of the ceiling, which gets bounced light alone. */
function brightnessAtTop() {
  const canvas = document.querySelector("canvas");
  const copy = new OffscreenCanvas(canvas.width, canvas.height);
  const context = copy.getContext("2d");
  return new Promise((done) =>
    requestAnimationFrame(() => {
      context.drawImage(canvas, 0, 0);
      done(context.getImageData(canvas.width / 2, 2, 1, 1).data[1]);
    }),
  );
}
