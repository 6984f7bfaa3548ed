/** Plays one animation of lights at a time. */

import { agrees, lightsAt, valueAt, type LightAnimation } from "./animation.js";
import type { Light } from "../wire/shot.js";

/** The longest step between two frames that is believed, seconds: after a pause of the page nothing jumps. */
const LONGEST = 0.5;

/** How to play. */
export interface PlayOptions {
  /** Which animation; the present one when absent. */
  name?: string;
  /** How many times; without end when absent. */
  repetitions?: number;
}

/** Nodes that an animation moves. */
export interface AnimatedNodes {
  /** Puts the nodes where an animation has them; `value` is that of a track at the moment. */
  play(animation: LightAnimation, value: (track: LightAnimation["tracks"][number]) => number[]): void;
  /** Where the nodes of an animation are, as text. */
  state(animation: LightAnimation): string;
}

/** What the player needs of the element. */
export interface PlayerHost {
  /** Reads or writes the lights; nothing while no scene is loaded. */
  readLights(): Light[] | undefined;
  writeLights(lights: Light[]): void;
  /** Nodes that may move, where the scene has some. */
  moving(): AnimatedNodes | undefined;
  /** The name of the wanted animation. */
  animationName(): string;
  tell(type: "play" | "pause" | "finished", detail: { name: string }): void;
  wantFrame(): void;
}

/** Where the playing stands. */
export class Player {
  animations: LightAnimation[] = [];
  paused = true;
  #host: PlayerHost;
  #time = 0;
  /** Times still to play, this one included. */
  #left = Infinity;
  #lastMs: number | undefined;
  /** The lights as this player left them, and the nodes. */
  #written: Light[] | undefined;
  #nodes: string | undefined;

  constructor(host: PlayerHost) {
    this.#host = host;
  }

  /** The animation that is or would be played: the one of the wanted name, or the first. */
  get current(): LightAnimation | undefined {
    const wanted = this.#host.animationName();
    return this.animations.find(({ name }) => name === wanted) ?? this.animations[0];
  }

  /** Seconds; 0 where there is nothing to play. */
  get duration(): number {
    return this.current?.duration ?? 0;
  }

  /** Seconds from the animation's start. */
  get time(): number {
    return this.#time;
  }
  set time(seconds: number) {
    this.#time = Math.min(Math.max(Number(seconds) || 0, 0), this.duration);
    this.#write();
  }

  /** Replaces the animations, and begins at the start. */
  set(animations: LightAnimation[]): void {
    this.pause();
    this.animations = animations;
    this.rewind();
  }

  /** The start, without touching the lights; another animation has been chosen, for instance. */
  rewind(): void {
    this.#time = 0;
    this.#written = undefined;
  }

  /** Plays from where it stands, or from the start after the end. */
  play(repetitions = Infinity): void {
    const animation = this.current;
    if (!animation || this.#host.readLights() === undefined) return;
    if (this.#time >= animation.duration) this.#time = 0;
    this.#left = repetitions >= 1 ? Math.floor(repetitions) : 1;
    this.#lastMs = this.#written = undefined;
    this.paused = false;
    this.#host.tell("play", { name: animation.name });
    this.#host.wantFrame();
  }

  /** Stops where it stands. */
  pause(): void {
    this.#stop("pause");
  }

  #stop(type: "pause" | "finished"): void {
    if (this.paused) return;
    this.paused = true;
    this.#host.tell(type, { name: this.current?.name ?? "" });
  }

  /** Sets the lights of the moment `nowMs`, milliseconds. A hand on what is animated pauses it. */
  advance(nowMs: number): void {
    const animation = this.current;
    if (this.paused) return;
    if (!animation || this.#touched(animation)) return this.pause();
    const passed = this.#lastMs === undefined ? 0 : Math.min(Math.max((nowMs - this.#lastMs) / 1000, 0), LONGEST);
    this.#lastMs = nowMs;
    this.#time += passed;
    if (animation.duration > 0) {
      const over = Math.min(Math.floor(this.#time / animation.duration), this.#left - 1);
      this.#time -= over * animation.duration;
      this.#left -= over;
    }
    const ends = this.#time >= animation.duration;
    if (ends) this.#time = animation.duration;
    this.#write();
    if (ends) this.#stop("finished");
  }

  #touched(animation: LightAnimation): boolean {
    const now = this.#host.readLights();
    return this.#written !== undefined && (this.#nodes !== this.#host.moving()?.state(animation) || !agrees(animation, now ?? [], this.#written));
  }

  #write(): void {
    const lights = this.#host.readLights();
    const animation = this.current;
    if (!lights || !animation) return;
    this.#host.writeLights(lightsAt(lights, animation, this.#time));
    this.#written = this.#host.readLights();
    this.#host.moving()?.play(animation, (track) => valueAt(track, this.#time));
    this.#nodes = this.#host.moving()?.state(animation);
  }
}
