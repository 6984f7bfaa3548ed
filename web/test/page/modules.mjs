// Modules without a browser: a server imports them; keyframes, daylight, links and steps of lights are arithmetic.

import { execFile } from "node:child_process";
import { readdir, readFile } from "node:fs/promises";
import { promisify } from "node:util";
import { check, equal, near, same } from "../harness.mjs";
import { EXR, plainExr } from "./exr-pictures.mjs";

const DIST = new URL("../../dist/", import.meta.url);
/** The modules as the build compiles them, before it bundles them. */
const MODULES = new URL("../../pkg/modules/", import.meta.url);

/** Runs the tests. */
export async function modules(harness) {
  await harness.test("modules::a_server_can_import_the_package", async () => {
    const files = (await readdir(DIST)).filter((file) => file.endsWith(".js") && file !== "page.js");
    check(files.length >= 4, `${files.length} modules`);
    // A process of its own for each: no module leaves anything behind, or needs what another left.
    for (const file of files) {
      const script = `const before = Object.getOwnPropertyNames(globalThis).join();
        await import(${JSON.stringify(new URL(file, DIST).href)});
        if (Object.getOwnPropertyNames(globalThis).join() !== before) throw new Error("a global was left behind");`;
      await promisify(execFile)(process.execPath, ["--input-type=module", "--eval", script]);
    }
  });
  await keyframes(harness, await import(new URL("animation/animation.js", MODULES)));
  await days(harness, await import(new URL("daylight.js", MODULES)), await import(new URL("animation/animation.js", MODULES)));
  await skies(harness, await import(new URL("sky.js", DIST)));
  await pictures(harness, await import(new URL("exr.js", DIST)));
  await links(harness, await import(new URL("wire/link.js", MODULES)));
  await steps(harness, await import(new URL("wire/lights.js", MODULES)));
  await units(harness, await import(new URL("panel/photometry.js", MODULES)));
}

/** The code that something throws. */
function code(work) {
  try {
    work();
  } catch (error) {
    return error.code;
  }
  return "nothing thrown";
}

