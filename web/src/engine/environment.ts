/** The environment of one element: the picture of its `environment` attribute, and the light that shows it. */

import type { Picture } from "../environment/hdr.js";
import { Failure, failureOf } from "../wire/failure.js";
import type { EnvironmentLight, Light } from "../wire/light-kinds.js";
import { lightsIn, setLights } from "../wire/wire.js";
import type { Viewer } from "./module.js";

/** What the environment works with. */
export interface EnvironmentHost {
  readonly element: { readonly environment: string; readonly environmentRotation: number; readonly environmentIntensity: number } & Element;
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
  /** The attribute has brought the light. */
  #added = false;

  constructor(host: EnvironmentHost) {
    this.#host = host;
  }

  /** The attribute has changed. Never rejects. */
  async change(): Promise<void> {
    this.#loading?.abort();
    const { signal } = (this.#loading = new AbortController());
    const url = this.#host.element.environment;
    let picture: Picture | undefined;
    try {
      if (url) {
        const { fetchPicture } = await import("../environment/hdr.js").catch((cause: unknown) => {
          throw new Failure("network", "The reader of environments could not be loaded; check the connection and reload.", { cause });
        });
        picture = await fetchPicture(url, signal);
      }
    } catch (error) {
      if (!signal.aborted) this.#host.warn(failureOf(error));
      return;
    }
    if (signal.aborted) return;
    this.#picture = picture;
    this.#host.withViewer((viewer) => {
      if (!picture) this.#takeBack(viewer);
      this.show(viewer);
    });
    this.#host.changed();
  }

  /** A scene has come: shows the picture, and adds a light where no light shows it. */
  show(viewer: Viewer): void {
    const { element } = this.#host;
    const picture = this.#picture;
    if (picture) viewer.setEnvironment(picture.width, picture.scale, picture.texels);
    if (picture && !lightsIn(viewer).some(isEnvironment)) {
      setLights(viewer, [...lightsIn(viewer), { type: "environment", intensity: 1 }]);
      this.#added = true;
    }
    if (element.hasAttribute("environment-rotation")) this.turn(viewer);
    if (element.hasAttribute("environment-intensity")) this.dim(viewer);
  }

  /** Turns the light as its attribute says. */
  turn(viewer: Viewer): void {
    this.#set(viewer, { rotation_deg: this.#host.element.environmentRotation });
  }

  /** Dims the light as its attribute says. */
  dim(viewer: Viewer): void {
    this.#set(viewer, { intensity: this.#host.element.environmentIntensity });
  }

  #set(viewer: Viewer, members: Partial<EnvironmentLight>): void {
    const lights = lightsIn(viewer);
    if (lights.some(isEnvironment)) setLights(viewer, lights.map((light) => (isEnvironment(light) ? { ...light, ...members } : light)));
  }

  /** The file's own picture is back, and the light that was added goes. */
  #takeBack(viewer: Viewer): void {
    viewer.setEnvironment(0, 1, new Uint32Array());
    if (this.#added) setLights(viewer, lightsIn(viewer).filter((light) => !isEnvironment(light)));
    this.#added = false;
  }
}

const isEnvironment = (light: Light): light is EnvironmentLight => light.type === "environment";
