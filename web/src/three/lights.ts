/** The lights of a three.js scene as those of a file, followed as they move. */

import {
  Vector3,
  type DirectionalLight,
  type Light,
  type PointLight,
  type RectAreaLight,
  type SpotLight,
} from "three/webgpu";
import type { Light as OwnLight } from "../wire/light-kinds.js";
import type { Triple } from "../wire/shot.js";
import { Once } from "./once.js";
import type { Space } from "./space.js";

/** The parts of three's smooth step that a cone's linear, squared ramp follows best: where it begins and where it is full. */
const RAMP = { begin: -0.023, end: 0.746 };

/** Lights of three whose light is to bounce. */
export class FollowedLights {
  #lights = new Set<Light>();
  #once = new Once();

  /** Follows lights from now on: point, spot, directional and rectangle lights. */
  add(...lights: Light[]): this {
    for (const light of lights) this.#lights.add(light);
    return this;
  }

  /** Forgets lights. */
  remove(...lights: Light[]): this {
    for (const light of lights) this.#lights.delete(light);
    return this;
  }

  /** Forgets all lights. */
  clear(): this {
    this.#lights.clear();
    return this;
  }

  /** How many there are. */
  get size(): number {
    return this.#lights.size;
  }

  /** Each of them. */
  [Symbol.iterator](): IterableIterator<Light> {
    return this.#lights.values();
  }

  /** What they are now, in the space of a file. */
  in(space: Space): OwnLight[] {
    return [...this.#lights].flatMap((light) => this.#as(light, space) ?? []);
  }

  #as(light: Light, space: Space): OwnLight | undefined {
    light.updateWorldMatrix(true, false);
    const name = light.name || light.type;
    const { r, g, b } = light.color;
    const color: Triple = [r, g, b];
    const shines = isShown(light) ? light.intensity : 0;
    const place = (object: { matrixWorld: Light["matrixWorld"] }) =>
      new Vector3().setFromMatrixPosition(object.matrixWorld).applyMatrix4(space.fileFromWorld);
    const position = place(light).toArray() as Triple;
    /** Candela of lengths in the file's unit. */
    const candela = shines * space.scale ** 2;
    if ("isPointLight" in light) {
      this.#checkFalloff(light as PointLight, name);
      return { type: "point", position, intensity: candela, color };
    }
    if ("isSpotLight" in light) {
      const spot = light as SpotLight;
      this.#checkFalloff(spot, name);
      if (spot.map) this.#once.warn(spot, `the picture of "${name}" is left out of its bounced light`);
      const cone = (share: number) => {
        const inner = Math.cos(spot.angle * (1 - spot.penumbra));
        const outer = Math.cos(spot.angle);
        return (Math.acos(Math.min(1, Math.max(-1, outer + share * (inner - outer)))) * 180) / Math.PI;
      };
      const angles = { outer_cone_deg: Math.min(cone(RAMP.begin), 90), inner_cone_deg: cone(RAMP.end) };
      return { type: "spot", position, direction: towards(spot, place), ...angles, intensity: candela, color };
    }
    if ("isDirectionalLight" in light) {
      return { type: "directional", direction: towards(light as DirectionalLight, place), intensity: shines, color };
    }
    if ("isRectAreaLight" in light) {
      const { width, height, matrixWorld } = light as RectAreaLight;
      const axis = (column: number) => new Vector3().setFromMatrixColumn(matrixWorld, column).transformDirection(space.fileFromWorld);
      const direction = axis(2).negate().toArray() as Triple;
      const size = { width: width * space.scale, height: height * space.scale };
      return { type: "rectangle", position, direction, up: axis(1).toArray() as Triple, ...size, intensity: shines, color };
    }
    this.#once.warn(light, `"${name}" is a ${light.type}, whose light does not bounce: it comes from everywhere and meets no wall`);
    return undefined;
  }

  #checkFalloff(light: PointLight | SpotLight, name: string): void {
    const { decay, distance } = light;
    if (decay !== 2) this.#once.warn(light, `"${name}" has decay ${decay}: its bounced light falls with the square of the distance`);
    if (distance !== 0) this.#once.warn(light, `"${name}" ends at distance ${distance}: its bounced light goes on`);
  }
}

/** Whether a light and all that it hangs on are visible. */
function isShown(light: Light): boolean {
  for (let object: Light["parent"] = light; object; object = object.parent) if (!object.visible) return false;
  return true;
}

/** The way the light travels, in the space of a file. */
function towards(light: SpotLight | DirectionalLight, place: (object: { matrixWorld: Light["matrixWorld"] }) => Vector3): Triple {
  light.target.updateWorldMatrix(true, false);
  const way = place(light.target).sub(place(light));
  return (way.lengthSq() > 0 ? way : new Vector3(0, -1, 0)).toArray() as Triple;
}