async function keyframes(harness, { agrees, checkedAnimations, lightsAt, shifted, valueAt }) {
  const track = { light: 0, property: "position", times: [1, 2, 4], values: [0, 0, 0, 2, 4, 6, 2, 4, 0] };
  const animation = { name: "a", duration: 4, tracks: [track] };

  await harness.test("modules::keys_are_met_and_between_them_values_lie_on_the_line", () => {
    same(valueAt(track, 0), [0, 0, 0], "before the first key");
    same(valueAt(track, 1), [0, 0, 0], "at the first");
    same(valueAt(track, 1.5), [1, 2, 3], "halfway to the second");
    same(valueAt(track, 2), [2, 4, 6], "at the second");
    same(valueAt(track, 3), [2, 4, 3], "halfway to the third");
    same(valueAt(track, 9), [2, 4, 0], "after the last");
    const step = { ...track, interpolation: "step" };
    same(valueAt(step, 1.999), [0, 0, 0], "a step, before the key");
    same(valueAt(step, 2), [2, 4, 6], "a step, at the key");
  });

  await harness.test("modules::directions_turn_at_an_even_pace", () => {
    const turn = (values) => ({ light: 0, property: "direction", times: [0, 1], values });
    for (const share of [0.1, 0.25, 0.5, 0.9]) {
      const [x, y, z] = valueAt(turn([3, 0, 0, 0, 0.5, 0]), share);
      near(Math.atan2(y, x), (share * Math.PI) / 2, 1e-12, "the angle");
      near(Math.hypot(x, y, z), 1, 1e-12, "the length");
      // Opposite ones have no nearest way; any will do, at the same pace.
      for (const axis of [[1, 0, 0], [0, 1, 0], [0, 0, 2], [1, 1, 1]]) {
        const half = valueAt(turn([...axis, ...axis.map((v) => -v)]), share);
        const cos = half.reduce((sum, v, i) => sum + (v * axis[i]) / Math.hypot(...axis), 0);
        near(Math.acos(cos), share * Math.PI, 1e-9, `the angle from ${axis}`);
      }
    }
    same(valueAt(turn([0, -1, 0, 0, -1, 0]), 0.5).map((v) => v + 0), [0, -1, 0], "one that stays");
  });

  await harness.test("modules::only_what_a_light_has_is_animated", () => {
    const lights = [{ type: "point", position: [9, 9, 9], intensity: 5 }, { type: "directional", direction: [0, -1, 0], intensity: 1 }];
    const other = { light: 1, property: "position", times: [0], values: [1, 1, 1] };
    const none = { light: 7, property: "intensity", times: [0], values: [1] };
    const result = lightsAt(lights, { ...animation, tracks: [track, other, none] }, 1.5);
    same(result, [{ ...lights[0], position: [1, 2, 3] }, lights[1]], "the lights");
    same(lights[0].position, [9, 9, 9], "the lights given");
    check(agrees(animation, result, [{ ...result[0], intensity: 1 }]), "another intensity is not animated");
    check(!agrees(animation, result, lights), "another position is");
    check(!agrees(animation, result, []), "no light at all is");
  });

  await harness.test("modules::tracks_follow_their_lights", () => {
    const two = [{ ...animation, tracks: [track, { ...track, light: 2 }] }];
    const places = (animations) => animations[0].tracks.map(({ light }) => light);
    same(places(shifted(two, 1, 1)), [0, 3], "one added between");
    same(places(shifted(two, 0, -1)), [1], "the first removed");
    same(places(shifted(two, 1, -1)), [0, 1], "one between removed");
  });

  await harness.test("modules::animations_that_are_none_are_refused", () => {
    const wrong = (change) => code(() => checkedAnimations([{ ...animation, tracks: [{ ...track, ...change }] }]));
    const cases = [
      { light: -1 }, { light: 0.5 }, { property: "colour" }, { times: [] }, { times: [1, 2] }, { times: [2, 1, 3] },
      { times: [1, 2, NaN] }, { values: [1, 2] }, { values: "none" }, { interpolation: "cubic" },
      { property: "color", values: [0, 0, 0, 0, 0, -1, 0, 0, 0] },
    ];
    for (const change of cases) equal(wrong(change), "bad-json", JSON.stringify(change));
    for (const value of [undefined, {}, [1], [{}], [{ ...animation, duration: -1 }], [{ ...animation, tracks: 3 }]]) {
      equal(code(() => checkedAnimations(value)), "bad-json", JSON.stringify(value));
    }
    equal(wrong({ property: "constructor" }), "bad-json", "a name of every object");
    const copy = checkedAnimations([{ ...animation, tracks: [{ ...track, times: new Float32Array([1, 2, 4]) }] }]);
    same(copy[0].tracks[0].times, [1, 2, 4], "times of a typed array");
  });
}

