/** Cameras, lights and figures as the wasm module takes and gives them: lists of numbers (viewer/src/wire.rs). */

import { Failure } from "./failure.js";
import type { Viewer } from "./module.js";
import type { Camera, Light, NamedCamera, Shot, Triple } from "./shot.js";
import type { Counts, Stats } from "./stats.js";

const KINDS = ["point", "spot", "directional"] as const;
/** Numbers of a camera and of a light. */
const CAMERA = 10;
const LIGHT = 14;

function wrong(what: string, problem: string): Failure {
  return new Failure("bad-json", `${what}: ${problem}`);
}

function numbers(what: string, value: unknown, count: number, absent?: readonly number[]): readonly number[] {
  if (value === undefined && absent) return absent;
  if (Array.isArray(value) && value.length === count && value.every((x) => typeof x === "number")) return value;
  throw wrong(what, `must be a list of ${count} numbers`);
}

function number(what: string, value: unknown, absent?: number): number {
  if (value === undefined && absent !== undefined) return absent;
  if (typeof value === "number") return value;
  throw wrong(what, "must be a number");
}

function members(what: string, value: unknown): Record<string, unknown> {
  if (typeof value === "object" && value !== null) return value as Record<string, unknown>;
  throw wrong(what, "must be an object");
}

/** A camera's numbers. Throws `bad-json` for what is none. */
export function cameraNumbers(camera: Camera): Float64Array {
  const { position, target, up, yfov_deg } = members("camera", camera);
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
function lightNumbers(lights: readonly Light[]): Float64Array {
  if (!Array.isArray(lights)) throw wrong("lights", "must be a list");
  const out: number[] = [];
  for (const [i, light] of lights.entries()) {
    const at = `lights[${i}]`;
    const { type, name, position, direction, outer_cone_deg, inner_cone_deg, intensity, color, radius, radius_deg } = members(at, light);
    const kind = KINDS.indexOf(type as Light["type"]);
    if (kind < 0) throw wrong(`${at}.type`, `must be one of ${KINDS.join(", ")}`);
    if (typeof (name ?? "") !== "string") throw wrong(`${at}.name`, "must be a text");
    const none = [0, 0, 0];
    const spot = type === "spot";
    out.push(
      kind,
      ...(type === "directional" ? none : numbers(`${at}.position`, position, 3)),
      ...(type === "point" ? none : numbers(`${at}.direction`, direction, 3)),
      spot ? number(`${at}.outer_cone_deg`, outer_cone_deg) : 0,
      spot ? number(`${at}.inner_cone_deg`, inner_cone_deg ?? undefined, NaN) : 0,
      number(`${at}.intensity`, intensity),
      ...numbers(`${at}.color`, color, 3, [1, 1, 1]),
      type === "directional" ? number(`${at}.radius_deg`, radius_deg, 0) : number(`${at}.radius`, radius, 0),
    );
  }
  return new Float64Array(out);
}

/** The lights from their numbers. */
function lightsOf(numbers: Float64Array): Light[] {
  const lights: Light[] = [];
  for (let i = 0; i < numbers.length; i += LIGHT) {
    const n = [...numbers.subarray(i, i + LIGHT)] as [number, ...number[]];
    const three = (at: number) => n.slice(at, at + 3) as Triple;
    const [outer_cone_deg, inner_cone_deg, intensity] = n.slice(7) as Triple;
    const size = n[13] as number;
    const rest = { intensity, color: three(10), ...(size && { radius: size }) };
    const type = KINDS[n[0]];
    if (type === "point") lights.push({ type, position: three(1), ...rest });
    else if (type === "directional") {
      lights.push({ type, direction: three(4), intensity, color: rest.color, ...(size && { radius_deg: size }) });
    } else if (type === "spot") {
      const inner = Number.isNaN(inner_cone_deg) ? {} : { inner_cone_deg };
      lights.push({ type, position: three(1), direction: three(4), outer_cone_deg, ...inner, ...rest });
    }
  }
  return lights;
}

/** Names of the file's lights and then of its cameras; none where nothing has a name. Each ends with a zero. */
const fileNames = (viewer: Viewer): string[] => viewer.names().split("\0").slice(0, -1);

/** Names of viewers' lights, which the wasm module leaves to the page. */
const names = new WeakMap<Viewer, (string | undefined)[]>();

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
  const named = names.get(viewer) ?? [];
  return lightsOf(viewer.lights()).map((light, i) => (named[i] ? { ...light, name: named[i] } : light));
}

/** The lights have the names of the file that was loaded. */
export function nameLights(viewer: Viewer): void {
  names.set(viewer, fileNames(viewer).slice(0, viewer.lights().length / LIGHT));
}

const keepNames = (viewer: Viewer, lights: readonly Light[]) => names.set(viewer, lights.map(({ name }) => name));

/** Sets the lights. Throws `bad-json` for what are none. */
export function setLights(viewer: Viewer, lights: readonly Light[]): void {
  viewer.setLights(lightNumbers(lights));
  keepNames(viewer, lights);
}

/** Sets camera and lights, or neither. Throws `bad-json` for what are none. */
export function setShot(viewer: Viewer, shot: Shot): void {
  viewer.setShot(cameraNumbers(shot?.camera), lightNumbers(shot?.lights));
  keepNames(viewer, shot.lights);
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
  const { functions, microseconds, bytes, counts } = JSON.parse(viewer.stats()) as {
    functions: number[];
    microseconds: Record<string, number>;
    bytes: Record<string, number>;
    counts: Omit<Stats, "adapter" | "scene" | "display" | "milliseconds" | "functions" | "bytes">;
  };
  const milliseconds = Object.fromEntries(Object.entries(microseconds).map(([pass, time]) => [pass, time / 1e3]));
  const display = viewer.displayed() as Stats["display"];
  return { adapter: viewer.adapter(), scene: viewer.sceneName(), display, milliseconds, functions, bytes, ...counts };
}
