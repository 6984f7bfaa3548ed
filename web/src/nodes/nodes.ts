/** Nodes of a scene that may move, by their names. */

import type { Viewer } from "../rebounce_radiosity.js";
import { member, numbers, number, wrong } from "../wire/check.js";
import type { NodeMove, Nodes, Quaternion, SceneNode, Triple } from "../wire/shot.js";

/** Numbers of a node: translation, rotation. */
const NUMBERS = 7;
/** A node that is where the file has it. */
const REST = [0, 0, 0, 0, 0, 0, 1];

/** The names of a zero-terminated list. */
export const listed = (names: string): string[] => names.split("\0").slice(0, -1);

/** Names of the nodes, in their order. */
export const namesIn = (viewer: Viewer): string[] => listed(viewer.nodeNames());

/** The nodes of a viewer's scene; what is set moves them. Of nodes of one name the first counts. */
export function nodesOf(viewer: Viewer): Nodes {
  const out: Nodes = {};
  for (const [i, name] of namesIn(viewer).entries()) {
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

/** Motions of the nodes that are elsewhere than the file has them, as a shot's `move`. */
export function movesIn(viewer: Viewer): Record<string, NodeMove> {
  const moved = Object.entries(nodesOf(viewer)).filter(([, { translation, rotation }]) => [...translation, ...rotation].some((x, i) => x !== REST[i]));
  return Object.fromEntries(moved.map(([name, { translation, rotation }]) => [name, { translation, rotation }]));
}

/** The numbers of all nodes for a shot's `move`; those that it does not name are where the file has them. Throws `bad-json`. */
export function motionsOf(viewer: Viewer, moves: Record<string, NodeMove>): Float64Array {
  const names = namesIn(viewer);
  const all = new Float64Array(names.flatMap(() => REST));
  for (const [name, move] of Object.entries(member("move", moves) as Record<string, NodeMove>)) {
    const i = names.indexOf(name);
    if (i < 0) throw wrong("move", `no node “${name}” can move; ${names.length ? `these can: ${names.join(", ")}` : "nothing of this file can"}`);
    const at = `move.${name}`;
    const { translation, rotation, rotation_y_deg } = member(at, move) as NodeMove;
    const shift = numbers(`${at}.translation`, translation, 3, [0, 0, 0]);
    const turn = numbers(`${at}.rotation`, rotation, 4, [0, 0, 0, 1]) as Quaternion;
    all.set([...shift, ...turned(number(`${at}.rotation_y_deg`, rotation_y_deg, 0), turn)], NUMBERS * i);
  }
  return all;
}

/** A turn about the world's y axis, degrees, after another one. */
function turned(degrees: number, [x, y, z, w]: Quaternion): Quaternion {
  const half = (degrees * Math.PI) / 360;
  const [s, c] = [Math.sin(half), Math.cos(half)];
  return [c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y];
}