async function days(harness, { airMass, dayCycle, illuminance, sun }, { checkedAnimations, lightsAt }) {
  // Where the light comes from: [east, up, south].
  const from = (options) => sun(options).direction.map((x) => -x);
  const height = (options) => (Math.asin(from(options)[1]) * 180) / Math.PI;

  await harness.test("modules::the_sun_stands_where_it_does", () => {
    const noon = from({ hour: 12, latitude: 50 });
    near(noon[0], 0, 1e-9, "east of the noon sun");
    check(noon[2] > 0.5 && noon[1] > 0.5, `at noon in the north it stands in the south: ${noon}`);
    check(from({ hour: 12, latitude: -50 })[2] < -0.5, "at noon in the south it stands in the north");
    check(from({ hour: 7, latitude: 50 })[0] > 0.5, "in the morning it stands in the east");
    check(from({ hour: 17, latitude: 50 })[0] < -0.5, "in the evening it stands in the west");
    // Noon heights: 90 degrees less the latitude, more or less the tilt of the axis at the solstices.
    near(height({ hour: 12, day: 81, latitude: 50 }), 40, 0.1, "at the equinox");
    near(height({ hour: 12, day: 172, latitude: 50 }), 63.44, 0.1, "in June");
    near(height({ hour: 12, day: 355, latitude: 50 }), 16.56, 0.1, "in December");
    for (const hour of [0, 3.3, 9, 18]) near(Math.hypot(...from({ hour, latitude: 33, north: 77 })), 1, 1e-12, "the length");
  });

  await harness.test("modules::north_can_lie_anywhere", () => {
    const noon = from({ hour: 12, latitude: 50, north: 90 });
    check(noon[0] < -0.5 && Math.abs(noon[2]) < 1e-9, `with north at +x south is at -x: ${noon}`);
    const morning = from({ hour: 6, day: 81, latitude: 0, north: 90 });
    check(morning[2] > 0.99, `and east at +z: ${morning}`);
  });

  await harness.test("modules::no_sun_at_night", () => {
    const midnight = sun({ hour: 0, latitude: 50 });
    equal(midnight.intensity, 0, "the intensity at midnight");
    check(midnight.direction[1] > 0, "it shines up from below the horizon");
    check(midnight.color.every(Number.isFinite), "a colour all the same");
    check(sun({ hour: 0, latitude: 80, day: 172 }).intensity > 0, "the midnight sun");
    equal(sun({ hour: 12, latitude: 80, day: 355 }).intensity, 0, "the polar night");
  });

  await harness.test("modules::days_are_as_long_as_the_latitude_has_it", () => {
    for (const [latitude, day] of [[0, 172], [30, 355], [50, 172], [-40, 172], [60, 81], [65, 20]]) {
      const tilt = ((23.44 * Math.PI) / 180) * Math.sin((2 * Math.PI * (284 + day)) / 365);
      const expected = (24 / Math.PI) * Math.acos(-Math.tan((latitude * Math.PI) / 180) * Math.tan(tilt));
      let found = 0;
      for (let minute = 0; minute < 1440; minute += 1) {
        found += sun({ hour: minute / 60, day, latitude }).direction[1] < 0 ? 1 / 60 : 0;
      }
      near(found, expected, 0.04, `hours of day ${day} at ${latitude} degrees`);
    }
  });

  await harness.test("modules::sunlight_dims_and_reddens_with_the_air", () => {
    near(airMass(90), 1, 1e-3, "the air straight up");
    near(airMass(30), 2, 0.01, "at 30 degrees, twice");
    near(airMass(0), 38, 0.5, "at the horizon");
    const overhead = illuminance(sun({ hour: 12, day: 81, latitude: 0 }));
    check(overhead > 95_000 && overhead < 115_000, `the sun overhead is ${overhead} lux`);
    let [before, blue] = [Infinity, Infinity];
    for (let hour = 12; hour <= 17.9; hour += 0.1) {
      const light = sun({ hour, day: 81, latitude: 0 });
      const lux = illuminance(light);
      check(lux < before, `${lux} lux at ${hour} after ${before}`);
      check(light.color[0] === 1 && light.color[2] < blue, `no redder at ${hour}: ${light.color}`);
      [before, blue] = [lux, light.color[2]];
    }
    near(sun({ hour: 12, latitude: 50, scale: 0.01 }).intensity * 100, sun({ hour: 12, latitude: 50 }).intensity, 1e-6, "scale");
  });

  await harness.test("modules::a_day_is_an_animation_that_follows_the_sun", () => {
    const place = { latitude: 50, day: 100, north: 20 };
    const day = dayCycle({ ...place, light: 1, duration: 48 });
    same(checkedAnimations([day])[0].tracks.map(({ property }) => property), ["direction", "intensity", "color"], "tracks");
    const lights = [{ type: "point", position: [0, 0, 0], intensity: 1, color: [1, 1, 1] }, sun({ ...place, hour: 0 })];
    for (const hour of [0, 6.1, 9.77, 12, 15.4, 20]) {
      const [lamp, found] = lightsAt(lights, day, hour * 2);
      const expected = sun({ ...place, hour });
      same(lamp, lights[0], "the lamp");
      const cos = found.direction.reduce((sum, x, i) => sum + x * expected.direction[i], 0);
      near(cos, 1, 1e-5, `the direction at ${hour}`);
      near(found.intensity, expected.intensity, 0.02 * 133_100, `the intensity at ${hour}`);
    }
    equal(dayCycle({ ...place, from: 6, to: 18, duration: 10 }).tracks[0].times.at(-1), 10, "the last key");
  });
}

