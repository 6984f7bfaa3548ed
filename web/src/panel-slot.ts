/** Where the panel goes; its code is loaded when it is first wanted. */

import { Failure } from "./failure.js";
import type { Panel } from "./panel.js";
import type { RebounceViewer } from "./rebounce-viewer.js";
import type { Tree } from "./tree.js";

/** The panel, once there is one. */
export class PanelSlot {
  #element: RebounceViewer;
  #tree: Tree;
  #panel: Panel | undefined;

  constructor(element: RebounceViewer, tree: Tree) {
    this.#element = element;
    this.#tree = tree;
  }

  #wanted = () => this.#element.controls && this.#element.loaded;

  /** Shows the panel where it is wanted and there is a scene, and hides it elsewhere. Rejects with a `Failure`. */
  async show(): Promise<void> {
    if (this.#wanted() && !this.#panel) {
      const { Panel } = await import("./panel.js").catch((cause: unknown) => {
        throw new Failure("network", "The panel could not be loaded; check the connection and reload.", { cause });
      });
      if (!this.#panel) this.#tree.add((this.#panel = new Panel(this.#element, this.#tree.root)).element);
    }
    if (this.#panel) this.#panel.element.hidden = !this.#wanted();
    this.update(true);
  }

  /** Follows the viewer; figures at once with `now`. */
  update(now = false): void {
    if (this.#panel && this.#wanted()) this.#panel.update(now);
  }
}
