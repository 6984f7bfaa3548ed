import { readFile } from "node:fs/promises";
import { loaded } from "./open.mjs";
export async function turntime(harness, context) {
  await harness.test("turntime", async () => {
    const body = await readFile("/tmp/w/statue.rbn");
    const routes = { "**/statue.rbn": (route) => route.fulfill({ body, contentType: "application/octet-stream" }) };
    const { page, faults } = await loaded(context, '<rebounce-viewer src="statue.rbn" style="width:480px;height:270px"></rebounce-viewer>', { routes });
    const times = await page.evaluate(async () => {
      const frame = () => new Promise((done) => requestAnimationFrame(done));
      const sky = (degrees) => ({ type: "environment", intensity: 1, rotation_deg: degrees });
      const lamp = (x) => ({ type: "point", position: [x, 2, 1.5], intensity: 10, color: [1, 1, 1] });
      const timed = async (change) => {
        const start = performance.now();
        change();
        await frame();
        await viewer.readPixels(8, 8);
        return performance.now() - start;
      };
      const out = { sky: [], lamp: [] };
      viewer.lights = [sky(0), lamp(0)];
      await frame();
      for (let i = 0; i < 7; i += 1) {
        const a = await timed(() => (viewer.lights = [sky(31 * (i + 1)), lamp(0.1 * i)]));
        const b = await timed(() => (viewer.lights = [sky(31 * (i + 1)), lamp(0.1 * (i + 1))]));
        if (i > 0) { out.sky.push(Math.round(a)); out.lamp.push(Math.round(b)); }
      }
      out.stats = viewer.stats().milliseconds;
      return out;
    });
    console.log(JSON.stringify(times), faults.join());
    await page.close();
  });
}
