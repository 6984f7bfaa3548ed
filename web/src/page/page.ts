/** The page's liberties: `?src=other.rbn` shows another file than scene.rbn, and `?watch` the newest that there is. */

import { watch } from "./watch.js";

const query = new URLSearchParams(location.search);
const viewer = document.querySelector("rebounce-viewer");
const src = query.get("src");
if (viewer && query.has("watch")) {
  // Before the element is defined, so that it does not begin with a file that may not be there.
  viewer.removeAttribute("src");
  void customElements.whenDefined("rebounce-viewer").then(() => watch(viewer));
} else if (src) {
  viewer?.setAttribute("src", src);
}
