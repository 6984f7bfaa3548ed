/**
 * Camera, lights and settings as the hash of a link, to be read by people too:
 * `#camera=0,1,4,0,1,0,0,1,0,60&light=point,1,2,0,20,1,1,1,Name&exposure=1`. A light's radius, where it has one, is
 * beside its kind: `light=point*0.1,…`. A node that has moved: `node=` translation, rotation, name.
 */

import { wrong } from "./check.js";
import { type Field, KINDS, SIZE } from "./light-kinds.js";
import { mixOf, mixText } from "./mix.js";
import type { Camera, Channel, Light, NodeMove, Quaternion, Triple } from "./shot.js";

/** What a link says. */
export interface LinkState {
  camera?: Camera;
  lights?: Light[];
  mix?: Channel[];
  /** Nodes that are elsewhere than the file has them, each with `translation` and `rotation`. */
  move: Record<string, NodeMove>;
  /** Attributes of the element, by name; empty for their default. */
  settings: Record<string, string>;
}

/** Attributes that go into a link. */
export const LINK_SETTINGS = ["exposure", "auto-exposure", "tone-mapping", "mode"] as const;

/**
 * The size of a kind of light, which stands beside it in a link, and the fields that follow; a name may come last. A link
 * holds no other text.
 */
function form(type: Light["type"]): { size: Field | undefined; fields: Field[] } {
  const { fields } = KINDS[type];
  return { size: fields.find(isSize), fields: fields.filter((field) => !isSize(field) && field.width > 0) };
}

const isSize = ({ at }: Field) => at === SIZE;

/** Five digits are enough for what is seen. */
const short = (x: number) => String(Math.abs(x) < 1e-9 ? 0 : Number(x.toPrecision(5)));

/** The hash, without `#`. `prefix` stands before each name, for pages of several elements. */
export function stateHash({ camera, lights = [], mix = [], move = {}, settings }: Partial<LinkState> & Pick<LinkState, "settings">, prefix = ""): string {
  const parts: string[] = [];
  if (camera) {
    const { position, target, up = [0, 1, 0], yfov_deg = 60 } = camera;
    parts.push(`camera=${[...position, ...target, ...up, yfov_deg].map(short)}`);
  }
  for (const light of lights) {
    const member = (name: string) => (light as unknown as Record<string, number | number[]>)[name];
    const { size: sized, fields } = form(light.type);
    // A hard edge is a full cone as wide as the whole.
    const instead = ({ absent = 0 }: Field) => (Number.isNaN(absent) ? (member("outer_cone_deg") ?? 0) : absent);
    const numbers = fields.flatMap((field) => member(field.name) ?? instead(field));
    const name = light.name ? [encodeURIComponent(light.name)] : [];
    const size = sized && member(sized.name);
    const type = size ? `${light.type}*${short(size as number)}` : light.type;
    parts.push(`light=${[type, ...numbers.map(short), ...name]}`);
  }
  if (camera && lights.length === 0) parts.push("light=none");
  for (const [name, { translation = [], rotation = [] }] of Object.entries(move)) {
    parts.push(`node=${[...translation, ...rotation].map(short)},${encodeURIComponent(name)}`);
  }
  if (mix.length) parts.push(`mix=${mixText(mix, short)}`);
  for (const [name, value] of Object.entries(settings)) {
    if (value) parts.push(`${name}=${encodeURIComponent(value)}`);
  }
  return parts.map((part) => encodeURIComponent(prefix) + part).join("&");
}

/**
 * Reads a hash, with or without `#`; nothing where it holds no camera and no light under this prefix.
 * Throws `bad-json` where it is damaged.
 */
export function readState(hash: string, prefix = ""): LinkState | undefined {
  const state: LinkState = { move: {}, settings: {} };
  for (const [key, value] of new URLSearchParams(hash.replace(/^#/, ""))) {
    if (!key.startsWith(prefix)) continue;
    const name = key.slice(prefix.length);
    if (name === "camera") {
      const n = numbers(value.split(","), 10, name);
      state.camera = { position: triple(n, 0), target: triple(n, 3), up: triple(n, 6), yfov_deg: n[9] as number };
    } else if (name === "light") {
      state.lights ??= [];
      if (value !== "none") state.lights.push(light(value));
    } else if (name === "node") {
      const texts = value.split(",");
      const n = numbers(texts.splice(0, 7), 7, name);
      state.move[texts.join()] = { translation: triple(n, 0), rotation: n.slice(3) as Quaternion };
    } else if (name === "mix") state.mix = mixOf(value);
    else if ((LINK_SETTINGS as readonly string[]).includes(name)) state.settings[name] = value;
  }
  return state.camera || state.lights ? state : undefined;
}

function light(value: string): Light {
  const [kind = "", ...texts] = value.split(",");
  const [type = "", size] = kind.split("*");
  if (!Object.hasOwn(KINDS, type)) throw wrong("light", `the link holds “${type}”; copy it once more`);
  const { size: sized, fields } = form(type as Light["type"]);
  const count = fields.reduce((sum, { width }) => sum + width, 0);
  const n = numbers(texts.slice(0, count), count, "light");
  const name = texts.slice(count).join();
  const result: Record<string, unknown> = { type, ...(name && { name }) };
  let at = 0;
  for (const { name, width } of fields) {
    result[name] = width === 1 ? n[at] : triple(n, at);
    at += width;
  }
  if (size !== undefined && sized) result[sized.name] = numbers([size], 1, "light")[0];
  return result as unknown as Light;
}

const triple = (n: number[], at: number) => n.slice(at, at + 3) as Triple;

function numbers(texts: string[], count: number, what: string): number[] {
  const found = texts.map((text) => (text.trim() ? Number(text) : NaN));
  if (found.length !== count || !found.every(Number.isFinite)) {
    throw wrong(what, "the link is damaged; copy it once more");
  }
  return found;
}
