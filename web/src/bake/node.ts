/** Modules of Node.js, which has what browsers have under other names. */

/** Whether this runs in Node.js. */
export const IS_NODE = typeof (globalThis as { process?: { versions?: { node?: string } } }).process?.versions?.node === "string";

/** Imports a module of Node.js; bundlers for browsers do not look for it. */
export async function nodeModule<T>(name: string): Promise<T> {
  return (await import(/* @vite-ignore */ /* webpackIgnore: true */ name)) as T;
}
