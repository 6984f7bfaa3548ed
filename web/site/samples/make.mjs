// node site/samples/make.mjs FOLDER: writes the scenes that visitors of the site may bake, as .glb files.

import { mkdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { afternoon } from "./afternoon.mjs";
import { red_and_green } from "./box.mjs";
import { courtyard } from "./courtyard.mjs";
import { rotunda } from "./rotunda.mjs";

/** Scenes by the names of their files. */
const SCENES = { "red-and-green": red_and_green, afternoon, courtyard, rotunda };

const [folder] = process.argv.slice(2);
if (!folder) throw new Error("usage: node site/samples/make.mjs FOLDER");
await mkdir(folder, { recursive: true });
for (const [name, scene] of Object.entries(SCENES)) {
  await writeFile(path.join(folder, `${name}.glb`), await scene().glb());
}