async function skies(harness, { daylightSky, picture }) {
  /** Luminance of a pixel, cd/m². */
  const light = ({ width, scale, texels }, x, y) => {
    const bits = texels[y * width + x];
    const unit = 1000 * scale * 2 ** ((bits >>> 27) - 24);
    return unit * (0.2126 * (bits & 511) + 0.7152 * ((bits >> 9) & 511) + 0.0722 * ((bits >> 18) & 511));
  };
  const toward = (degrees) => {
    const [sin, cos] = [Math.sin((degrees * Math.PI) / 180), Math.cos((degrees * Math.PI) / 180)];
    return [cos, sin, 0];
  };
  await harness.test("modules::the_sky_has_the_baker's_data", async () => {
    const data = await readFile(new URL("../../../shared/src/environment/daylight/data/hosek_wilkie_rgb.bin", import.meta.url));
    const module = await readFile(new URL("sky.js", DIST), "utf8");
    check(module.includes(data.toString("base64").replace(/=+$/, "")), "the module does not hold the file");
  });
  await harness.test("modules::skies_have_the_light_of_the_authors_model", () => {
    // As shared/src/environment/daylight has them: computed in 64 bits from the authors' data and formula.
    for (const [elevation, turbidity, zenith] of [[60, 2, 3088], [30, 3, 2106], [90, 3, 11_683], [5, 6, 921]]) {
      near(light(daylightSky(toward(elevation), turbidity), 0, 0) / zenith, 1, 4e-3, `the zenith with the sun at ${elevation}`);
    }
    for (const [elevation, turbidity, lux] of [[0, 2, 2427.4], [5, 3, 6608], [30, 2, 13_031.6], [60, 3, 17_693.1]]) {
      const sky = daylightSky(toward(elevation), turbidity);
      let sum = 0;
      for (let y = 0; y < 64; y += 1) {
        const solidAngle = (2 * Math.PI * (Math.cos((Math.PI * y) / 128) - Math.cos((Math.PI * (y + 1)) / 128))) / 256;
        for (let x = 0; x < 256; x += 1) sum += light(sky, x, y) * Math.cos((Math.PI * (y + 0.5)) / 128) * solidAngle;
      }
      near(sum / lux, 1, 5e-3, `illuminance with the sun at ${elevation}`);
      // The ground reflects a fifth of it, and of the sun.
      const direct = sky.sun(0, 1);
      const sun = 1000 * direct.intensity * [0.2126, 0.7152, 0.0722].reduce((all, weight, c) => all + weight * direct.color[c], 0);
      const fallen = sum + sun * Math.sin((elevation * Math.PI) / 180);
      near((light(sky, 9, 100) * Math.PI) / (0.2 * fallen), 1, 5e-3, "the ground");
    }
  });
  await harness.test("modules::a_day_fades_into_night_without_a_jump", () => {
    let before = Infinity;
    for (let elevation = 10; elevation >= -20; elevation -= 0.25) {
      const sky = daylightSky(toward(elevation));
      const now = light(sky, 3, 5) + 1000 * sky.sun(0, 1).intensity;
      check(now <= before * 1.05 && (before === Infinity || now > 0.3 * before), `${now} after ${before} at ${elevation}`);
      before = now;
    }
    check(before > 0 && before < 1e-2, `at night ${before}`);
    equal(picture("48, 172, 0").sun(0, 1).intensity, 0, "no sun at midnight");
  });
}

