/** Where the panel goes; its code is loaded when it is first wanted. */

import { wanted } from "../wire/failure.js";
import type { Loan, Panel } from "./panel.js";
import type { Tree } from "../element/tree.js";

/** The panel, once there is one. */
export class PanelSlot {
  #loan: Loan;
  #tree: Tree;
  #panel: Panel | undefined;

  constructor(loan: Loan, tree: Tree) {
    this.#loan = loan;
    this.#tree = tree;
  }

  #wanted = () => this.#loan.host.controls && this.#loan.host.loaded;

  /** Shows the panel where it is wanted and there is a scene, and hides it elsewhere. Rejects with a `Failure`. */
  async show(): Promise<void> {
    if (this.#wanted() && !this.#panel) {
      const { Panel } = await wanted(import("./panel.js"), "panel");
      if (!this.#panel) this.#tree.add((this.#panel = new Panel(this.#loan)).element);
    }
    if (this.#panel) this.#panel.element.hidden = !this.#wanted();
    this.update(true);
  }

  /** Follows the viewer; figures at once with `now`. */
  update(now = false): void {
    if (this.#panel && this.#wanted()) this.#panel.update(now);
  }
}
