/** `rebounce view --watch`: whenever the server has a newer file, the element loads it; the view stays as it is. */

import type { RebounceViewer } from "../rebounce-viewer.js";

/** Milliseconds between two questions. */
const PAUSE = 500;

/** Follows the server's file. Camera, lights and settings are kept in the page's address meanwhile. */
export function watch(viewer: RebounceViewer): void {
  let shown = "";
  const keep = () => {
    if (viewer.loaded) history.replaceState(null, "", viewer.stateLink());
  };
  // The last word before the new file takes the old one's place.
  viewer.addEventListener("progress", ({ detail: { loaded, total } }) => {
    if (total && loaded === total) keep();
  });
  const look = async () => {
    try {
      const answer = await fetch("scene.version");
      const version = answer.ok ? await answer.text() : "";
      if (version && version !== shown) {
        keep();
        shown = version;
        viewer.setAttribute("src", `scene.rbn?version=${encodeURIComponent(version)}`);
      }
    } catch {
      // The server is gone, or not there again yet.
    }
    setTimeout(look, PAUSE);
  };
  void look();
}
