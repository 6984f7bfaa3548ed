/** Nodes of a scene that may move. */

import type { Viewer } from "../rebounce_radiosity.js";
import { numbers } from "./check.js";
import type { Triple } from "./shot.js";

/** A node: how it has been moved from where the file has it, about its own origin, world space. */
export interface SceneNode {
  /** Shift. */
  translation: Triple;
  /** Turn, before the shift: a quaternion x, y, z, w. */
  rotation: [number, number, number, number];
}

/** Nodes by their names. */
export type Nodes = Record<string, SceneNode>;

/** Numbers of a node: translation, rotation. */
const NUMBERS = 7;

/** The nodes of a viewer's scene; what is set moves them. Of nodes of one name the first counts. */
export function nodesOf(viewer: Viewer): Nodes {
  const out: Nodes = {};
  for (const [i, name] of viewer.nodeNames().split("\0").slice(0, -1).entries()) {
    if (name in out) continue;
    const get = (from: number, length: number) => [...viewer.nodeMotions().subarray(NUMBERS * i + from, NUMBERS * i + from + length)];
    const set = (from: number, values: readonly number[]) => {
      const all = viewer.nodeMotions();
      all.set(values, NUMBERS * i + from);
      viewer.setNodeMotions(all);
    };
    out[name] = {
      get translation() {
        return get(0, 3) as Triple;
      },
      set translation(value) {
        set(0, numbers(`nodes.${name}.translation`, value, 3));
      },
      get rotation() {
        return get(3, 4) as SceneNode["rotation"];
      },
      set rotation(value) {
        set(3, numbers(`nodes.${name}.rotation`, value, 4));
      },
    };
  }
  return out;
}
