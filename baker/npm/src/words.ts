/** The options of a call as the words of a command line. */

import { OPTIONS, type CommandOptions } from "./options.js";

/** Returns the words. Throws a `TypeError` for an option that does not exist. */
export function words(options: CommandOptions): string[] {
  const all: string[] = [];
  for (const [key, value] of Object.entries(options) as [string, unknown][]) {
    const option = Object.hasOwn(OPTIONS, key) ? OPTIONS[key] : undefined;
    if (!option) throw new TypeError(`bake: there is no option ${JSON.stringify(key)}`);
    if (value === undefined) continue;
    if (!option.hasValue) {
      if (typeof value !== "boolean") throw new TypeError(`bake: ${key} is true or false, not ${JSON.stringify(value)}`);
      if (value) all.push(`--${option.name}`);
      continue;
    }
    if (option.isRepeated && !Array.isArray(value)) throw new TypeError(`bake: ${key} is an array, not ${JSON.stringify(value)}`);
    for (const one of option.isRepeated ? (value as unknown[]) : [value]) all.push(`--${option.name}=${text(key, one)}`);
  }
  return all;
}

function text(key: string, value: unknown): string {
  if (typeof value === "string") return value;
  if (typeof value === "number" && Number.isFinite(value)) return String(value);
  if (Array.isArray(value) && value.every((one) => typeof one === "number" && Number.isFinite(one))) return value.join(",");
  throw new TypeError(`bake: ${key} cannot be ${JSON.stringify(value) ?? String(value)}`);
}