async function pictures(harness, { readExr }) {
  const bytes = (base64) => new Uint8Array(Uint8Array.from(Buffer.from(base64, "base64")).buffer);
  /** Where the value of an attribute of the header begins. */
  const place = (file, name, type) => Buffer.from(file).indexOf(`${name}\0${type}\0`) + name.length + type.length + 6;
  /** A changed copy of a file. */
  const changed = (base64, change) => {
    const file = bytes(base64);
    change(file, new DataView(file.buffer));
    return file;
  };
  const refused = (file) => {
    try {
      return `read: ${readExr(file).width}`;
    } catch (error) {
      return error.message;
    }
  };

  await harness.test("modules::exr_is_read_whatever_compresses_it", () => {
    for (const [compression, base64] of Object.entries(EXR)) {
      const { width, scale, texels } = readExr(bytes(base64));
      same([width, texels.length], [32, 512], "the size");
      let worst = 0;
      for (const [i, bits] of texels.entries()) {
        const [x, y] = [i % 32, Math.floor(i / 32)];
        const expected = [2 ** (Math.floor(y / 2) - 3), x % 8 === 3 ? 1.5 : 0.5, (1 + (y % 3)) * (x < 8 ? 1 : 0.25)];
        const unit = scale * 2 ** ((bits >>> 27) - 24);
        for (const [c, value] of expected.entries()) worst = Math.max(worst, Math.abs(((bits >> (9 * c)) & 511) * unit - value) / Math.max(...expected));
      }
      // Nine bits; DWA is lossy.
      check(worst < (compression === "DWAA" ? 0.05 : 1 / 500), `${compression}: ${worst}`);
    }
  });

  await harness.test("modules::exr_that_cannot_be_used_is_refused_with_a_reason", () => {
    const { ZIP, RLE } = EXR;
    const set = (name, type, value) => (file) => (file[place(file, name, type)] = value);
    const cases = {
      "B44, and the page reads none, RLE, ZIPS, ZIP, PIZ, PXR24, DWAA, DWAB": set("compression", "compression", 6),
      "not stored from the top": set("lineOrder", "lineOrder", 1),
      "32 x 15 pixels": (file) => ["dataWindow", "displayWindow"].forEach((name) => (file[place(file, name, "box2i") + 12] = 14)),
      "0 x 16 pixels": (file, view) => ["dataWindow", "displayWindow"].forEach((name) => view.setInt32(place(file, name, "box2i") + 8, -1, true)),
      "not the whole picture": (file) => (file[place(file, "displayWindow", "box2i") + 8] = 30),
      "tiles": (file) => (file[5] |= 2),
      "several parts": (file) => (file[5] |= 16),
      "no channels R, G and B, but A, G, R": (file) => (file[place(file, "channels", "chlist")] = 65),
      "16-bit or all of 32-bit": (file) => (file[place(file, "channels", "chlist") + 2] = 0),
      "B has fewer pixels": (file) => (file[place(file, "channels", "chlist") + 10] = 2),
    };
    for (const [words, change] of Object.entries(cases)) check(refused(changed(ZIP, change)).includes(words), `${words}: ${refused(changed(ZIP, change))}`);
    // Of the uncompressed picture, pixel x = 5, y = 2 is not a number, or negative.
    const plain = plainExr(8, 4, () => 0x3c00);
    for (const [half, words] of [[0x7e00, "NaN for green"], [0x7c00, "Infinity for green"], [0xbc00, "-1 for green"]]) {
      const message = refused(plainExr(8, 4, (x, y, c) => (x === 5 && y === 2 && c === 1 ? half : 0x3c00)));
      check(message.includes("x = 5, y = 2") && message.includes(words), message);
    }
    equal(refused(plain), "read: 8", "the same without");
    for (const cut of [9, 100, 320, 400]) check(refused(bytes(ZIP).slice(0, cut)).includes("it ends within its"), refused(bytes(ZIP).slice(0, cut)));
    check(refused(bytes(RLE).slice(0, -1)).includes("ends within its pixels: download it again"), refused(bytes(RLE).slice(0, -1)));
  });

  await harness.test("modules::damaged_exr_comes_to_an_end", () => {
    let [read, told, state] = [0, 0, 1];
    const random = () => (state = (state * 48_271) % 2_147_483_647) / 2_147_483_647;
    const { warn } = console;
    console.warn = () => {};
    try {
      for (const base64 of Object.values(EXR)) {
        for (let k = 0; k < 60; k += 1) {
          const file = changed(base64, (file) => {
            for (let j = 0; j < 3; j += 1) file[Math.floor(random() * file.length)] ^= 1 << (k % 8);
          });
          if (refused(file).startsWith("read")) read += 1;
          else told += 1;
        }
      }
    } finally {
      console.warn = warn;
    }
    console.log(`    ${read} read, ${told} refused`);
    check(told > 100, `${told} of ${read + told} refused`);
  });
}

