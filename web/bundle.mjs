// node bundle.mjs MODULES OUT: joins the modules into a file for each entry and one for what they share, as gzip finds
// more in fewer files. The wasm's own module stays as it is.

import { build } from "esbuild";
import path from "node:path";

/** Modules that pages import, or that are fetched when they are first wanted: by the name of the file, the module. */
const ENTRIES = { "rebounce-viewer": "rebounce-viewer", panel: "panel/panel", hdr: "environment/hdr", daylight: "daylight", page: "page/page" };

/** The wasm's own module lies beside the bundles, in whatever folder the module that imports it was. */
const WASM = {
  name: "wasm",
  setup: ({ onResolve }) => onResolve({ filter: /\/rebounce_viewer\.js$/ }, () => ({ path: "./rebounce_viewer.js", external: true })),
};

const [modules, outdir] = process.argv.slice(2);
if (!outdir) throw new Error("usage: node bundle.mjs MODULES OUT");
await build({
  entryPoints: Object.entries(ENTRIES).map(([out, name]) => ({ out, in: path.join(modules, `${name}.js`) })),
  bundle: true,
  splitting: true,
  format: "esm",
  target: "es2022",
  chunkNames: "shared-[hash]",
  plugins: [WASM],
  logLevel: "warning",
  outdir,
});
