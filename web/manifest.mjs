// node manifest.mjs OUT.json: the custom-elements manifest of src/, for editors and documentation tools.
// What a class doc cannot say in its own words is taken from the types: events from RebounceEventMap,
// attributes from the properties of the same name. Slots, parts and variables are those of the README's tables.

import { create, ts } from "@custom-elements-manifest/analyzer";
import { readFile, readdir, writeFile } from "node:fs/promises";

const TAG = "rebounce-viewer";
const CLASS = "RebounceViewer";
const EVENT_MAP = "RebounceEventMap";

const [out] = process.argv.slice(2);
if (!out) throw new Error("usage: node manifest.mjs OUT.json");

/** The text of the doc comment before a node. */
const doc = (node) =>
  (node.jsDoc ?? [])
    .map(({ comment }) => (typeof comment === "string" ? comment : ts.getTextOfJSDocComment(comment)) ?? "")
    .join("\n")
    .replaceAll(/\s+/g, " ")
    .trim();

/** The events that an interface of names and CustomEvents lists. */
function eventsOf(source) {
  const map = source.statements.find((node) => ts.isInterfaceDeclaration(node) && node.name.text === EVENT_MAP);
  return (map?.members ?? []).map((member) => ({
    name: member.name.text,
    type: { text: member.type.getText(source) },
    description: doc(member),
  }));
}

/** What a table of the README lists: names and what they mean. */
function listed(readme, heading) {
  const [section] = (readme.split(`\n### ${heading}\n`)[1] ?? "").split(/\n#/);
  return [...section.matchAll(/^\| `([\w-]+)` \| (.*) \|$/gm)].map(([, name, description]) => ({ name, description }));
}

const folder = new URL("src/", import.meta.url);
const files = (await readdir(folder, { recursive: true }))
  .filter((name) => name.endsWith(".ts") && !name.endsWith(".d.ts"))
  .sort();
const sources = await Promise.all(
  files.map(async (name) => {
    const text = await readFile(new URL(name, folder), "utf8");
    return ts.createSourceFile(`dist/${name.replace(/ts$/, "js")}`, text, ts.ScriptTarget.ES2022, true);
  }),
);
const manifest = create({ modules: sources, plugins: [], context: { dev: false } });

const classes = new Map(
  sources.flatMap((source) =>
    source.statements.filter((node) => ts.isClassDeclaration(node) && node.name).map((node) => [node.name.text, { node, source }]),
  ),
);
/** The element's class and those of src/ that it extends. */
const line = [];
for (let name = CLASS; classes.has(name); ) {
  const { node, source } = classes.get(name);
  const declared = manifest.modules.find(({ path }) => path === source.fileName).declarations;
  line.push({ node, source, declaration: declared.find((declaration) => declaration.name === name) });
  name = node.heritageClauses?.[0]?.types[0]?.expression.getText(source);
}
const [own] = line;
if (!own) throw new Error(`src/ has no class ${CLASS}`);

const SHOWN = [ts.SyntaxKind.AsyncKeyword, ts.SyntaxKind.ReadonlyKeyword, ts.SyntaxKind.OverrideKeyword];
const isHidden = ({ modifiers, jsDoc = [] }) =>
  (modifiers ?? []).some(({ kind }) => !SHOWN.includes(kind)) ||
  jsDoc.some(({ tags = [] }) => tags.some(({ tagName }) => tagName.text === "internal"));
/** The entries of a list of every class of the line, each name once, the heir's before those it inherits. */
const gathered = (list) => {
  const entries = line.flatMap(({ declaration }) => declaration[list] ?? []);
  return [...new Map([...entries].reverse().map(({ inheritedFrom, ...entry }) => [entry.name, entry])).values()].reverse();
};

// The rest is nobody's interface.
manifest.modules = manifest.modules.filter(({ path }) => path === own.source.fileName);
const [module] = manifest.modules;
const element = own.declaration;
module.declarations = [element];
// Types are no exports of a script.
module.exports = module.exports.filter(({ declaration }) => declaration.name === CLASS);
Object.assign(element, { tagName: TAG, customElement: true, superclass: { name: "HTMLElement" } });
element.description ||= doc(own.node);
const names = new Set(
  line.flatMap(({ node, source }) =>
    node.members.filter((member) => member.name && !isHidden(member)).map((member) => member.name.getText(source)),
  ),
);
element.members = gathered("members").filter(({ name }) => names.has(name) && !name.startsWith("#"));
const fields = new Map(element.members.map((member) => [member.name, member]));
const camelCase = (name) => name.replaceAll(/-(\w)/g, (_, letter) => letter.toUpperCase());
element.attributes = gathered("attributes").map(({ name, ...rest }) => {
  const field = fields.get(camelCase(name));
  if (!field) return { name, ...rest };
  return { name, description: field.description, type: field.type, ...rest, fieldName: field.name };
});
element.events = sources.flatMap(eventsOf);
const readme = await readFile(new URL("README.md", import.meta.url), "utf8");
element.slots = listed(readme, "Slots");
element.cssParts = listed(readme, "Parts");
element.cssProperties = listed(readme, "Variables");
for (const list of ["members", "attributes", "events", "slots", "cssParts", "cssProperties"]) {
  if (element[list].length === 0) throw new Error(`the manifest has no ${list}`);
}
await writeFile(out, `${JSON.stringify(manifest, null, 2)}\n`);
