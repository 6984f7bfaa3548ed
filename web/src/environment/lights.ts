/** The lights that show a picture: an environment, and the sun of a sky. */

import type { EnvironmentLight, Light } from "../wire/light-kinds.js";
import type { Picture } from "./picture.js";

/** What the pictures of one element have done to the lights of its scene. */
export class PictureLights {
  /** A picture has brought the environment. */
  #added = false;
  /** The scene's own sun, in whose place a sky's is; null where there was none. */
  #own: Light | null | undefined;

  /** The scene is another. */
  forget(): void {
    this.#added = false;
    this.#own = undefined;
  }

  /** Lights with those that show a picture, or without a picture as the scene had them; `members` are of a new environment. */
  of(before: readonly Light[], picture: Picture | undefined, members: Partial<EnvironmentLight>): Light[] {
    const lights = before.filter((light) => picture || !this.#added || !isEnvironment(light));
    if (!picture) this.#added = false;
    else if (!lights.some(isEnvironment)) {
      lights.push({ type: "environment", intensity: 1, ...members });
      this.#added = true;
    }
    const { rotation_deg = 0, intensity = 1 } = lights.find(isEnvironment) ?? {};
    const sun = picture?.sun?.(rotation_deg, intensity);
    if (!sun && this.#own === undefined) return lights;
    const at = lights.findIndex(isSun);
    if (this.#own === undefined) this.#own = lights[at] ?? null;
    const there = sun ?? this.#own;
    lights.splice(at < 0 ? lights.length : at, 1, ...(there ? [there] : []));
    if (!sun) this.#own = undefined;
    return lights;
  }
}

const isEnvironment = (light: Light): light is EnvironmentLight => light.type === "environment";
/** A sky's sun, or the scene's own. */
const isSun = ({ type, name }: Light) => type === "directional" && name === "Sun";
