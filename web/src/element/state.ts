/** The element's state as a link, and back. */

import { LINK_SETTINGS, readState, stateHash } from "../wire/link.js";
import type { RebounceViewer } from "../rebounce-viewer.js";

/** Names in a link begin with the element's id, where it has one: a page may hold several. */
const prefix = ({ id }: Element) => (id && `${id}.`);

/** The page's address with the state in its hash. */
export function stateLink(element: RebounceViewer): string {
  const settings: Record<string, string> = {};
  for (const name of LINK_SETTINGS) settings[name] = element.getAttribute(name) ?? "";
  const { camera, lights, mix, shot } = element;
  const url = new URL(element.ownerDocument.URL);
  url.hash = stateHash({ ...(camera && { camera }), lights, mix, ...(shot?.move && { move: shot.move }), settings }, prefix(element));
  return url.href;
}

/** Takes over the state of a link; whether it holds one. Throws where it is damaged. */
export function restoreState(element: RebounceViewer, link: string): boolean {
  const state = readState(link.includes("#") ? link.slice(link.indexOf("#")) : "", prefix(element));
  if (!state) return false;
  if (state.camera) element.camera = state.camera;
  if (state.lights) Object.assign(element, { lights: state.lights, mix: state.mix ?? [] });
  const { nodes } = element;
  for (const name in nodes) Object.assign(nodes[name]!, { translation: [0, 0, 0], rotation: [0, 0, 0, 1], ...state.move[name] });
  for (const name of LINK_SETTINGS) {
    const value = state.settings[name];
    if (value) element.setAttribute(name, value);
    else element.removeAttribute(name);
  }
  return true;
}
