// The tables of web/README.md: all that stands in them is on the element, is tested, and nothing is left out.

import { readFile } from "node:fs/promises";
import { check, same } from "../harness.mjs";

/** Headings of the README and what their tables list. */
const TABLES = {
  Attributes: "attribute",
  Properties: "property",
  Methods: "method",
  Events: "event",
  Slots: "slot",
  Parts: "part",
  Variables: "variable",
};

/** What the README's tables name, such as "attribute src". */
async function named() {
  const text = await readFile(new URL("../../README.md", import.meta.url), "utf8");
  const names = [];
  let kind;
  for (const line of text.split("\n")) {
    const heading = /^#+ (.*)/.exec(line);
    if (heading) kind = TABLES[heading[1]];
    const row = /^\| `([\w-]+)[^`]*` \|(?: `(\w+)` \|)?/.exec(line);
    if (kind && row) names.push(`${kind} ${row[1]}`);
    // Beside an attribute stands its property.
    if (kind === "attribute" && row) names.push(`property ${row[2]}`);
  }
  return names;
}

/** What the element has, as far as it can be asked. */
async function found() {
  const { RebounceViewer } = await import(new URL("../../dist/rebounce-viewer.js", import.meta.url));
  const names = RebounceViewer.observedAttributes.map((name) => `attribute ${name}`);
  const callbacks = ["constructor", "connectedCallback", "disconnectedCallback", "attributeChangedCallback"];
  for (let own = RebounceViewer.prototype; own !== Object.prototype; own = Object.getPrototypeOf(own)) {
    for (const [name, { get }] of Object.entries(Object.getOwnPropertyDescriptors(own))) {
      if (!callbacks.includes(name)) names.push(`${get ? "property" : "method"} ${name}`);
    }
  }
  const read = (file) => readFile(new URL(`../../src/${file}.ts`, import.meta.url), "utf8");
  const each = (text, pattern, kind) => [...text.matchAll(pattern)].map(([, name]) => `${kind} ${name}`);
  const tree = await read("element/tree");
  const styles = (await read("element/style")) + (await read("panel/style")) + tree;
  return [
    ...names,
    ...each(await read("element/events"), /^ {2}"?([\w-]+)"?: CustomEvent/gm, "event"),
    ...each(tree, /slot\("(\w+)"/g, "slot"),
    ...each(tree + (await read("panel/panel")) + (await read("input/stick")), /part(?:: |", )"(\w+)"/g, "part"),
    ...each(styles, /(--rebounce-[\w-]+)/g, "variable"),
  ];
}

/** Last of all: the other tests have said what they looked at. */
export async function readme(harness) {
  const names = await named();
  await harness.test("readme::lists_what_the_element_has_and_nothing_else", async () => {
    for (const kind of Object.values(TABLES)) check(names.some((name) => name.startsWith(`${kind} `)), `no ${kind} is listed`);
    same([...new Set(names)].sort(), [...new Set(await found())].sort(), "names in the README");
  });
  await harness.test("readme::everything_listed_has_a_test_that_passed", () => {
    same(names.filter((name) => !harness.covered.has(name)), [], "names without a test");
    const unknown = [...harness.covered].filter((name) => name !== "" && !names.includes(name));
    same(unknown, [], "names that only the tests know");
  });
}
