// Bounced light in scenes of three.js: at pixels, in the air, and through the life of a page.

import { cp, mkdir, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { block } from "../guide.mjs";
import { check, equal } from "../harness.mjs";
import { serveFolder } from "../serve.mjs";
import { baked, errorOf, meanOf, traced } from "../three/ball.mjs";
import { solidKtx2 } from "../three/ktx2.mjs";
import { SIZE } from "../three/picture.mjs";
import { court, glowing, room, twoRooms, VIEWS } from "../three/rooms.mjs";

/** Opens a page with `stage`; what the page's errors were. */
async function opened(browser, address) {
  const page = await browser.newPage({ viewport: { width: 400, height: 300 } });
  page.setDefaultTimeout(300_000);
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && !/404/.test(message.text()) && errors.push(message.text()));
  await page.goto(`${address}test/three/stage.html`);
  await page.waitForFunction(() => globalThis.stage, undefined, { timeout: 60_000 }).catch((error) => {
    throw new Error(`no stage: ${errors.join("; ")}`, { cause: error });
  });
  return { page, errors };
}

/** Runs the tests. */
export async function three(harness, context) {
  const server = await serveFolder(".", 0, { policy: false });
  const files = {
    room: await baked(context, "room", room),
    two: await baked(context, "two", twoRooms),
    glow: await baked(context, "glow", glowing),
    court: await baked(context, "court", court),
  };
  const inPage = (kind) => (name, work) =>
    harness[kind](`three::${name}`, async () => {
      const { page, errors } = await opened(context.browser, server.address);
      try {
        await work(page);
        equal(errors.join("\n"), "", "errors of the page");
      } finally {
        await page.close();
      }
    });
  const test = inPage("test");
  const long = inPage("long");
  try {
    await test("pixels_get_the_light_that_the_element_shows_for_three_places_of_the_lamp", async (page) => {
      const errors = await page.evaluate(async ({ glb, rbn, size }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, indirect, rms } = stage;
        const renderer = await rendererOf();
        const { model, lamps, camera } = await modelOf(glb);
        const gi = await Rebounce.load(bytesOf(rbn), { renderer, probes: false });
        const scene = new THREE.Scene();
        scene.add(model, gi.light);
        gi.lights.add(...lamps);
        await import("/dist/rebounce-viewer.js");
        const viewer = document.createElement("rebounce-viewer");
        viewer.style = "width: 160px; height: 90px; display: block";
        viewer.src = URL.createObjectURL(new Blob([bytesOf(rbn)]));
        document.body.append(viewer);
        while (!viewer.loaded) await new Promise((later) => setTimeout(later, 50));
        const out = [];
        for (const x of [0, 0.8, 1.6]) {
          lamps[0].position.x += x === 0 ? 0 : 0.8;
          gi.update();
          const found = await indirect(renderer, scene, camera, gi, ...size);
          viewer.shot = { camera: viewer.camera, lights: gi.shotLights };
          out.push(rms(found, await viewer.readIndirect(...size)));
        }
        return out;
      }, { ...files.room, size: SIZE });
      console.log(`  ${errors.map((error) => error.toFixed(4)).join(" ")}`);
      check(errors.every((error) => error < 0.02), `relative errors ${errors}`);
    });

    await test("the_shader_reads_probes_as_the_cpu_does", async (page) => {
      const { worst, largest, count } = await page.evaluate(async ({ rbn, at, glb }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, read, ballAt, irradianceAt, tsl } = stage;
        const renderer = await rendererOf();
        const gi = await Rebounce.load(bytesOf(rbn), { renderer });
        const { lamps, camera } = await modelOf(glb);
        gi.lights.add(...lamps);
        if (!(await gi.ready)) throw new Error("no probes");
        gi.update();
        const scene = new THREE.Scene();
        scene.add(ballAt(at), gi.light);
        const value = (node) => tsl.vec4(node, 1);
        const { e, p, n } = await read(renderer, scene, camera, [160, 90], { e: value(gi.irradiance), p: value(tsl.positionWorld), n: value(tsl.normalWorld) });
        const data = await gi.readProbes();
        const origin = new THREE.Vector3(...data.origin);
        let [worst, largest, count] = [0, 0, 0];
        for (let i = 0; i < e.length; i += 4) {
          const normal = new THREE.Vector3().fromArray(n, i);
          if (Math.abs(normal.length() - 1) > 1e-3) continue;
          const wanted = irradianceAt(data, new THREE.Vector3().fromArray(p, i).sub(origin), normal).toArray();
          wanted.forEach((x, c) => {
            worst = Math.max(worst, Math.abs(x - e[i + c]));
            largest = Math.max(largest, x);
          });
          count += 1;
        }
        return { worst, largest, count };
      }, { ...files.room, ...VIEWS.room });
      check(count > 500 && largest > 0.1, `${count} pixels, ${largest}`);
      check(worst < 1e-3 * largest, `off by ${worst} of ${largest}`);
    });

    await test("a_ball_that_the_bake_does_not_know_gets_the_light_of_the_room", async (page) => {
      const pixels = await page.evaluate((files) => stage.ball(files), { ...files.room, ...VIEWS.room });
      const { error, count } = errorOf(pixels, await traced(context));
      console.log(`  ${error.toFixed(4)} over ${count} pixels`);
      check(count > 500 && error < 0.1, `relative error ${error} over ${count} pixels`);
    });

    await long("a_wall_of_5_cm_keeps_light_from_what_is_behind_it", async (page) => {
      const mean = async (view) => meanOf(await page.evaluate((files) => stage.ball(files), { ...files.two, ...view }));
      const [dark, lit] = [await mean(VIEWS.dark), await mean(VIEWS.lit)];
      console.log(`  ${(dark / lit).toExponential(1)}`);
      check(lit > 0.1, `the lit side: ${lit}`);
      check(dark < 0.005 * lit, `${dark} behind the wall, ${lit} before it`);
    });

    await long("what_has_moved_is_said_once_and_lit_by_probes", async (page) => {
      const { warnings, before, after } = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, meanIrradiance, warnings } = stage;
        const renderer = await rendererOf();
        const { model, lamps, camera } = await modelOf(glb);
        const gi = await Rebounce.load(bytesOf(rbn), { renderer });
        await gi.ready;
        const scene = new THREE.Scene();
        scene.add(model, gi.light);
        gi.lights.add(...lamps);
        const mean = () => meanIrradiance(renderer, scene, camera, gi);
        const before = await mean();
        const block = model.getObjectByName("Block");
        block.position.x += 1;
        const after = await mean();
        block.position.x += 0.1;
        await mean();
        return { warnings: warnings.filter((text) => text.startsWith("rebounce")), before, after };
      }, files.room);
      equal(warnings.length, 1, `warnings: ${warnings.join("; ")}`);
      check(warnings[0].includes('"Block" has moved'), warnings[0]);
      check(Math.abs(after / before - 1) < 0.2, `${before} before, ${after} after`);
    });

    await test("canvases_share_a_file_and_sizes_change_and_passes_follow", async (page) => {
      const found = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, pixelsOf, tsl } = stage;
        const first = await rendererOf();
        const { model, lamps, camera } = await modelOf(glb);
        const gi = await Rebounce.load(bytesOf(rbn), { renderer: first, probes: false });
        const second = await rendererOf({ device: first.backend.device, width: 96, height: 54 });
        await second.init();
        const scene = new THREE.Scene();
        scene.add(model, gi.light);
        gi.lights.add(...lamps);
        for (const lamp of lamps) lamp.visible = true;
        const brightness = (renderer) => {
          const data = pixelsOf(renderer);
          return data.reduce((sum, x, i) => sum + (i % 4 < 3 ? x : 0), 0) / (0.75 * data.length);
        };
        const out = [];
        // Bounced light alone.
        const draw = async (renderer, render = () => renderer.render(scene, camera)) => {
          gi.update();
          lamps.forEach((lamp) => (lamp.visible = false));
          render();
          lamps.forEach((lamp) => (lamp.visible = true));
          out.push(brightness(renderer));
        };
        await draw(first);
        await draw(second);
        first.setSize(64, 36);
        await draw(first);
        first.setSize(160, 90);
        const pipeline = new THREE.RenderPipeline(first);
        pipeline.outputNode = tsl.pass(scene, camera);
        await draw(first, () => pipeline.render());
        gi.light.visible = false;
        await draw(first);
        return out;
      }, files.room);
      const [first, ...others] = found;
      const dark = others.pop();
      check(first > 20 && dark < 1, `brightness ${found}`);
      for (const one of others) check(Math.abs(one / first - 1) < 0.05, `brightness ${found}`);
    });

    await long("nothing_is_left_after_dispose_and_a_file_is_loaded_anew", async (page) => {
      const { left, again, memory } = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, ballAt } = stage;
        const renderer = await rendererOf();
        const { device } = (await renderer.init()) && renderer.backend;
        const { model, lamps, camera } = await modelOf(glb);
        const scene = new THREE.Scene();
        scene.add(model, ballAt([0.6, 1.1, -0.3]));
        renderer.render(scene, camera);
        await device.queue.onSubmittedWorkDone();
        // What is made from now on, and not destroyed.
        const alive = new Set();
        for (const name of ["createBuffer", "createTexture"]) {
          const make = device[name].bind(device);
          device[name] = (descriptor) => {
            const made = make(descriptor);
            alive.add(made);
            const destroy = made.destroy.bind(made);
            made.destroy = () => {
              alive.delete(made);
              destroy();
            };
            return made;
          };
        }
        const turn = async () => {
          const gi = await Rebounce.load(bytesOf(rbn), { renderer });
          await gi.ready;
          scene.add(gi.light);
          gi.lights.add(...lamps);
          for (let i = 0; i < 2; i += 1) {
            gi.update();
            renderer.render(scene, camera);
          }
          await device.queue.onSubmittedWorkDone();
          const memory = gi.memory();
          gi.dispose();
          renderer.render(scene, camera);
          await device.queue.onSubmittedWorkDone();
          return { memory, after: gi.memory() };
        };
        const { memory } = await turn();
        const left = alive.size;
        const bytes = [...alive].reduce((sum, one) => sum + (one.size ?? 4 * one.width * one.height), 0);
        await turn();
        return { left: { left, bytes }, again: alive.size - left, memory };
      }, files.room);
      check(memory.scene > 1e6 && memory.pixels > 1e5 && memory.probes > 1e5, JSON.stringify(memory));
      // three.js keeps some uniforms of materials that it has drawn.
      check(left.bytes < 100_000, `${left.left} objects of ${left.bytes} bytes are left`);
      equal(again, 0, "objects that each turn leaves");
    });

    await test("surfaces_that_shine_in_the_file_light_the_scene_as_strongly_as_they_are_told_to", async (page) => {
      const { lights, means } = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, meanIrradiance } = stage;
        const renderer = await rendererOf();
        const { model, camera } = await modelOf(glb);
        const gi = await Rebounce.load(bytesOf(rbn), { renderer, probes: false });
        const scene = new THREE.Scene();
        scene.add(model, gi.light);
        const mean = () => meanIrradiance(renderer, scene, camera, gi);
        const lights = structuredClone(gi.fileLights);
        const means = [await mean()];
        gi.fileLights[0].intensity *= 3;
        means.push(await mean());
        gi.fileLights.length = 0;
        means.push(await mean());
        return { lights, means };
      }, files.glow);
      equal(lights.map(({ type }) => type).join(), "emissive", "lights of the file");
      const [once, thrice, none] = means;
      check(once > 0.5 && Math.abs(thrice / once - 3) < 1e-3 && none === 0, `irradiance ${means}`);
    });

    await long("a_picture_of_three_is_the_sky_of_the_file", async (page) => {
      const { own, even, twice, half, upper, lower, back, refused } = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, meanIrradiance } = stage;
        const renderer = await rendererOf();
        const { model, camera } = await modelOf(glb);
        const gi = await Rebounce.load(bytesOf(rbn), { renderer, probes: false });
        const scene = new THREE.Scene();
        scene.add(model, gi.light);
        const mean = () => meanIrradiance(renderer, scene, camera, gi);
        const [width, height] = [32, 16];
        const picture = (radiance, { flipY = true, isHalf = false } = {}) => {
          const data = Array.from({ length: 4 * width * height }, (_, i) => radiance(Math.floor(i / (4 * width))));
          const texels = isHalf ? Uint16Array.from(data, THREE.DataUtils.toHalfFloat) : Float32Array.from(data);
          const texture = new THREE.DataTexture(texels, width, height, THREE.RGBAFormat, isHalf ? THREE.HalfFloatType : THREE.FloatType);
          texture.flipY = flipY;
          return texture;
        };
        const own = await mean();
        const of = async (...given) => {
          gi.setEnvironment(picture(...given));
          return mean();
        };
        const refused = [];
        for (const wrong of [new THREE.DataTexture(new Uint8Array(4), 1, 1), picture(() => -1)]) {
          try {
            gi.setEnvironment(wrong);
          } catch ({ code, message }) {
            refused.push(`${code}: ${message}`);
          }
        }
        return {
          own,
          even: await of(() => 1),
          twice: await of(() => 2),
          half: await of(() => 1, { isHalf: true }),
          upper: await of((row) => (row < height / 2 ? 1 : 0.1)),
          lower: await of((row) => (row < height / 2 ? 0.1 : 1), { flipY: false }),
          back: (gi.setEnvironment(), await mean()),
          refused,
        };
      }, files.court);
      const near = (a, b, what) => check(Math.abs(a / b - 1) < 5e-3, `${what}: ${a}, ${b}`);
      check(own > 0.1 && even > 0.5, `${own} of the file, ${even} of an even sky`);
      near(twice, 2 * even, "twice the radiance");
      near(half, even, "halves and floats");
      // What is seen of the sky is above; texels at the middle are shared.
      check(upper > 0.8 * even && upper <= 1.001 * even, `${upper} of the upper half, ${even} of all`);
      near(lower, upper, "rows from the top and from the bottom");
      near(back, own, "the file's own sky");
      check(refused.length === 2 && refused.every((one) => one.startsWith("bad-environment: The environment cannot be used: ")), refused.join("; "));
    });

    await test("a_file_is_replaced_while_the_scene_goes_on", async (page) => {
      const { found, same } = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, read, tsl } = stage;
        const renderer = await rendererOf();
        await renderer.init();
        const { model, lamps, camera } = await modelOf(glb);
        const scene = new THREE.Scene();
        scene.add(model);
        let gi;
        const reload = async () => {
          const next = await Rebounce.load(bytesOf(rbn), { renderer, probes: false });
          next.lights.add(...(gi ? gi.lights : lamps));
          gi?.dispose();
          gi = next;
          scene.add(gi.light);
        };
        const found = [];
        for (let i = 0; i < 3; i += 1) {
          // Pictures go on meanwhile.
          const loading = reload();
          for (let k = 0; k < 3; k += 1) {
            gi?.update();
            renderer.render(scene, camera);
            await new Promise((later) => setTimeout(later, 20));
          }
          await loading;
          gi.update();
          const { o } = await read(renderer, scene, camera, [160, 90], { o: tsl.vec4(tsl.output.rgb, 1) });
          found.push(o.reduce((sum, x) => sum + x, 0) / o.length);
        }
        return { found, same: scene.children.filter((object) => object.isRebounceLight).length };
      }, files.room);
      equal(same, 1, "lights in the scene");
      check(found.every((one) => Math.abs(one / found[0] - 1) < 1e-3), `brightness ${found}`);
    });

    await test("after_the_loss_of_a_device_the_file_is_loaded_on_another", async (page) => {
      const { reason, before, after } = await page.evaluate(async ({ glb, rbn }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, meanIrradiance } = stage;
        const { model, lamps, camera } = await modelOf(glb);
        const scene = new THREE.Scene();
        scene.add(model);
        const open = async () => {
          const renderer = await rendererOf();
          renderer.onDeviceLost = () => {};
          const gi = await Rebounce.load(bytesOf(rbn), { renderer });
          gi.lights.add(...lamps);
          scene.add(gi.light);
          return { renderer, gi, mean: await meanIrradiance(renderer, scene, camera, gi) };
        };
        const first = await open();
        const { device } = first.renderer.backend;
        device.destroy();
        const { reason } = await device.lost;
        // Frames that are on their way go on, and probes on their way come to an end.
        for (let i = 0; i < 3; i += 1) {
          lamps[0].position.x += 0.01;
          first.gi.update();
          first.renderer.render(scene, camera);
        }
        await first.gi.ready;
        lamps[0].position.x -= 0.03;
        first.gi.dispose();
        const second = await open();
        return { reason, before: first.mean, after: second.mean };
      }, files.room);
      equal(reason, "destroyed", "the device");
      check(before > 0.1 && Math.abs(after / before - 1) < 1e-3, `${before} before, ${after} after`);
    });

    await long("textures_of_ktx2_and_effects_of_three_work_on_our_device", async (page) => {
      const { colour, format, before, after } = await page.evaluate(async ({ glb, rbn, ktx2 }) => {
        const { Rebounce, THREE, rendererOf, modelOf, bytesOf, pixelsOf, tsl } = stage;
        const [{ KTX2Loader }, { bloom }, { ao }] = await Promise.all([
          import("three/addons/loaders/KTX2Loader.js"),
          import("three/addons/tsl/display/BloomNode.js"),
          import("three/addons/tsl/display/GTAONode.js"),
        ]);
        const renderer = await rendererOf();
        await renderer.init();
        const loader = new KTX2Loader().setTranscoderPath("/node_modules/three/examples/jsm/libs/basis/").detectSupport(renderer);
        const map = await loader.loadAsync(URL.createObjectURL(new Blob([bytesOf(ktx2)])));
        const { model, lamps, camera } = await modelOf(glb);
        const gi = await Rebounce.load(bytesOf(rbn), { renderer, probes: false });
        const scene = new THREE.Scene();
        const sign = new THREE.Mesh(new THREE.PlaneGeometry(100, 100), new THREE.MeshBasicMaterial({ map, side: THREE.DoubleSide }));
        sign.position.set(0, 0, -20);
        scene.add(sign, gi.light);
        renderer.render(scene, new THREE.PerspectiveCamera(50, 16 / 9, 0.1, 100));
        const colour = [...pixelsOf(renderer).slice(0, 3)];
        const { format } = map;
        loader.dispose();
        // Effects over bounced light.
        scene.remove(sign);
        scene.add(model, ...lamps);
        gi.lights.add(...lamps);
        gi.update();
        const picture = tsl.pass(scene, camera);
        const pipeline = new THREE.RenderPipeline(renderer);
        const brightness = () => {
          pipeline.needsUpdate = true;
          pipeline.render();
          return pixelsOf(renderer).reduce((sum, x, i) => sum + (i % 4 < 3 ? x : 0), 0);
        };
        pipeline.outputNode = picture;
        const before = brightness();
        const occlusion = ao(picture.getTextureNode("depth"), null, camera);
        pipeline.outputNode = picture.mul(occlusion.getTextureNode().r).add(bloom(picture, 2, 0.5, 0));
        brightness();
        return { colour, format, before, after: brightness() };
      }, { ...files.room, ktx2: solidKtx2([200, 60, 20]) });
      check([200, 60, 20].every((x, i) => Math.abs(x - colour[i]) < 8), `the colour ${colour}`);
      // RGBAFormat of three.js: not compressed.
      check(format !== 1023, "the texture is compressed on the GPU");
      check(after > 1.05 * before, `${before} without bloom, ${after} with it`);
    });

    for (const webgl of ["node", "classic"]) {
      await long(`a_renderer_on_webgl_gets_probes_${webgl}`, async (page) => {
        const { lit, dark } = await page.evaluate(async ({ glb, rbn, webgl, at }) => {
          const { Rebounce, THREE, rendererOf, modelOf, bytesOf, pixelsOf, ballAt } = stage;
          const renderer = await rendererOf({ webgl });
          const { lamps, camera } = await modelOf(glb);
          const gi = await Rebounce.load(bytesOf(rbn), { renderer });
          if (!(await gi.ready)) throw new Error("no probes");
          gi.lights.add(...lamps);
          const scene = new THREE.Scene();
          scene.add(ballAt(at), gi.light);
          const brightness = () => {
            renderer.render(scene, camera);
            return pixelsOf(renderer).reduce((most, x, i) => (i % 4 < 3 ? Math.max(most, x) : most), 0);
          };
          let lit = 0;
          // Read back: some frames later.
          for (let i = 0; i < 100 && lit < 20; i += 1) {
            gi.update();
            lit = brightness();
            await new Promise((later) => setTimeout(later, 20));
          }
          gi.light.visible = false;
          return { lit, dark: brightness() };
        }, { ...files.room, webgl, ...VIEWS.room });
        check(lit > 60 && dark < 5, `${lit} with, ${dark} without`);
      });
    }

    await test("a_foreign_device_and_a_file_that_is_none_are_refused_in_words", async (page) => {
      const found = await page.evaluate(async ({ rbn }) => {
        const { Rebounce, THREE, rendererOf, bytesOf } = stage;
        const reason = (promise) => promise.then(() => "loaded", ({ code, message }) => `${code}: ${message}`);
        const foreign = new THREE.WebGPURenderer();
        const own = await rendererOf();
        return [
          await reason(Rebounce.load(bytesOf(rbn), { renderer: foreign })),
          await reason(Rebounce.load(new Uint8Array(100), { renderer: own })),
          await reason(Rebounce.load("/none.rbn", { renderer: own })),
          await reason(Rebounce.load(bytesOf(rbn), { renderer: own, signal: AbortSignal.abort(new Error("enough")) })),
        ];
      }, files.room);
      check(found[0].startsWith("foreign-device: ") && found[0].includes("Rebounce.device()"), found[0]);
      check(found[1].startsWith("not-rbn: "), found[1]);
      check(found[2].startsWith("http: ") && found[2].includes("404"), found[2]);
      equal(found[3], "undefined: enough", "aborted");
    });

    await test("the_device_has_every_feature_that_three_asks_for", async (page) => {
      const missing = await page.evaluate(async () => {
        const { Rebounce, THREE } = stage;
        const own = await Rebounce.device();
        const renderer = new THREE.WebGPURenderer();
        await renderer.init();
        return [...renderer.backend.device.features].filter((name) => !own.features.has(name));
      });
      equal(missing.join(), "", "features");
    });

    await test("a_scene_is_baked_as_it_stands", async (page) => {
      const { share, warnings } = await page.evaluate(async ({ glb }) => {
        const { Rebounce, THREE, rendererOf, modelOf, read, tsl, warnings } = stage;
        const renderer = await rendererOf();
        const { model, lamps, camera } = await modelOf(glb);
        const scene = new THREE.Scene();
        scene.add(model);
        const gi = await Rebounce.bake(scene, { renderer, preset: "draft", functions: 3000, probes: false });
        scene.add(gi.light);
        gi.lights.add(...lamps);
        gi.update();
        const { e } = await read(renderer, scene, camera, [160, 90], { e: tsl.vec4(gi.irradiance, 1) });
        let lit = 0;
        for (let i = 0; i < e.length; i += 4) lit += e[i] > 1e-3;
        return { share: (4 * lit) / e.length, warnings };
      }, files.room);
      check(share > 0.99, `${share} of the pixels have light; ${warnings.join("; ")}`);
    });
    await guidePage(harness, context, files.room);
  } finally {
    server.end();
  }
}

