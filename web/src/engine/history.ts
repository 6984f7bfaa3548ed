/** Undo and redo of what a hand has changed: lights, camera, settings. */

import type { LightAnimation } from "../animation/animation.js";
import type { Player } from "../animation/player.js";
import type { RebounceViewer } from "../rebounce-viewer.js";

/** Attributes that are settings. */
const SETTINGS = ["exposure", "auto-exposure", "tone-mapping", "mode", "overlay", "display"];
/** Steps that are kept. */
const MOST = 100;
/** Events by which a control of the panel changes something. */
const CONTROLS = ["keydown", "click", "dblclick", "input", "change"];

/** Camera, lights and nodes as JSON, attributes as they are, animations by reference: equal values are the same. */
type State = Record<string, string | null | LightAnimation[]>;
/** What has changed, before and after. */
type Step = Record<string, [before: State[string], after: State[string]]>;

/**
 * The steps of one element. A step is what changes from the beginning to the end of a gesture, or while one event of a
 * control is handled; what scripts and animations change in between is no part of it.
 */
export class History {
  #element: RebounceViewer;
  #player: Player;
  #changed: () => void;
  #steps: Step[] = [];
  /** Steps that are done: those after it are undone. */
  #done = 0;
  /** The state when the present gesture began. */
  #before: State | undefined;
  /** The control whose further changes belong to the last step. */
  #control: EventTarget | null = null;

  /** `changed` is called when there is something else to undo or redo. */
  constructor(element: RebounceViewer, root: ShadowRoot, player: Player, changed: () => void) {
    root.addEventListener("keydown", (event) => this.#key(event as KeyboardEvent));
    this.#element = element;
    this.#player = player;
    this.#changed = changed;
  }

  /** Names of what `undo` and `redo` would change; empty where they would do nothing. */
  get undoes(): string[] {
    return Object.keys(this.#steps[this.#done - 1] ?? {});
  }
  get redoes(): string[] {
    return Object.keys(this.#steps[this.#done] ?? {});
  }

  /** Nothing is left to undo or redo. */
  clear(): void {
    this.#steps = [];
    this.#done = 0;
    this.#before = undefined;
    this.#changed();
  }

  /** A gesture begins or ends. */
  gesture(began: boolean): void {
    if (began) this.#before ??= this.#state();
    // Lights that play meanwhile are the animation's.
    else this.#record(null, false, !this.#player.paused);
  }

  /** Work of a hand that no event of a control does. */
  by(work: () => void): void {
    this.gesture(true);
    try {
      work();
    } finally {
      this.#record();
    }
  }

  /** Takes each event of controls as a gesture: `input` upon `input` of one control is one step, until its `change`. */
  watch(controls: HTMLElement): void {
    for (const type of CONTROLS) {
      controls.addEventListener(type, () => this.gesture(true), true);
      controls.addEventListener(type, (event) => {
        // Where an animation stands is no state of the scene.
        if ((event.target as Element).closest(".play")) this.#before = undefined;
        this.#record(event.target, type === "input" || type === "change" || (event as KeyboardEvent).repeat);
        if (type === "change") this.#control = null;
      });
    }
  }

  /** Takes the last step back; whether there is one. */
  undo(): boolean {
    this.#record();
    return this.#go(this.#done - 1, this.#done - 1, 0);
  }

  /** Does the last step that was taken back once more; whether there is one. */
  redo(): boolean {
    this.#record();
    return this.#go(this.#done, this.#done + 1, 1);
  }

  /** Ctrl+Z, Ctrl+Shift+Z and Ctrl+Y, or with Command, but in a field of text. */
  #key(event: KeyboardEvent): void {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    if ((event.target as Element).matches("input:is([type=text],[type=number])")) return;
    const key = event.key.toLowerCase();
    if (key === "y" || (key === "z" && event.shiftKey)) this.redo();
    else if (key === "z") this.undo();
    else return;
    event.preventDefault();
  }

  #go(at: number, done: number, side: 0 | 1): boolean {
    const step = this.#steps[at];
    if (!step || !this.#element.loaded) return false;
    this.#done = done;
    this.#control = null;
    for (const [name, values] of Object.entries(step)) this.#set(name, values[side]);
    // The event that asked for it is no step.
    this.#before = undefined;
    this.#changed();
    return true;
  }

  #state(): State {
    const { camera, lights, mix, nodes } = this.#element;
    const settings = SETTINGS.map((name) => [name, this.#element.getAttribute(name)]);
    return {
      lights: JSON.stringify(lights),
      mix: JSON.stringify(mix),
      nodes: JSON.stringify(nodes),
      animations: this.#player.animations,
      camera: JSON.stringify(camera),
      ...(Object.fromEntries(settings) as State),
    };
  }

  #set(name: string, value: State[string]): void {
    const element = this.#element;
    if (name === "animations") this.#player.animations = value as LightAnimation[];
    else if (["lights", "camera", "mix", "nodes"].includes(name)) Object.assign(element, { [name]: JSON.parse(value as string) });
    else if (value === null) element.removeAttribute(name);
    else element.setAttribute(name, value as string);
  }

  /** Ends a gesture. With `more` what the same control did before is one step with it; with `playing` lights do not count. */
  #record(control: EventTarget | null = null, more = false, playing = false): void {
    const before = this.#before;
    this.#before = undefined;
    if (!before || !this.#element.loaded) return;
    const after = this.#state();
    const step: Step = {};
    for (const name of Object.keys(before)) {
      if (before[name] === after[name] || (playing && ["lights", "nodes"].includes(name))) continue;
      step[name] = [before[name] as State[string], after[name] as State[string]];
    }
    if (Object.keys(step).length === 0) return;
    const last = more && control === this.#control ? this.#steps[this.#done - 1] : undefined;
    if (last) for (const [name, [from, to]] of Object.entries(step)) last[name] = [(last[name] ?? [from])[0], to];
    else {
      this.#steps.splice(this.#done, Infinity, step);
      this.#done = this.#steps.length;
      if (this.#done > MOST) this.#steps.splice(0, this.#done-- - MOST);
    }
    this.#control = control;
    this.#changed();
  }
}
