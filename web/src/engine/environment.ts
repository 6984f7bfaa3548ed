/** The environment of one element: the picture of its `environment` or `sky`, and the lights that show it. */

import type { PictureLights } from "../environment/lights.js";
import type { Picture } from "../environment/picture.js";
import { type Failure, failureOf, wanted } from "../wire/failure.js";
import type { EnvironmentLight } from "../wire/light-kinds.js";
import { lightsIn, setLights } from "../wire/wire.js";
import type { Viewer } from "./module.js";

/** What the environment works with. */
export interface EnvironmentHost {
  readonly element: { readonly environment: string; readonly environmentRotation: number; readonly environmentIntensity: number; readonly sky: string } & Element;
  /** Works with the viewer where there is a scene; what the viewer refuses is told. */
  withViewer(work: (viewer: Viewer) => void): void;
  /** A failure that leaves the picture as it is. */
  warn(failure: Failure): void;
  /** The picture is there, or gone. */
  changed(): void;
}

/** The picture, and its way to the viewer. */
export class Environment {
  #host: EnvironmentHost;
  #picture: Picture | undefined;
  #loading: AbortController | undefined;
  /** The picture that the viewer has been given, and that viewer. */
  #given: Picture | undefined;
  #viewer: Viewer | undefined;
  /** What the pictures have done to the lights; there once there was a picture. */
  #lights: PictureLights | undefined;

  constructor(host: EnvironmentHost) {
    this.#host = host;
  }

  /** An attribute has changed. Never rejects. */
  async change(): Promise<void> {
    this.#loading?.abort();
    const { signal } = (this.#loading = new AbortController());
    const { environment: url, sky } = this.#host.element;
    let picture: Picture | undefined;
    try {
      if (sky || url) {
        // Both have what is used of them.
        const module = (sky ? import("../environment/sky.js") : import("../environment/download.js")) as Promise<typeof import("../environment/download.js")>;
        const { picture: pictureOf, PictureLights } = await wanted(module, "reader of environments");
        picture = await pictureOf(sky || url, signal);
        this.#lights ??= new PictureLights();
      }
    } catch (error) {
      if (!signal.aborted) this.#host.warn(failureOf(error));
      return;
    }
    if (signal.aborted) return;
    this.#picture = picture;
    this.#host.withViewer((viewer) => this.show(viewer));
    this.#host.changed();
  }

  /** Shows the picture; lights may be those of a new scene. */
  show(viewer: Viewer, isNew = false): void {
    const { element } = this.#host;
    if (isNew) this.#lights?.forget();
    const before = lightsIn(viewer);
    this.#light(viewer, {
      ...(element.hasAttribute("environment-rotation") && { rotation_deg: element.environmentRotation }),
      ...(element.hasAttribute("environment-intensity") && { intensity: element.environmentIntensity }),
    });
    const picture = this.#picture;
    if (picture === (this.#viewer === viewer ? this.#given : undefined)) return;
    // Without texels, the file's own is back.
    const { width, scale, texels } = picture ?? { width: 0, scale: 1, texels: new Uint32Array() };
    try {
      viewer.setEnvironment(width, scale, texels);
    } catch (error) {
      setLights(viewer, before);
      throw error;
    }
    [this.#viewer, this.#given] = [viewer, picture];
  }

  /** Turns the light as its attribute says. */
  turn(viewer: Viewer): void {
    this.#light(viewer, { rotation_deg: this.#host.element.environmentRotation });
  }

  /** Dims the light as its attribute says. */
  dim(viewer: Viewer): void {
    this.#light(viewer, { intensity: this.#host.element.environmentIntensity });
  }

  /** Sets members of the environment's light, and what else the picture needs. */
  #light(viewer: Viewer, members: Partial<EnvironmentLight>): void {
    const before = lightsIn(viewer);
    const named = before.map((light) => (light.type === "environment" ? { ...light, ...members } : light));
    const lights = this.#lights?.of(named, this.#picture, members) ?? named;
    if (JSON.stringify(lights) !== JSON.stringify(before)) setLights(viewer, lights);
  }
}
