/** What a material reads: bounced irradiance of its pixel, from the textures of `Pixels`. */

import type { Node, Texture } from "three/webgpu";
import { Break, cameraPosition, clamp, dot, float, Fn, fwidth, If, int, ivec2, Loop, normalize, normalWorld, positionWorld, renderGroup, screenCoordinate, select, texture, uint, uniform, vec2, vec3, vec4 } from "three/tsl";
import { octahedralDecode } from "./octahedral.js";
import type { Space } from "./space.js";
import { nothing } from "./textures.js";

/** How far a pixel's place may be from the surface that is shaded, in widths of a pixel; at its neighbours, of which one sees
 * the same surface where the pixel is at an edge. */
const NEAR = 1.5;
const NEAR_BESIDE = 3;
// As tilt.wgsl.
const STEEPEST = 2;

/** The lookup of a pixel, as nodes. */
export class Lookup {
  // Two: three.js takes nodes of one texture for one node.
  readonly #empty = [nothing(), nothing()] as const;
  readonly #places = texture(this.#empty[0]);
  readonly #light = texture(this.#empty[1]);
  readonly #hasPixels = uniform(0).setGroup(renderGroup);
  /** Irradiance of the surface that is shaded. */
  readonly node: Node<"vec3">;

  /** `otherwise`: irradiance at a place with a normal, local space, where no pixel has it; 0 where the last number is 0. */
  constructor(space: Space, isBumpy: boolean, diagonal: number, otherwise?: (place: Node<"vec3">, normal: Node<"vec3">, wanted: Node<"float">) => Node<"vec3">) {
    const { localNode } = space;
    this.node = Fn(() => {
      const place = localNode.mul(vec4(positionWorld, 1)).xyz.toVar();
      const normal = normalize(localNode.mul(vec4(normalWorld, 0)).xyz).toVar();
      const width = fwidth(place).length().add(1e-6 * diagonal).toVar();
      const pixel = ivec2(screenCoordinate.xy).toVar();
      const sees = (there: Place, reach: number) => there.w.greaterThan(0).and(there.xyz.sub(place).length().lessThan(width.mul(reach)));
      const front = select(this.#hasPixels.greaterThan(0), this.#places.load(pixel), vec4(0)).toVar();
      const isOwn = sees(front as unknown as Place, NEAR).toVar();
      const found = select(isOwn, front, vec4(0)).toVar();
      const at = pixel.toVar();
      // Loops where branches would do: some software adapters walk through branches that nobody takes.
      const neighbours = select(isOwn.not().and(this.#hasPixels.greaterThan(0)), int(4), int(0));
      Loop({ start: int(0), end: neighbours, type: "int", condition: "<" }, ({ i }) => {
        const one = (k: number) => select(int(i).equal(int(k)), int(1), int(0));
        const beside = pixel.add(ivec2(one(0).sub(one(1)), one(2).sub(one(3)))).toVar();
        const there = this.#places.load(beside).toVar();
        If(sees(there as unknown as Place, NEAR_BESIDE), () => {
          found.assign(there);
          at.assign(beside);
          Break();
        });
      });
      const sum = vec3(0).toVar();
      const isFound = found.w.greaterThan(0).toVar();
      // What lies behind the pixel's surface is drawn over.
      const eye = localNode.mul(vec4(cameraPosition, 1)).xyz.toVar();
      const isHidden = front.w.greaterThan(0).and(place.sub(eye).length().greaterThan(front.xyz.sub(eye).length().add(width)));
      const light = this.#light.load(at).toVar();
      const own = isBumpy ? light.xyz.mul(turned(unpackNormal(found.w.max(1)), unpackTilt(light.w), normal)) : light.xyz;
      sum.assign(select(isFound, own, vec3(0)));
      if (otherwise) sum.addAssign(otherwise(place, normal, select(isFound.or(isHidden), float(0), float(1))));
      return sum;
    })() as unknown as Node<"vec3">;
  }

  /** Reads from these textures from now on; from none without. */
  set(places?: Texture, light?: Texture): void {
    this.#hasPixels.value = places ? 1 : 0;
    this.#places.value = places ?? this.#empty[0];
    this.#light.value = light ?? this.#empty[1];
  }

  /** Frees its texture. */
  dispose(): void {
    for (const empty of this.#empty) empty.dispose();
  }
}

type Float = Node<"float">;
type Vector = Node<"vec3">;
type Place = Node<"vec4">;

/** What bounced light becomes on a normal that a normal map has turned, as reflect.wgsl has it. */
function turned(normal: Vector, tilt: Vector, bent: Vector): Float {
  const across = tilt.sub(normal.mul(dot(normal, tilt)));
  return clamp(dot(bent, normal.add(across)), 0, STEEPEST) as unknown as Float;
}

/** As `tilt_unpack` of tilt.wgsl. */
function unpackTilt(whole: Float): Vector {
  const bits = uint(whole);
  const part = (shift: number) => float(bits.shiftRight(uint(shift)).bitAnd(uint(255)));
  return vec3(part(0), part(8), part(16)).sub(128).mul(STEEPEST / 127) as unknown as Vector;
}

/** As place_given.wgsl reads it. */
function unpackNormal(whole: Float): Vector {
  const code = uint(whole).sub(uint(1));
  const square = vec2(float(code.bitAnd(uint(4095))), float(code.shiftRight(uint(12))));
  return octahedralDecode(square.mul(2 / 4095).sub(1).toVar() as unknown as Node<"vec2">);
}
