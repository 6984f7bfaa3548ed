// The code of the guides: what stands in a page of docs/guide is what the tests run.

import { readFile } from "node:fs/promises";

const GUIDE = new URL("../../docs/guide/", import.meta.url);

/** Returns the blocks of code of a page: their language, the name of their file if they have one, their text. */
export async function blocks(page) {
  const text = await readFile(new URL(page, GUIDE), "utf8");
  return [...text.matchAll(/^```(\w+)(?: (\S+))?\n(.*?)^```$/gms)].map(([, language, file, code]) => ({ language, file, code }));
}

/** Returns the text of the block that is this file. */
export async function block(page, file) {
  const found = (await blocks(page)).find((one) => one.file === file);
  if (!found) throw new Error(`docs/guide/${page} has no ${file}`);
  return found.code;
}
