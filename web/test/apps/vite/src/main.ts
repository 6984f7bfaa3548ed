import "rebounce-viewer";
import type { Light, PointLight } from "rebounce-viewer";

const viewer = document.createElement("rebounce-viewer");
viewer.src = "scene.rbn";
viewer.alt = "A box with a red and a green wall";

viewer.addEventListener("load", (event) => {
  const address: string = event.detail.url;
  const lamp: PointLight = { type: "point", position: [0, 4, -2.8], intensity: 40, color: [1, 0.8, 0.6] };
  const lights: Light[] = [...viewer.lights, lamp];
  viewer.lights = lights;
  document.title = address;
});

export function mistakes(): void {
  // @ts-expect-error: there is no such mode
  viewer.mode = "bright";
  // @ts-expect-error: a light has a type
  viewer.lights = [{ position: [0, 0, 0], intensity: 1 }];
}

document.body.append(viewer);
