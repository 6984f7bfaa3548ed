// node generate.mjs PKG OUT: writes the options of `rebounce bake` as a module: the table of the WebAssembly, which is the one that
// the help comes from, and a type of it.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";

/** Options that are the function's own affair: where files go, and what is told. */
const NOT_OF_A_CALL = ["output", "preview", "resume", "json-progress", "report"];
/** Values that are words of any kind. */
const WORDS = ["N|NAME", "NODE"];
/** Columns of a comment. */
const WIDTH = 116;

const [pkg, out] = process.argv.slice(2);
if (!out) throw new Error("usage: node generate.mjs PKG OUT");
const { default: init, optionsTable } = await import(pathToFileURL(path.resolve(pkg, "rebounce_baker.js")).href);
await init(await WebAssembly.compile(await readFile(path.join(pkg, "rebounce_baker_bg.wasm"))));
const table = JSON.parse(optionsTable()).filter(({ name }) => !NOT_OF_A_CALL.includes(name));

/** The type of an option's value. */
function type({ value, choices, is_path, is_repeated, separator }) {
  if (!value) return "boolean";
  if (choices.length > 0) return choices.map((choice) => JSON.stringify(choice)).join(" | ");
  const one = is_path || WORDS.includes(value) ? "string" : separator || value.includes(",") ? "string | number | readonly number[]" : "string | number";
  return is_repeated ? `readonly (${one})[]` : one;
}

const camel = (name) => name.replace(/-(\w)/g, (_, letter) => letter.toUpperCase());

/** Breaks a text into lines of a comment. */
function comment(text) {
  const lines = [];
  for (const paragraph of text.split("\n")) {
    let line = "";
    for (const word of paragraph.split(" ")) {
      if (line && line.length + word.length > WIDTH) {
        lines.push(line);
        line = "";
      }
      line += line ? ` ${word}` : word;
    }
    lines.push(line);
  }
  return lines.map((line) => `   * ${line}`.trimEnd()).join("\n");
}

const members = table.map((option) => `  /**\n${comment(option.help)}\n   */\n  ${camel(option.name)}?: ${type(option)};`);
const entries = table.map(({ name, value, is_repeated, is_path }) => {
  const entry = { name, hasValue: value !== "", isRepeated: is_repeated, isPath: is_path };
  return `  ${camel(name)}: ${JSON.stringify(entry)},`;
});
await writeFile(
  out,
  `/** The options of \`rebounce bake\`; generate.mjs writes this file. */

/** Options of the command, by their names in camel case. */
export interface CommandOptions {
${members.join("\n")}
}

/** An option of the command. */
export interface OptionEntry {
  /** Its name, without the dashes. */
  name: string;
  hasValue: boolean;
  /** It may be given several times. */
  isRepeated: boolean;
  isPath: boolean;
}

/** The options, by their names in camel case. */
export const OPTIONS: Readonly<Record<string, OptionEntry>> = {
${entries.join("\n")}
};
`,
);
