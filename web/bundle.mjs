// node bundle.mjs MODULES OUT: joins the modules into a file for each entry and one for what they share, as gzip finds
// more in fewer files. The wasm's own module stays as it is.

import { buildSync } from "esbuild";
import path from "node:path";

/** Modules that pages import, or that are fetched when they are first wanted. */
const ENTRIES = ["rebounce-viewer", "panel", "daylight", "page"];

const [modules, outdir] = process.argv.slice(2);
if (!outdir) throw new Error("usage: node bundle.mjs MODULES OUT");
buildSync({
  entryPoints: ENTRIES.map((name) => path.join(modules, `${name}.js`)),
  bundle: true,
  splitting: true,
  format: "esm",
  target: "es2022",
  chunkNames: "shared-[hash]",
  external: ["./rebounce_viewer.js"],
  logLevel: "warning",
  outdir,
});