async function links(harness, { readState, stateHash }) {
  const camera = { position: [0.1234567, 2, -3e-17], target: [0, 1, 4], up: [0, 1, 0], yfov_deg: 55 };
  const lights = [
    { type: "point", position: [1, 2, 3], intensity: 20, color: [1, 0.5, 0.25] },
    { type: "spot", position: [1, 2, 3], direction: [0, -1, 0], outer_cone_deg: 40, intensity: 20, color: [1, 1, 1] },
    { type: "directional", direction: [0.3, -1, 0.2], intensity: 2 },
  ];
  await harness.test("modules::a_link_says_the_state_in_plain_words", () => {
    const hash = stateHash({ camera, lights, settings: { exposure: "1.5", mode: "" } });
    equal(
      hash,
      "camera=0.12346,2,0,0,1,4,0,1,0,55&light=point,1,2,3,20,1,0.5,0.25" +
        "&light=spot,1,2,3,0,-1,0,40,40,20,1,1,1&light=directional,0.3,-1,0.2,2,1,1,1&exposure=1.5",
      "the hash",
    );
    const state = readState(`#other=1&${hash}`);
    same(state.camera, { ...camera, position: [0.12346, 2, 0] }, "the camera");
    same(state.lights.map(({ type }) => type), ["point", "spot", "directional"], "the lights");
    same(state.lights[0], lights[0], "the first light");
    same(state.settings, { exposure: "1.5" }, "settings");
    same(readState(stateHash({ camera, lights: [], settings: {} })).lights, [], "no lights");
    equal(readState(stateHash({ camera, lights, settings: {} }, "a."), "b."), undefined, "another element's state");
    equal(readState(stateHash({ camera, lights, settings: {} }, "a."), "a.").lights.length, 3, "its own");
    equal(readState("#section-3"), undefined, "some other hash");
    const sized = [{ ...lights[0], radius: 0.1 }, { ...lights[2], color: [1, 1, 1], radius_deg: 0.27 }];
    const link = stateHash({ camera, lights: sized, settings: {} });
    if (!link.endsWith("&light=point*0.1,1,2,3,20,1,0.5,0.25&light=directional*0.27,0.3,-1,0.2,2,1,1,1")) throw new Error(link);
    same(readState(link).lights, sized, "lights with a size");
    const name = "Bed, left & 100 % of it";
    equal(readState(stateHash({ camera, lights: [{ ...lights[0], name }], settings: {} })).lights[0].name, name, "a name");
  });
  await harness.test("modules::a_damaged_link_is_refused", () => {
    for (const bad of ["camera=1,2", "camera=1,2,3,4,5,6,7,8,9,x", "light=lamp,1", "light=point,1,2,3,4,5,6", "light=", "light=constructor,1", "light=point*,1,2,3,20,1,1,1", "light=point*x,1,2,3,20,1,1,1", "camera=,,,,,,,,,"]) {
      equal(code(() => readState(bad)), "bad-json", bad);
    }
  });
}

