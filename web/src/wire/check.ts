/** Checks of values that come from anywhere: they throw a `Failure` with the code `bad-json` and what is wrong. */

import { Failure } from "./failure.js";

export function wrong(what: string, problem: string): Failure {
  return new Failure("bad-json", `${what}: ${problem}`);
}

export function numbers(what: string, value: unknown, count: number, absent?: readonly number[]): readonly number[] {
  if (value === undefined && absent) return absent;
  if (Array.isArray(value) && value.length === count && value.every((x) => typeof x === "number")) return value;
  throw wrong(what, `must be a list of ${count} numbers`);
}

export function number(what: string, value: unknown, absent?: number): number {
  if (value === undefined && absent !== undefined) return absent;
  if (typeof value === "number") return value;
  throw wrong(what, "must be a number");
}

export function member(what: string, value: unknown): Record<string, unknown> {
  if (typeof value === "object" && value !== null) return value as Record<string, unknown>;
  throw wrong(what, "must be an object");
}

export function list<T>(what: string, value: readonly T[]): readonly T[] {
  if (Array.isArray(value)) return value;
  throw wrong(what, "must be a list");
}
