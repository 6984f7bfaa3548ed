/** What the renderer of all files has beside the other one: nodes that move, and a choice of what computes bounced light. */

import type { LightAnimation } from "../animation/animation.js";
import type { AnimatedNodes } from "../animation/player.js";
import type { RebounceEventMap } from "../element/events.js";
import type { Viewer } from "../rebounce_radiosity.js";
import type { Nodes, Shot } from "../wire/shot.js";
import type { Solver } from "../wire/stats.js";
import { motionsOf, movesIn, nodesOf } from "./nodes.js";
import { poseOf, posesIn } from "./poses.js";

/** What of a shot moves: nodes, and what deforms. */
export type ShotMotion = Pick<Shot, "move" | "animation" | "time">;

/** The part of a viewer that is about nodes, and about what deforms. */
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

  /** The present motions and the pose, as a shot has them; without members where nothing has moved. */
  get shot(): ShotMotion {
    const move = movesIn(this.#viewer);
    const [place, time] = this.#viewer.pose();
    return { ...(Object.keys(move).length && { move }), ...(place !== undefined && { animation: posesIn(this.#viewer)[place] as string, time: time as number }) };
  }

  /** Checks what of a shot moves. Throws `bad-json`. */
  check({ move = {}, animation, time }: ShotMotion): void {
    motionsOf(this.#viewer, move);
    poseOf(this.#viewer, animation, time);
  }

  /** Moves and poses as a shot has it; what it does not name goes back to where the file has it. */
  move({ move = {}, animation, time }: ShotMotion): void {
    this.#viewer.setNodeMotions(motionsOf(this.#viewer, move));
    this.#viewer.setPose(...poseOf(this.#viewer, animation, time));
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
      if (track.property === "pose") this.#viewer.setPose(posesIn(this.#viewer).indexOf(track.node), value(track)[0] as number);
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
    if (changed) tell("solver-change", { solver: solver as Solver });
  }
}
