/** A plugin for Vite: `import room from "./room.glb?rebounce"` is the address of the baked scene. */

import { createHash } from "node:crypto";
import { existsSync } from "node:fs";
import { mkdir, readFile } from "node:fs/promises";
import type { IncomingMessage, ServerResponse } from "node:http";
import path from "node:path";
import { bake } from "./index.js";
import { OPTIONS } from "./options.js";
import type { BakeOptions } from "./types.js";
import { VERSION } from "./version.js";
import { writeWhole } from "./write.js";

/** What the plugin uses of Vite's configuration. */
interface Config {
  command: "build" | "serve";
  root: string;
  base: string;
  cacheDir: string;
  logger: { info(text: string): void; warn(text: string): void };
}

/** What the plugin uses of Vite's development server. */
interface Server {
  middlewares: { use(handle: (request: IncomingMessage, response: ServerResponse, next: (error?: unknown) => void) => void): unknown };
}

/** What the plugin uses of a build. */
interface Build {
  addWatchFile(file: string): void;
  emitFile(file: { type: "asset"; name: string; source: Uint8Array }): string;
}

/** The plugin, as Vite from version 5 on takes it. */
export interface RebouncePlugin {
  name: "rebounce";
  enforce: "pre";
  configResolved(config: Config): void;
  configureServer(server: Server): void;
  load(this: Build, id: string): Promise<string | undefined>;
}

/** Options of the plugin: those of the bakes. The preset is "draft" while serving and "standard" in builds when absent. */
export type RebounceOptions = Omit<BakeOptions, "name" | "files" | "signal" | "onProgram" | "onProgress" | "onReport" | "onWarning">;

/** Where the development server has baked scenes. */
const SERVED = "/@rebounce/";

/** Returns the plugin. Each scene is baked once for its contents and options; the file is kept in Vite's cache folder. */
export default function rebounce(options: RebounceOptions = {}): RebouncePlugin {
  let config: Config;
  const baking = new Map<string, Promise<string>>();
  const folder = (): string => path.join(config.cacheDir, "rebounce");

  /** Bakes unless that was done before; the file. */
  async function baked(file: string, own: RebounceOptions): Promise<string> {
    const key = await keyOf(file, own);
    const out = path.join(folder(), `${key}.rbn`);
    if (existsSync(out)) return out;
    const running = baking.get(key);
    if (running) return running;
    const work = (async () => {
      const name = path.relative(config.root, file);
      const onWarning = (sentence: string): void => config.logger.warn(`rebounce: ${name}: ${sentence}`);
      const onProgram = (program: string): void => config.logger.info(`rebounce: baking ${name} (${own.preset}, ${program})`);
      const bytes = await bake(file, { ...own, onProgram, onWarning });
      await mkdir(folder(), { recursive: true });
      writeWhole(out, bytes);
      return out;
    })();
    baking.set(key, work);
    try {
      return await work;
    } finally {
      baking.delete(key);
    }
  }

  return {
    name: "rebounce",
    enforce: "pre",
    configResolved(resolved) {
      config = resolved;
    },
    configureServer(server) {
      server.middlewares.use((request, response, next) => {
        const [, name] = new RegExp(`${SERVED}([0-9a-f]+\\.rbn)$`).exec(request.url ?? "") ?? [];
        if (!name) return next();
        readFile(path.join(folder(), name)).then((bytes) => {
          response.setHeader("Content-Type", "application/octet-stream");
          response.setHeader("Cache-Control", "max-age=31536000, immutable");
          response.end(bytes);
        }, next);
      });
    },
    async load(id) {
      const [file = "", query = ""] = id.split("?", 2);
      const wanted = new URLSearchParams(query);
      if (!wanted.has("rebounce")) return undefined;
      wanted.delete("rebounce");
      const preset = config.command === "serve" ? "draft" : "standard";
      const own = { preset, ...options, ...ofQuery(wanted) } as RebounceOptions;
      for (const one of [file, ...(await beside(file, own))]) this.addWatchFile(one);
      const out = await baked(file, own);
      if (config.command === "serve") {
        const address = `${config.base.replace(/\/$/, "")}${SERVED}${path.basename(out)}`;
        return `export default ${JSON.stringify(address)};`;
      }
      const name = `${path.basename(file, path.extname(file))}.rbn`;
      const reference = this.emitFile({ type: "asset", name, source: await readFile(out) });
      return `export default import.meta.ROLLUP_FILE_URL_${reference};`;
    },
  };
}

/** The options in the query of an import: `?preset=fine&rebounce`. */
function ofQuery(query: URLSearchParams): Record<string, string | boolean> {
  // Vite adds parameters of its own, such as the time of a change.
  const own = [...query].filter(([name]) => Object.hasOwn(OPTIONS, name));
  return Object.fromEntries(own.map(([name, value]) => [name, OPTIONS[name]?.hasValue ? value : value !== "false"]));
}

/** Files that the result depends on besides the scene's own: those that a .gltf refers to, and those that options name. */
async function beside(file: string, options: RebounceOptions): Promise<string[]> {
  const named = Object.entries(options).flatMap(([name, value]) => (OPTIONS[name]?.isPath && typeof value === "string" ? [path.resolve(value)] : []));
  if (!/\.gltf$/i.test(file)) return named;
  try {
    const { buffers = [], images = [] } = JSON.parse(await readFile(file, "utf8")) as Record<string, { uri?: unknown }[]>;
    const uris = [...buffers, ...images].flatMap(({ uri }) => (typeof uri === "string" && !uri.startsWith("data:") ? [uri] : []));
    return [...named, ...uris.map((uri) => path.resolve(path.dirname(file), decodeURIComponent(uri)))];
  } catch {
    // The bake tells what is wrong with the file.
    return named;
  }
}

/** A hash of everything that the result depends on. */
async function keyOf(file: string, options: RebounceOptions): Promise<string> {
  const hash = createHash("sha256");
  const { program: _, threads: __, ...own } = options;
  hash.update(JSON.stringify([VERSION, path.basename(file), Object.entries(own).sort()]));
  for (const one of [file, ...(await beside(file, options))]) {
    const bytes = await readFile(one).catch(() => new Uint8Array());
    hash.update(`${bytes.length} `).update(bytes);
  }
  return hash.digest("hex").slice(0, 32);
}
