import { writeFile } from "node:fs/promises";
import { launch, within } from "/work/main/web/test/browser.mjs";
const browser = await launch();
const page = await browser.newPage({ viewport: { width: 480, height: 270 } });
page.on("pageerror", (e) => console.error(`page: ${e}`));
page.on("console", (m) => console.error(`console ${m.type()}: ${m.text()}`));
await page.addInitScript(() => {
  globalThis.outcome = new Promise((resolve) => {
    document.addEventListener("load", (event) => event.detail && resolve({}), true);
    document.addEventListener("error", (event) => event.detail && resolve(event.detail), true);
  });
});
await page.goto(process.argv[2]);
console.log(await within(300, "load", page.evaluate(() => globalThis.outcome)));
const shot = JSON.parse(process.argv[3] ?? "null");
if (shot) {
  const r = await page.evaluate(async (shot) => {
    const v = document.querySelector("rebounce-viewer");
    const keys = Object.getOwnPropertyNames(Object.getPrototypeOf(v));
    try { v.setShot ? v.setShot(shot) : (v.camera = shot.camera, v.lights = shot.lights); } catch (e) { return { keys, e: String(e) }; }
    await new Promise((r) => setTimeout(r, 8000));
    return { keys, stats: v.stats ? (typeof v.stats === "function" ? v.stats() : v.stats) : 0 };
  }, shot);
  console.log(JSON.stringify(r));
}
const png = await page.screenshot({ timeout: 300_000 });
await writeFile(process.argv[4] ?? "/tmp/page.png", png);
await browser.close();