async function steps(harness, { hexColor, linearColor, newLight, stepped }) {
  // It looks along -x, a little down: right is -z.
  const camera = { position: [10, 2, 0], target: [0, 0, 0], up: [0, 1, 0] };
  const lamp = { type: "point", position: [5, 2, 0], intensity: 3 };
  await harness.test("modules::keys_move_a_light_as_the_camera_sees_it", () => {
    const way = (key, far) => stepped(lamp, camera, key, far).position.map((x, i) => Number((x - lamp.position[i]).toFixed(9)) + 0);
    same(way("ArrowRight", false), [0, 0, -0.1], "right");
    same(way("ArrowLeft", false), [0, 0, 0.1], "left");
    same(way("ArrowUp", false), [-0.1, 0, 0], "away");
    same(way("ArrowDown", false), [0.1, 0, 0], "nearer");
    same(way("PageUp", false), [0, 0.1, 0], "up");
    same(way("PageDown", true), [0, -0.5, 0], "down, far");
    equal(stepped(lamp, camera, "Enter", false), undefined, "another key");
    const down = { position: [0, 5, 0], target: [0, 0, 0], up: [0, 0, -1] };
    check(stepped(lamp, down, "ArrowUp", false).position[2] < 0, "from straight above, what is up in the picture is ahead");
    const turned = stepped({ type: "directional", direction: [0, -2, 0], intensity: 1 }, camera, "ArrowRight", false).direction;
    check(turned[2] > 0 && turned[1] < 0, `it comes from further right: ${turned}`);
    near(Math.hypot(...turned), 1, 1e-12, "its length");
  });
  await harness.test("modules::new_lights_lie_in_view", () => {
    for (const type of ["point", "spot", "directional"]) {
      const light = newLight(type, camera, [], () => [0, -3, 0]);
      equal(light.type, type, "the kind");
      check(light.intensity > 0, "no light");
      if (light.position) same(light.position.map((x) => Math.round(x * 1e6) / 1e6), [3, 0.6, 0], "the place");
      else same(light.direction.map((x) => x + 0), [0, -1, 0], "the direction");
    }
  });
  await harness.test("modules::new_lights_lie_beside_each_other", () => {
    const lights = [];
    for (let i = 0; i < 16; i += 1) lights.push(newLight(["point", "spot", "directional"][i % 3], camera, lights, () => [0.5, -1, 0.2]));
    // Unit vectors from the eye, or to the sun.
    const seen = ({ position, direction }) => {
      const way = position ? position.map((x, i) => x - camera.position[i]) : direction;
      return way.map((x) => x / Math.hypot(...way));
    };
    lights.forEach((a, i) =>
      lights.slice(i + 1).forEach((b) => {
        const apart = Math.hypot(...seen(a).map((x, k) => x - seen(b)[k]));
        if (!a.position === !b.position) check(apart > (a.position ? 0.08 : 0.2), `${i}: only ${apart} apart`);
      }),
    );
  });
  await harness.test("modules::colours_come_back", () => {
    for (const hex of ["#000000", "#ffffff", "#0a80c8", "#ff0105"]) equal(hexColor(linearColor(hex)), hex, "the colour");
    equal(hexColor([2, 1, 0]), hexColor([1, 0.5, 0]), "brighter than white");
  });
}

