/** The light mixer's channels: strength and colour of lights, apart from the lights themselves (shared/src/mix.rs). */

import { list, member, numbers, wrong } from "./check.js";
import type { Viewer } from "../engine/module.js";
import type { Channel, Triple } from "./shot.js";

/** Mixes of viewers, as JSON; the wasm module gives none back. */
const mixes = new WeakMap<Viewer, string>();

/** A mix without what is as usual. */
const tidy = (mix: readonly Channel[]): Channel[] =>
  mix.map(({ stops, mute, solo, color }) => ({
    ...(stops && { stops }),
    ...(mute && { mute }),
    ...(solo && { solo }),
    ...(color && { color: [...color] as Triple }),
  }));

/** The mix as JSON: equal for equal mixes. */
export const mixJson = (viewer: Viewer): string => mixes.get(viewer) ?? "[]";

/** The channels, in the order of the lights; lights beyond are as they are. */
export const mixIn = (viewer: Viewer): Channel[] => JSON.parse(mixJson(viewer)) as Channel[];

/** Sets the mix. Throws `bad-json` for what is none. */
export function setMix(viewer: Viewer, mix: readonly Channel[]): void {
  const all = list("mix", mix).map((value, i) => {
    const at = `mix[${i}]`;
    const { stops = 0, mute = false, solo = false, color } = member(at, value) as Channel;
    if (typeof stops !== "number") throw wrong(`${at}.stops`, "must be a number");
    if (typeof mute !== "boolean" || typeof solo !== "boolean") throw wrong(at, "mute and solo must be true or false");
    return [stops, Number(mute), Number(solo), ...numbers(`${at}.color`, color, 3, [NaN, NaN, NaN])];
  });
  viewer.setMix(new Float64Array(all.flat()));
  mixes.set(viewer, JSON.stringify(tidy(mix)));
}

/** A scene has come, without a mix. */
export const forgetMix = (viewer: Viewer) => mixes.delete(viewer);

/** A mix in a link: a channel is its stops, `m` or `s`, and its colour: `0,-1.5m,0s*1*0.5*0`. */
export const mixText = (mix: readonly Channel[], short: (x: number) => string): string =>
  mix.map(({ stops = 0, mute, solo, color = [] }) => [short(stops) + (mute ? "m" : "") + (solo ? "s" : ""), ...color.map(short)].join("*")).join();

/** The other way. Throws `bad-json`. */
export function mixOf(text: string): Channel[] {
  const all = text.split(",").map((channel) => {
    const [, stops, mute, solo, color] = /^(-?[\d.e-]+)(m?)(s?)((?:\*[\d.e-]+){3})?$/.exec(channel) ?? [];
    if (!stops) throw wrong("mix", `the link holds “${channel}”; copy it once more`);
    return { stops: Number(stops), mute: !!mute, solo: !!solo, ...(color && { color: color.slice(1).split("*").map(Number) as Triple }) };
  });
  return tidy(all);
}
