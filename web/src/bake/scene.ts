/** Finds the files of a scene: beside the one that `src` names, or among files that were dropped. */

import { Failure } from "../wire/failure.js";
import { STEP } from "./kinds.js";

/** A scene to be baked, or one that is. */
export interface Scene {
  /** Path of its file, from which those that it refers to are found. */
  name: string;
  file: Blob;
  /** The files that it may refer to, by path. */
  files: Record<string, Blob>;
  /** It is a .rbn file. */
  isBaked: boolean;
}

/** Which file of several is the scene: the first of these kinds. */
const KINDS = [/\.rbn$/i, /\.glb$/i, /\.gltf$/i, STEP];

/** Files, with their paths where those are not what they are called. */
export type SceneFiles = readonly (File | readonly [path: string, file: File])[];

/** Returns the scene among files: the .rbn, .glb, .gltf or .step nearest to the root. Rejects with a `Failure`. */
export function sceneAmong(some: SceneFiles): Scene {
  const files = new Map(some.map((of) => (of instanceof File ? ([of.webkitRelativePath || of.name, of] as const) : of)));
  const depth = (path: string) => path.split("/").length;
  const paths = [...files.keys()].sort((a, b) => depth(a) - depth(b) || (a < b ? -1 : 1));
  const name = KINDS.map((kind) => paths.find((path) => kind.test(path))).find(Boolean);
  if (!name) {
    const what = paths.length === 1 ? `"${paths[0]}" is no scene` : `none of the ${paths.length} files is a scene`;
    throw new Failure("not-a-scene", `${what}: drop a .glb or .step, a .gltf together with its files, a folder of them, or a .rbn.`);
  }
  return { name, file: files.get(name) as Blob, files: Object.fromEntries(files), isBaked: KINDS[0]?.test(name) ?? false };
}

/** Fetches a scene and the files that a .gltf refers to. Rejects with a `Failure`, or the signal's reason. */
export async function fetchedScene(src: string, signal: AbortSignal): Promise<Scene> {
  const file = await fetched(src, signal);
  const name = pathOf(new URL(src));
  const files: Record<string, Blob> = {};
  if (/\.gltf$/i.test(name)) {
    await Promise.all(
      (await uris(file)).map(async (uri) => {
        const url = new URL(uri, src);
        // What does not come, the baker tells of, as the command does.
        const found = await fetched(url.href, signal).catch(() => undefined);
        signal.throwIfAborted();
        if (found) files[pathOf(url)] = found;
      }),
    );
  }
  return { name, file, files, isBaked: false };
}

/** The files that a .gltf refers to; none for what is no JSON, which the baker tells of. */
async function uris(file: Blob): Promise<string[]> {
  try {
    const { buffers = [], images = [] } = JSON.parse(await file.text()) as Record<string, { uri?: unknown }[]>;
    return [...buffers, ...images].flatMap(({ uri }) => (typeof uri === "string" && !/^data:/i.test(uri) ? [uri] : []));
  } catch {
    return [];
  }
}

async function fetched(url: string, signal: AbortSignal): Promise<Blob> {
  const name = pathOf(new URL(url)).replace(/.*\//, "") || url;
  let response: Response;
  try {
    response = await fetch(url, { signal });
  } catch (cause) {
    signal.throwIfAborted();
    throw new Failure("network", `The file ${name} could not be fetched; check the address and the connection.`, { cause });
  }
  if (!response.ok) {
    const reason = response.status === 404 ? "it is not there (404)" : `the server answered ${response.status}`;
    throw new Failure("http", `The file ${name} could not be loaded: ${reason}. Check the src attribute.`);
  }
  try {
    return await response.blob();
  } catch (cause) {
    signal.throwIfAborted();
    throw new Failure("truncated", `The download of ${name} broke off; load it again.`, { cause });
  }
}

/** The path of an address, as the files of a scene are named. */
function pathOf({ pathname }: URL): string {
  const path = pathname.replace(/^\/+/, "");
  try {
    return decodeURIComponent(path);
  } catch {
    return path;
  }
}
