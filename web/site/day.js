// The light of an hour in the apartment: the sun or the moon, and the sky, which move together.
//
// The sky is the file's own picture, turned with the sun, and as bright and coloured as a clear sky is at the sun's
// elevation. An element that computes the sky itself would take `PLACE` and the hour instead.

import { sun } from "./rebounce-viewer/daylight.js";

/** Where the apartment stands, and what of the lux outside counts beside its lamps. */
const PLACE = { latitude: 46, day: 100, scale: 4e-4 };
/** The file's sky: the way the light of its sun travels, and its factor. */
const SKY = { direction: [0.52, -0.62, -0.59], intensity: 0.4 };
/**
 * Illuminance of a clear sky in red, green and blue, over that of the file's sky, by the sun's elevation in degrees:
 * Hosek and Wilkie 2012, turbidity 3, as `rebounce bake --sky` has it; below the horizon as twilight fades.
 */
const CLEAR_SKY = [
  [-6, 0.001, 0.0006, 0.0003],
  [-4, 0.009, 0.006, 0.003],
  [-2, 0.058, 0.035, 0.017],
  [0, 0.236, 0.142, 0.07],
  [5, 0.506, 0.412, 0.282],
  [10, 0.642, 0.581, 0.455],
  [20, 0.816, 0.794, 0.704],
  [30, 0.936, 0.929, 0.884],
  [40, 1.009, 1.011, 1.021],
  [50, 1.043, 1.059, 1.117],
  [60, 1.063, 1.091, 1.172],
  [70, 1.098, 1.122, 1.196],
  [90, 1.26, 1.199, 1.182],
];
/** Moonlight, and what the night's sky has at least: they keep the night from being black. */
const MOON = { direction: [0.35, -0.75, -0.55], intensity: 0.12, color: [0.6, 0.72, 1] };
const NIGHT = [0.005, 0.008, 0.013];
/** Height of the sun below which lamps are wanted, as the sine of its elevation. */
const DUSK = 0.1;

const degrees = (radians) => (radians * 180) / Math.PI;
/** Azimuth that a direction of light comes from, degrees from +x towards +z. */
const azimuth = ([x, , z]) => degrees(Math.atan2(-z, -x));

/** Red, green and blue of the sky over the file's, at an elevation of the sun in degrees. */
function skyAt(elevation) {
  const after = Math.max(1, CLEAR_SKY.findIndex(([to]) => to >= elevation));
  const [low, high] = [CLEAR_SKY[after - 1], CLEAR_SKY[after]];
  const share = Math.min(Math.max((elevation - low[0]) / (high[0] - low[0]), 0), 1);
  return NIGHT.map((least, i) => Math.max(least, low[i + 1] + share * (high[i + 1] - low[i + 1])));
}

/** The light of an hour: `lights`, which replaces the sun and the sky of a list of lights, and `isDark`. */
export function daylight(hour) {
  const day = sun({ ...PLACE, hour });
  const height = Math.min(Math.max(-day.direction[1], -1), 1);
  const tint = skyAt(degrees(Math.asin(height)));
  const most = Math.max(...tint);
  const lit = {
    directional: day.intensity > 0 ? day : MOON,
    environment: {
      rotation_deg: azimuth(SKY.direction) - azimuth(day.direction),
      intensity: SKY.intensity * most,
      color: tint.map((x) => x / most),
    },
  };
  // The first of each kind: a further sun of the visitor's own stays.
  const first = (list, type) => list.findIndex((light) => light.type === type);
  const lights = (list) =>
    list.map((light, i) => (i === first(list, light.type) ? { ...light, ...lit[light.type] } : light));
  return { lights, isDark: height < DUSK };
}

/** Hours and minutes. */
function clock(hour) {
  const minutes = Math.round(hour * 60) % (24 * 60);
  return [Math.floor(minutes / 60), minutes % 60].map((part) => String(part).padStart(2, "0")).join(":");
}

/** Says the hour of a slider, beside it and to those who hear the page. */
export function show(slider, output) {
  output.value = clock(slider.valueAsNumber);
  slider.setAttribute("aria-valuetext", output.value);
}

/** Makes a slider of hours move by quarters of an hour with arrow keys, and as finely as one likes with a pointer. */
export function steppedByKeys(slider) {
  slider.step = "any";
  // With step "any" the arrow keys would move by a hundredth of the day.
  slider.addEventListener("keydown", (event) => {
    const steps = { ArrowRight: 0.25, ArrowUp: 0.25, ArrowLeft: -0.25, ArrowDown: -0.25, PageUp: 2, PageDown: -2 };
    const step = steps[event.key];
    if (step === undefined) return;
    event.preventDefault();
    slider.valueAsNumber = Math.min(Math.max(slider.valueAsNumber + step, slider.min), slider.max);
    slider.dispatchEvent(new Event("input"));
  });
}