/** The page of the guide, as whoever copies it has it. */
async function guidePage(harness, context, { glb, rbn }) {
  const root = path.join(context.work, "three-guide");
  const modules = path.join(root, "node_modules");
  await rm(root, { recursive: true, force: true });
  await mkdir(path.join(modules, "rebounce-viewer"), { recursive: true });
  await cp("dist", path.join(modules, "rebounce-viewer/dist"), { recursive: true });
  for (const part of ["build", "examples/jsm"]) await cp(`node_modules/three/${part}`, path.join(modules, "three", part), { recursive: true });
  await writeFile(path.join(root, "index.html"), `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">${await block("three.md", "three.html")}`);
  for (const [name, text] of [["room.glb", glb], ["room.rbn", rbn]]) await writeFile(path.join(root, name), Buffer.from(text, "base64"));
  const server = await serveFolder(root, 0, { policy: false });
  await harness.test("three::the_page_of_the_guide_is_lit", async () => {
    const page = await context.browser.newPage({ viewport: { width: 160, height: 90 } });
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    try {
      await page.goto(server.address);
      await page.waitForFunction(() => document.querySelector("canvas"), undefined, { timeout: 300_000 });
      const brightness = () =>
        page.evaluate(
          () =>
            new Promise((done) =>
              requestAnimationFrame(() => {
                const canvas = document.querySelector("canvas");
                const context = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
                context.drawImage(canvas, 0, 0);
                // The ceiling, which gets bounced light alone.
                done(context.getImageData(canvas.width / 2, 1, 1, 1).data[1]);
              }),
            ),
        );
      let found = 0;
      for (let i = 0; i < 300 && found < 10; i += 1) {
        found = await brightness();
        await new Promise((later) => setTimeout(later, 100));
      }
      check(found >= 10, `brightness ${found}; ${errors.join("; ")}`);
      equal(errors.join("\n"), "", "errors of the page");
    } finally {
      await page.close();
      server.end();
    }
  });
}
