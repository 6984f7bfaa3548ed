/** Unit vectors packed by the octahedral map, as nodes: octahedral.wgsl. */

import type { Node } from "three/webgpu";
import { float, normalize, select, vec2, vec3 } from "three/tsl";

type Pair = Node<"vec2">;

const signNotZero = (v: Pair) => vec2(select(v.x.lessThan(0), float(-1), float(1)), select(v.y.lessThan(0), float(-1), float(1)));

/** The square's place of a vector of any length but 0, -1 to 1. */
export function octahedralEncode(v: Node<"vec3">): Pair {
  const flat = v.xy.div(v.x.abs().add(v.y.abs()).add(v.z.abs()).max(1e-20)).toVar();
  return select(v.z.lessThan(0), vec2(1).sub(flat.yx.abs()).mul(signNotZero(flat)), flat) as unknown as Pair;
}

/** The unit vector of a place in the square. */
export function octahedralDecode(flat: Pair): Node<"vec3"> {
  const z = float(1).sub(flat.x.abs()).sub(flat.y.abs());
  return normalize(vec3(flat.sub(signNotZero(flat).mul(z.negate().max(0))), z)) as unknown as Node<"vec3">;
}
