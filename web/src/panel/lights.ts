/** The panel's list of lights, a mixer: strength, solo, mute; add, remove, choose, move, by pointer or by keys alone. */

import { make } from "../element/element.js";
import { failureOf, sentence } from "../wire/failure.js";
import { KINDS } from "../wire/light-kinds.js";
import { hexColor, newLight, placeOf, stepped } from "../wire/lights.js";
import type { Desk, Section } from "./panel.js";
import { LightFields } from "./light.js";
import { button, signed, slider, type Slider } from "./parts.js";
import type { Channel, Light, Triple } from "../wire/shot.js";

const HINT =
  "Arrow keys move a chosen light over the ground, Page Up and Page Down lift and lower it; with Shift, farther.";
/** Differences in a picture of bytes that are none. */
const NOTHING = 2;

/** An entry of the list. */
interface Entry {
  item: HTMLLIElement;
  button: HTMLButtonElement;
  name: HTMLElement;
  lamp: HTMLInputElement;
  solo: HTMLButtonElement;
  fader: Slider;
}

/** Stops that a fader spans, up and down. */
const STOPS = 8;

/** The list, and the fields of the chosen light. */
export class LightList implements Section {
  readonly element: HTMLElement;
  #desk: Desk;
  #list = make("ul", { class: "lights" });
  #box = make("div", { class: "fields" });
  /** Of kinds of which a scene may have any number. */
  #add = Object.entries(KINDS)
    .filter(([, { lamp }]) => lamp)
    .map(([type, { called }]) => button(`Add ${called.toLowerCase()}`, () => this.#new(type as Light["type"])));
  #entries: Entry[] = [];
  #fields: LightFields | undefined;
  #chosen = -1;
  #kinds = "?";

  constructor(desk: Desk) {
    this.#desk = desk;
    const { host } = desk;
    const adding = make("div", { class: "buttons" }, ...this.#add);
    this.element = make("div", { class: "stack" }, this.#list, adding, make("p", { class: "hint", id: "hint" }, HINT));
    host.addEventListener("load", () => (this.#kinds = "?"));
    // What a hand in the picture is refused, for instance.
    host.addEventListener("error", ({ detail }) => desk.say(detail.message));
    host.addEventListener("light-hover", ({ detail }) => this.#mark(detail.light));
    host.addEventListener("light-select", ({ detail }) => this.#reveal(detail.light));
  }

  /** Follows the lights. */
  update(): void {
    const { lights, mix } = this.#desk.host;
    const kinds = lights.map(({ type }) => type).join();
    if (kinds !== this.#kinds) this.#rebuild(lights, kinds);
    lights.forEach((light, i) => {
      const { item, button, name, lamp, solo, fader } = this.#entries[i] as Entry;
      const { stops = 0, mute = false, solo: alone = false, color = light.color } = mix[i] ?? {};
      const called = this.#called(light, i);
      button.style.setProperty("--lamp", hexColor(color));
      name.textContent = called;
      lamp.ariaLabel = `${called} on`;
      lamp.checked = !mute;
      solo.ariaLabel = `${called} solo`;
      solo.ariaPressed = String(alone);
      fader.show(stops, `${signed(stops)} EV`, `${called} strength`);
      item.classList.toggle("silent", mute || (!alone && mix.some(({ solo }) => solo)));
    });
    const light = lights[this.#chosen];
    if (light) this.#fields?.follow(light);
  }

  #called(light: Light | undefined, i: number): string {
    return light?.name || `${KINDS[light?.type ?? "point"].called} ${i + 1}`;
  }

  #rebuild(lights: Light[], kinds: string): void {
    const focused = this.#entries.findIndex(({ button }) => button.matches(":focus"));
    this.#kinds = kinds;
    this.#entries = lights.map((light, i) => this.#entry(light, i));
    this.#list.replaceChildren(...this.#entries.map(({ item }) => item));
    this.#choose(this.#chosen < lights.length ? this.#chosen : -1);
    this.#entries[focused]?.button.focus();
  }

  #entry({ type }: Light, i: number): Entry {
    const name = make("span");
    const choose = button(name, () => this.#select(this.#chosen === i ? -1 : i), { class: "entry", "aria-describedby": "hint" });
    choose.append(" ", make("small", {}, KINDS[type].listed));
    choose.addEventListener("keydown", (event) => this.#key(event, i));
    choose.addEventListener("dblclick", () => this.#rename(i));
    const lamp = make("input", { type: "checkbox", role: "switch" });
    lamp.addEventListener("change", () => this.#mix(i, { mute: !lamp.checked }));
    const solo = button("S", () => this.#mix(i, { solo: !this.#desk.host.mix[i]?.solo }), { class: "solo", title: "Solo: this light alone" });
    const strength = (stops: number) => this.#mix(i, { stops });
    const fader = slider("", { min: -STOPS, max: STOPS, step: 0.1 }, strength, () => strength(0));
    fader.element.className = "fader";
    const item = make("li", {}, make("div", { class: "row" }, choose, solo, lamp), fader.element);
    const hover = (on: boolean) => () => this.#hover(on ? i : -1);
    for (const type of ["pointerenter", "focusin"]) item.addEventListener(type, hover(true));
    for (const type of ["pointerleave", "focusout"]) item.addEventListener(type, hover(false));
    return { item, button: choose, name, lamp, solo, fader };
  }

  /** A light under the pointer here shows in the picture. */
  #hover(index: number): void {
    this.#desk.host.hoveredLight = index;
    this.#mark(index);
  }

  #mark(index: number): void {
    this.#entries.forEach(({ item }, i) => item.classList.toggle("hovered", i === index));
  }

  /** A light that is chosen here is chosen in the picture. */
  #select(index: number): void {
    this.#choose(index);
    this.#desk.host.selectedLight = index;
  }

  /** A light that is chosen in the picture is chosen here, and its fields come into view; the page does not scroll. */
  #reveal(index: number): void {
    if (index === this.#chosen) return;
    this.#choose(index);
    const form = this.element.closest("form");
    const top = (element: Element) => element.getBoundingClientRect().top;
    const entry = this.#entries[index];
    if (form && entry) form.scrollTop += top(entry.item) - top(form);
  }

  /** Shows the fields of a light under its entry; of none with -1. */
  #choose(index: number): void {
    const { host } = this.#desk;
    this.#chosen = index;
    this.#entries.forEach(({ button }, i) => button.setAttribute("aria-expanded", String(i === index)));
    this.#fields = undefined;
    this.#box.remove();
    const light = host.lights[index];
    const entry = this.#entries[index];
    if (!light || !entry) return;
    const called = `${KINDS[light.type].called} ${index + 1}`;
    this.#fields = new LightFields({
      now: () => host.lights[index] as Light,
      set: (members) => this.#replace(index, (now) => ({ ...now, ...members }) as Light),
      called,
      aim: () => host.camera && this.#aim(index, host.camera.target),
      pick: () => this.#pick(index),
    });
    this.#box.replaceChildren(...this.#fields.nodes, button("Remove", () => this.#remove(index), { class: "remove" }));
    entry.item.append(this.#box);
  }

  #rename(index: number): void {
    if (this.#chosen !== index) this.#select(index);
    this.#box.querySelector<HTMLInputElement>(".name")?.select();
  }

  /** Whether the viewer takes the change. */
  #replace(index: number, work: (light: Light) => Light): boolean {
    const { host } = this.#desk;
    return this.#try(() => {
      host.lights = host.lights.map((light, i) => (i === index ? work(light) : light));
    });
  }

  /** Changes a light's channel. */
  #mix(index: number, members: Channel): void {
    const { host } = this.#desk;
    this.#try(() => {
      const mix = [...host.mix];
      while (mix.length <= index) mix.push({});
      mix[index] = { ...mix[index], ...members };
      host.mix = mix;
    });
  }

  /** Points a spot at a place. */
  #aim(index: number, at: Triple): void {
    this.#replace(index, (light) =>
      "position" in light && "direction" in light
        ? { ...light, direction: at.map((x, i) => x - (light.position[i] as number)) as Triple }
        : light,
    );
  }

  /** The next click in the picture is where a spot shines. */
  #pick(index: number): void {
    const { root, say, host, history, surfaceAt } = this.#desk;
    const canvas = root.querySelector("canvas") as HTMLCanvasElement;
    const done = new AbortController();
    const { signal } = done;
    signal.addEventListener("abort", () => (canvas.style.cursor = ""));
    canvas.style.cursor = "crosshair";
    canvas.focus();
    say(`Click or tap where ${this.#called(host.lights[index], index)} is to shine; Esc leaves it as it is.`, true);
    const key = (event: Event) => {
      if ((event as KeyboardEvent).key !== "Escape") return;
      event.stopPropagation();
      done.abort();
      say("");
    };
    root.addEventListener("keydown", key, { capture: true, signal });
    const click = (event: PointerEvent) => {
      event.stopImmediatePropagation();
      done.abort();
      const { left, top } = host.getBoundingClientRect();
      const at = surfaceAt(event.clientX - left, event.clientY - top);
      say(at ? "" : "Nothing is there to shine at.");
      if (at) history.by(() => this.#aim(index, at));
    };
    canvas.addEventListener("pointerdown", click, { capture: true, signal });
  }

  #key(event: KeyboardEvent, index: number): void {
    const { host, say } = this.#desk;
    const { lights, camera } = host;
    const light = lights[index];
    if (!light || !camera || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "Delete") return this.#remove(index);
    if (event.key === "F2") return this.#rename(index);
    const moved = stepped(light, camera, event.key, event.shiftKey);
    if (!moved) return;
    event.preventDefault();
    if (this.#replace(index, () => moved)) say(`${this.#called(light, index)}: ${placeOf(moved)?.map((x) => x.toFixed(2)).join(", ")}`);
  }

  #new(type: Light["type"]): void {
    const { host, say, sunlight } = this.#desk;
    const { camera, lights } = host;
    if (!camera) return;
    this.#try(() => {
      const light = newLight(type, camera, lights, () => [...sunlight()] as Triple);
      const before = !("position" in light) && host.readPixels(64, 36);
      const index = host.addLight(light);
      this.#chosen = index;
      this.update();
      this.#select(index);
      this.#entries[index]?.button.focus();
      const name = this.#called(light, index);
      say(`${name} is added.`);
      if (before) void this.#shines(before, name);
    });
  }

  /** Tells where a sun changes nothing in the picture. */
  async #shines(before: Promise<Uint8Array>, name: string): Promise<void> {
    const pictures = await Promise.all([before, this.#desk.host.readPixels(64, 36)]).catch(() => undefined);
    if (!pictures) return;
    const [old, now] = pictures;
    if (now.every((byte, i) => Math.abs(byte - (old[i] as number)) <= NOTHING)) {
      this.#desk.say(`${name} is added, but it reaches nothing in view: the room is closed on the side it shines from.`);
    }
  }

  #remove(index: number): void {
    const { host, say } = this.#desk;
    this.#try(() => {
      const name = this.#called(host.removeLight(index), index);
      this.#kinds = "?";
      this.#select(-1);
      this.update();
      (this.#entries[Math.min(index, this.#entries.length - 1)]?.button ?? this.#add[0])?.focus();
      say(`${name} is removed.`);
    });
  }

  /** What the viewer refuses is said; whether it refuses nothing. */
  #try(work: () => void): boolean {
    try {
      work();
      return true;
    } catch (error) {
      this.#desk.say(sentence(failureOf(error).message));
      return false;
    }
  }
}
