// node manifest.mjs OUT.json: the custom-elements manifest of src/, for editors and documentation tools.
// What a class doc cannot say in its own words is taken from the types: events from RebounceEventMap,
// attributes from the properties of the same name.

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

const folder = new URL("src/", import.meta.url);
const files = (await readdir(folder)).filter((name) => name.endsWith(".ts") && !name.endsWith(".d.ts")).sort();
const sources = await Promise.all(
  files.map(async (name) => {
    const text = await readFile(new URL(name, folder), "utf8");
    return ts.createSourceFile(`dist/${name.replace(/ts$/, "js")}`, text, ts.ScriptTarget.ES2022, true);
  }),
);
const manifest = create({ modules: sources, plugins: [], context: { dev: false } });


const isElement = (node) => ts.isClassDeclaration(node) && node.name?.text === CLASS;
const [source, ...others] = sources.filter((file) => file.statements.some(isElement));
if (!source || others.length > 0) throw new Error(`src/ has to hold one class ${CLASS}`);
const isHidden = ({ modifiers, jsDoc = [] }) =>
  (modifiers ?? []).some(({ kind }) => kind !== ts.SyntaxKind.AsyncKeyword && kind !== ts.SyntaxKind.ReadonlyKeyword) ||
  jsDoc.some(({ tags = [] }) => tags.some(({ tagName }) => tagName.text === "internal"));
const open = source.statements.find(isElement).members.filter((member) => member.name && !isHidden(member));
const names = new Set(open.map((member) => member.name.getText(source)).filter((name) => !name.startsWith("#")));

// The rest is nobody's interface.
manifest.modules = manifest.modules.filter(({ path }) => path === source.fileName);
const [module] = manifest.modules;
// Types are no exports of a script.
module.exports = module.exports.filter(({ declaration }) => declaration.name === CLASS);
const { declarations } = module;
const element = declarations.find(({ name }) => name === CLASS);
element.description ||= doc(source.statements.find(isElement));
element.tagName = TAG;
element.customElement = true;
element.members = element.members.filter(({ name }) => names.has(name));
const fields = new Map(element.members.map((member) => [member.name, member]));
for (const attribute of element.attributes ?? []) {
  const field = fields.get(attribute.fieldName ?? attribute.name);
  if (!field) continue;
  attribute.fieldName = field.name;
  attribute.description ??= field.description;
  attribute.type ??= field.type;
}
element.events = sources.flatMap(eventsOf);
for (const list of ["members", "attributes", "events"]) {
  if (!element[list]?.length) throw new Error(`the manifest has no ${list}`);
}
await writeFile(out, `${JSON.stringify(manifest, null, 2)}\n`);
