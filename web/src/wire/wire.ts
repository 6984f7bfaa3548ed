/** Cameras, lights and figures as the wasm module takes and gives them: lists of numbers (viewer/src/wasm/wire.rs). */

import { list, member, number, numbers, wrong } from "./check.js";
import { KINDS, LIGHT } from "./light-kinds.js";
import type { Viewer } from "../engine/module.js";
import { forgetMix, mixIn, setMix } from "./mix.js";
import type { Camera, Light, NamedCamera, Shot, Triple } from "./shot.js";
import type { AntiradianceStats, Counts, Stats } from "./stats.js";

/** Kinds of light by their numbers. */
const TYPES = Object.keys(KINDS) as Light["type"][];
/** Numbers of a camera. */
const CAMERA = 10;

/** A camera's numbers. Throws `bad-json` for what is none. */
export function cameraNumbers(camera: Camera): Float64Array {
  const { position, target, up, yfov_deg } = member("camera", camera);
  return new Float64Array([
    ...numbers("camera.position", position, 3),
    ...numbers("camera.target", target, 3),
    ...numbers("camera.up", up, 3, [0, 1, 0]),
    number("camera.yfov_deg", yfov_deg, 60),
  ]);
}

/** A camera from its numbers, which begin at a place. */
function cameraOf(numbers: Float64Array, at = 0): Camera {
  const three = (from: number) => [...numbers.subarray(at + from, at + from + 3)] as Triple;
  return { position: three(0), target: three(3), up: three(6), yfov_deg: numbers[at + 9] ?? 60 };
}

/** The lights' numbers. Throws `bad-json` for what are none. */
export function lightNumbers(lights: readonly Light[]): Float64Array {
  list("lights", lights);
  const out = new Float64Array(LIGHT * lights.length);
  for (const [i, light] of lights.entries()) {
    const at = `lights[${i}]`;
    const own = member(at, light);
    const kind = TYPES.indexOf(own.type as Light["type"]);
    if (kind < 0) throw wrong(`${at}.type`, `must be one of ${TYPES.join(", ")}`);
    if (typeof (own.name ?? "") !== "string") throw wrong(`${at}.name`, "must be a text");
    const list = out.subarray(LIGHT * i);
    list[0] = kind;
    for (const { name, at: first, width, absent } of KINDS[TYPES[kind] as Light["type"]].fields) {
      const what = `${at}.${name}`;
      if (width === 0) {
        if (typeof (own[name] ?? "") !== "string") throw wrong(what, "must be a text");
        continue;
      }
      // What a light may be without may be null.
      const value = Number.isNaN(absent) ? (own[name] ?? undefined) : own[name];
      list.set(width === 3 ? numbers(what, value, 3, absent as Triple) : [number(what, value, absent as number)], first);
    }
  }
  return out;
}

/** The lights from their numbers. */
export function lightsOf(numbers: Float64Array): Light[] {
  return Array.from({ length: numbers.length / LIGHT }, (_, i) => {
    const list = numbers.subarray(LIGHT * i);
    const type = TYPES[list[0] as number] as Light["type"];
    const light: Record<string, unknown> = { type };
    for (const { name, at, width, absent } of KINDS[type].fields) {
      if (width === 0) continue;
      const value = width === 3 ? [...list.subarray(at, at + 3)] : list[at];
      if (name === "intensity" || (value !== absent && !Number.isNaN(value))) light[name] = value;
    }
    return light as unknown as Light;
  });
}

/** Names of the file's lights and then of its cameras; none where nothing has a name. Each ends with a zero. */
export const fileNames = (viewer: Pick<Viewer, "names">): string[] => viewer.names().split("\0").slice(0, -1);

/** Texts of a light: its name, and fields that are no numbers. */
type Texts = Record<string, string>;

/** Texts of viewers' lights, which the wasm module leaves to the page. */
const texts = new WeakMap<Viewer, Texts[]>();

/** Names of the groups of shining surfaces of viewers' files. */
const groups = new WeakMap<Viewer, string[]>();

/** The file's cameras. */
export function camerasIn(viewer: Viewer): NamedCamera[] {
  const numbers = viewer.cameras();
  const length = numbers.length / CAMERA;
  const named = fileNames(viewer).slice(-length);
  return Array.from({ length }, (_, i) => ({ name: named[i] || `Camera ${i + 1}`, camera: cameraOf(numbers, CAMERA * i) }));
}

/** The present camera and lights. */
export const cameraIn = (viewer: Viewer): Camera => cameraOf(viewer.camera());
export function lightsIn(viewer: Viewer): Light[] {
  const kept = texts.get(viewer) ?? [];
  return lightsOf(viewer.lights()).map((light, i) => ({ ...light, ...kept[i] }));
}

