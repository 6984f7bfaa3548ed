// node bundle.mjs MODULES OUT VERSION: joins the modules of the package, with those of web/src that it shares.

import { createRequire } from "node:module";
import path from "node:path";

// The packages of web/ serve here, too.
const { build } = createRequire(path.resolve("../../web/package.json"))("esbuild");

/** Files of the package, by name. */
const ENTRIES = { bin: "bin", index: "index", vite: "vite", "bake-worker": "wasm/worker" };

/** The wasm's own module lies beside the bundles. */
const WASM = {
  name: "wasm",
  setup: ({ onResolve }) => onResolve({ filter: /\/rebounce_baker\.js$/ }, () => ({ path: "./rebounce_baker.js", external: true })),
};
/** The version of the package. */
const VERSION = {
  name: "version",
  setup: ({ onLoad }) => onLoad({ filter: /[\\/]version\.js$/ }, () => ({ contents: `export const VERSION = ${JSON.stringify(version)};` })),
};

const [modules, outdir, version] = process.argv.slice(2);
if (!version) throw new Error("usage: node bundle.mjs MODULES OUT VERSION");
await build({
  entryPoints: Object.entries(ENTRIES).map(([out, name]) => ({ out, in: path.join(modules, "baker/npm/src", `${name}.js`) })),
  bundle: true,
  splitting: true,
  platform: "node",
  format: "esm",
  target: "node20",
  chunkNames: "shared-[hash]",
  plugins: [WASM, VERSION],
  logLevel: "warning",
  outdir,
});
