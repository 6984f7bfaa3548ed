// node site/three/bundle.mjs OUT: the example with three.js, as one module and what it fetches later; the element's own
// modules lie beside, in ../rebounce-viewer.

import { build } from "esbuild";
import path from "node:path";

const [outdir] = process.argv.slice(2);
if (!outdir) throw new Error("usage: node site/three/bundle.mjs OUT");
const web = path.join(import.meta.dirname, "../..");
const baker = {
  name: "baker",
  setup: ({ onResolve }) => onResolve({ filter: /^\.\/bake\.js$/ }, () => ({ path: "../rebounce-viewer/bake.js", external: true })),
};
await build({
  entryPoints: [path.join(import.meta.dirname, "hall.js")],
  alias: { "rebounce-viewer/three": path.join(web, "dist/three.js") },
  plugins: [baker],
  bundle: true,
  splitting: true,
  minify: true,
  format: "esm",
  target: "es2022",
  logLevel: "warning",
  outdir,
});
