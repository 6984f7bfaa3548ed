// node bundle.mjs MODULES OUT: joins the modules into a file for each entry and one for what they share, as gzip finds
// more in fewer files. The wasm's own module stays as it is.

import { build } from "esbuild";
import { readFile } from "node:fs/promises";
import path from "node:path";

/** Modules that pages import, or that are fetched when they are first wanted: by the name of the file, the module. */
const ENTRIES = { "rebounce-viewer": "rebounce-viewer", panel: "panel/panel", environment: "environment/download", exr: "environment/exr", sky: "environment/sky", daylight: "daylight", page: "page/page", bake: "bake", "bake-element": "bake/element", "bake-drop": "bake/drop", "bake-worker": "bake/worker", "bake-step-worker": "bake/step-worker", radiosity: "radiosity" };

/** Entries for three.js: apart, so that what they share with those above stays where it is. */
const THREE = { three: "three" };

/** The wasms' own modules lie beside the bundles, in whatever folder the module that imports one was. */
const WASM = {
  name: "wasm",
  setup: ({ onResolve }) => onResolve({ filter: /\/rebounce_(viewer|radiosity|baker|baker_step|three)\.js$/ }, ({ path: name }) => ({ path: `./${path.basename(name)}`, external: true })),
};

/** The page's own three.js, and the baker's module, which lies beside. */
const OUTSIDE = {
  name: "outside",
  setup: ({ onResolve }) => {
    onResolve({ filter: /^three(\/|$)/ }, ({ path: name }) => ({ path: name, external: true }));
    onResolve({ filter: /^\.\.\/bake\.js$/ }, () => ({ path: "./bake.js", external: true }));
  },
};

/** Data of modules, where the rest of the repository has them. */
const DATA = {
  name: "data",
  setup: ({ onResolve }) => onResolve({ filter: /^hosek_wilkie_rgb\.bin$/ }, ({ path: name }) => ({ path: path.resolve("../shared/src/environment/daylight/data", name) })),
};

/** The Huffman decoder of parse-exr goes on for ever where a damaged file holds more than its pixels: it is to throw. */
const ENDS = {
  name: "ends",
  setup: ({ onLoad }) =>
    onLoad({ filter: /parse-exr[\\/]index\.js$/ }, async ({ path: file }) => {
      const parts = (await readFile(file, "utf8")).split("return false;");
      if (parts.length !== 4) throw new Error("parse-exr is another than bundle.mjs knows: look whether damaged files still hang it");
      return { contents: parts.join('throw new Error("more than its pixels");') };
    }),
};

const [modules, outdir] = process.argv.slice(2);
if (!outdir) throw new Error("usage: node bundle.mjs MODULES OUT");
const bundled = (entries, chunkNames, plugins) =>
  build({
    entryPoints: Object.entries(entries).map(([out, name]) => ({ out, in: path.join(modules, `${name}.js`) })),
    bundle: true,
    splitting: true,
    format: "esm",
    target: "es2022",
    chunkNames,
    plugins,
    loader: { ".bin": "base64" },
    logLevel: "warning",
    outdir,
  });
await bundled(ENTRIES, "shared-[hash]", [WASM, DATA, ENDS]);
await bundled(THREE, "three-[hash]", [WASM, OUTSIDE]);