/** A file was loaded: its lights have its names, and no mix. */
export function begin(viewer: Viewer): void {
  const lights = lightsOf(viewer.lights());
  const names = fileNames(viewer).slice(0, lights.length);
  texts.set(viewer, names.map((name) => (name ? { name } : {}) as Texts));
  groups.set(viewer, lights.flatMap(({ type }, i) => (type === "emissive" ? [names[i] ?? ""] : [])));
  forgetMix(viewer);
}

/** Lights whose groups of shining surfaces are found by name; one without a name, or with another, keeps its number. */
function found(viewer: Viewer, lights: readonly Light[]): Light[] {
  const group = ({ name }: Light) => (name ? (groups.get(viewer)?.indexOf(name) ?? -1) : -1);
  return list("lights", lights).map((light) => (light?.type === "emissive" && group(light) >= 0 ? { ...light, group: group(light) } : light));
}

/** A shot's lights, and those of surfaces that it does not name: they shine as the scene says. */
function completed(viewer: Viewer, { lights, emission = 1 }: Shot): Light[] {
  const named = found(viewer, lights ?? []).map((light) => (light?.type === "emissive" ? { ...light, intensity: (light.intensity ?? 1) * emission } : light));
  const has = (group: number) => named.some((light) => light?.type === "emissive" && (light.group ?? 0) === group);
  const others = (groups.get(viewer) ?? []).flatMap((name, group): Light[] => (has(group) ? [] : [{ type: "emissive", group, intensity: emission, ...(name && { name }) }]));
  return [...named, ...others];
}

/** The texts of a light that are there. */
function textsOf(light: Light): Texts {
  const fields = KINDS[light.type].fields.filter(({ width }) => width === 0);
  const named = ["name", ...fields.map(({ name }) => name)];
  const own = light as unknown as Texts;
  return Object.fromEntries(named.flatMap((name) => (own[name] ? [[name, own[name]]] : [])));
}

const keepTexts = (viewer: Viewer, lights: readonly Light[]) => texts.set(viewer, lights.map(textsOf));

/** Sets the lights; channels of the mixer without a light go. Throws `bad-json` for what are none. */
export function setLights(viewer: Viewer, lights: readonly Light[]): void {
  const all = found(viewer, lights);
  viewer.setLights(lightNumbers(all));
  keepTexts(viewer, all);
  const mix = mixIn(viewer);
  if (mix.length > all.length) setMix(viewer, mix.slice(0, all.length));
}

/** The present shot, without a size. */
export function shotIn(viewer: Viewer): Shot {
  const mix = mixIn(viewer);
  return { camera: cameraIn(viewer), lights: lightsIn(viewer), ...(mix.length && { mix }), ...viewer.moving?.shot, ...(viewer.gloss && { gloss: true }) };
}

/** Sets camera, lights and mix, or none. Throws `bad-json` for what are none. */
export function setShot(viewer: Viewer, shot: Shot): void {
  const { emission = 1, mix = [], gloss = false } = member("shot", shot) as unknown as Shot;
  if (!(number("emission", emission) >= 0)) throw wrong("emission", "must be a factor, 0 or more");
  const { moving } = viewer;
  // Nothing of this file moves or deforms.
  if (!moving && (shot.move || shot.animation || shot.time)) throw wrong("move", "must be absent");
  moving?.check(shot);
  const before = mixIn(viewer);
  const lights = completed(viewer, shot);
  setMix(viewer, mix);
  try {
    viewer.setShot(cameraNumbers(shot.camera), lightNumbers(lights));
  } catch (error) {
    setMix(viewer, before);
    throw error;
  }
  moving?.move(shot);
  viewer.gloss = gloss;
  keepTexts(viewer, lights);
}

/** What the GPU counted for the present picture. */
export async function countsIn(viewer: Viewer): Promise<Counts> {
  const [pixels = 0, rows = 0, lookedAt = 0, evaluated = 0] = await viewer.counts();
  const perPixel = (count: number) => count / Math.max(pixels, 1);
  return {
    pixels,
    pixelsLookedUp: rows,
    functionsLookedAtPerPixel: perPixel(lookedAt),
    kernelEvaluationsPerPixel: perPixel(evaluated),
  };
}

/** The viewer's figures. */
export function statsIn(viewer: Viewer): Stats {
  const { microseconds, counts, ...more } = JSON.parse(viewer.stats()) as {
    functions: number[];
    microseconds: Record<string, number>;
    bytes: Record<string, number>;
    antiradiance?: AntiradianceStats;
    counts: Omit<Stats, "solver" | "solving" | "adapter" | "scene" | "display" | "milliseconds" | "functions" | "bytes" | "antiradiance">;
  };
  const milliseconds = Object.fromEntries(Object.entries(microseconds).map(([pass, time]) => [pass, time / 1e3]));
  const display = viewer.displayed() as Stats["display"];
  const { solver = "operator", solving = false } = viewer as unknown as Partial<Pick<Stats, "solver" | "solving">>;
  return { solver, solving, adapter: viewer.adapter(), scene: viewer.sceneName(), display, milliseconds, ...more, ...counts };
}