async function units(harness, { colorKelvin, compass, KELVIN, kelvinColor, perIntensity, sunAngles, sunDirection }) {
  await harness.test("modules::lumens_are_the_integral_of_candela_over_all_ways", () => {
    near(perIntensity({ type: "point" }, "lumen"), 4 * Math.PI, 1e-12, "of a point");
    for (const [outer, inner] of [[40, 30], [90, 0], [25, undefined], [30, 30], [20, 50]]) {
      const cos = (degrees) => Math.cos((degrees * Math.PI) / 180);
      const [a, b] = [cos(outer), cos(Math.min(inner ?? outer, outer))];
      // KHR_lights_punctual's falloff, summed over rings.
      let sum = 0;
      for (let i = 0; i < 20_000; i += 1) {
        const angle = ((i + 0.5) / 20_000) * (Math.PI / 2);
        const share = Math.min(Math.max((Math.cos(angle) - a) / Math.max(b - a, 1e-9), 0), 1);
        sum += share ** 2 * 2 * Math.PI * Math.sin(angle) * (Math.PI / 40_000);
      }
      near(perIntensity({ type: "spot", outer_cone_deg: outer, inner_cone_deg: inner }, "lumen") / sum, 1, 2e-3, `of a spot of ${outer} and ${inner}`);
    }
    for (const unit of ["candela", "lux"]) equal(perIntensity({ type: "spot", outer_cone_deg: 40 }, unit), 1, unit);
  });
  await harness.test("modules::colour_temperatures_are_those_of_black_bodies", () => {
    for (let kelvin = KELVIN.min; kelvin <= KELVIN.max; kelvin += KELVIN.step) {
      const color = kelvinColor(kelvin);
      equal(Math.max(...color), 1, `the largest part at ${kelvin} K`);
      check(Math.min(...color) >= 0, `no part is negative at ${kelvin} K: ${color}`);
      equal(colorKelvin(color), kelvin, "the temperature of the colour");
      equal(colorKelvin(color.map((x) => 0.2 * x)), kelvin, "of the same, darker");
    }
    // Chromaticities of Planck's law (CIE 1931): incandescent light A, and 6,500 K.
    const chromaticity = (kelvin) => {
      const [r, g, b] = kelvinColor(kelvin);
      const [x, y, z] = [
        0.4124564 * r + 0.3575761 * g + 0.1804375 * b,
        0.2126729 * r + 0.7151522 * g + 0.072175 * b,
        0.0193339 * r + 0.119192 * g + 0.9503041 * b,
      ];
      return [x / (x + y + z), y / (x + y + z)];
    };
    for (const [kelvin, x, y] of [[2856, 0.4476, 0.4074], [6500, 0.3135, 0.3237], [10_000, 0.2807, 0.2884]]) {
      const found = chromaticity(kelvin);
      near(found[0], x, 2e-3, `x at ${kelvin} K`);
      near(found[1], y, 2e-3, `y at ${kelvin} K`);
    }
    near(colorKelvin([1, 1, 1]), 6500, 500, "white");
    for (const color of [[0, 1, 0], [1, 0, 1], [0, 0, 1]]) equal(colorKelvin(color), undefined, `${color}`);
  });
  await harness.test("modules::a_sun_stands_where_its_angles_say", () => {
    const close = (a, b) => a.forEach((x, i) => near(x, b[i], 1e-9, `${a}, ${b}`));
    // From the north it shines to +z, from the east to -x.
    close(sunDirection(0, 0), [0, 0, 1]);
    close(sunDirection(90, 0), [-1, 0, 0]);
    close(sunDirection(180, 45), [0, -Math.SQRT1_2, -Math.SQRT1_2]);
    for (const [azimuth, elevation] of [[0, 0], [12, 80], [200.5, -30], [359, 45]]) close(sunAngles(sunDirection(azimuth, elevation)), [azimuth, elevation]);
    near(sunAngles([0, -3, 0])[1], 90, 1e-9, "overhead");
    same([0, 44, 90, 225, 359].map(compass), ["N", "NE", "E", "SW", "N"], "the compass");
  });
}
