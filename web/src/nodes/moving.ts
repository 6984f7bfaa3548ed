/** What the renderer of all files has beside the other one: nodes that move, and a choice of what computes bounced light. */

import type { LightAnimation } from "../animation/animation.js";
import type { AnimatedNodes } from "../animation/player.js";
import type { RebounceEventMap } from "../element/events.js";
import type { Viewer } from "../rebounce_radiosity.js";
import type { NodeMove, Nodes } from "../wire/shot.js";
import { motionsOf, movesIn, nodesOf } from "./nodes.js";

/** The part of a viewer that is about nodes. */
export class Moving implements AnimatedNodes {
  #viewer: Viewer;
  /** What was told last. */
  #motions = "";
  #solver = "";

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
  }

  get nodes(): Nodes {
    return nodesOf(this.#viewer);
  }

  /** The present motions, as a shot has them; nothing where nothing has moved. */
  get moves(): Record<string, NodeMove> | undefined {
    const moves = movesIn(this.#viewer);
    return Object.keys(moves).length ? moves : undefined;
  }

  /** Checks a shot's `move`. Throws `bad-json`. */
  check(moves: Record<string, NodeMove>): void {
    motionsOf(this.#viewer, moves);
  }

  /** Moves the nodes of a shot; others go back to where the file has them. */
  move(moves: Record<string, NodeMove>): void {
    this.#viewer.setNodeMotions(motionsOf(this.#viewer, moves));
  }

  /** Where the nodes of an animation are, as text. */
  state({ tracks }: LightAnimation): string {
    const { nodes } = this;
    return JSON.stringify(tracks.map(({ node = "" }) => nodes[node]));
  }

  /** Puts the nodes where an animation has them; `value` is that of a track at the moment. */
  play({ tracks }: LightAnimation, value: (track: LightAnimation["tracks"][number]) => number[]): void {
    const { nodes } = this;
    for (const track of tracks) {
      if (track.property === "pose") this.#viewer.setPose(track.node, value(track)[0] as number);
      const node = nodes[track.node ?? ""];
      if (node && track.property !== "pose") Object.assign(node, { [track.property]: value(track) });
    }
  }

  /** Tells of nodes and of a solver that are no longer what they were. */
  look(target: EventTarget): void {
    const { solver } = this.#viewer;
    const motions = `motions ${this.#viewer.nodeMotions()}`;
    const moved = this.#motions !== "" && this.#motions !== motions;
    const changed = this.#solver !== "" && this.#solver !== solver;
    this.#motions = motions;
    this.#solver = solver;
    const tell = <K extends keyof RebounceEventMap>(type: K, detail: RebounceEventMap[K]["detail"]) => target.dispatchEvent(new CustomEvent(type, { detail }));
    if (moved) tell("node-change", { nodes: this.nodes });
    if (changed) tell("solver-change", { solver: solver as "operator" | "radiosity" });
  }
}
