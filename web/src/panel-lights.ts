/** The panel's list of lights: add, remove, switch, colour, move, by pointer or by keys alone. */

import { make } from "./element.js";
import { failureOf, sentence } from "./failure.js";
import { hexColor, linearColor, newLight, stepped } from "./lights.js";
import type { Section } from "./panel.js";
import type { RebounceViewer } from "./rebounce-viewer.js";
import type { Light, Triple } from "./shot.js";

const HINT =
  "Arrow keys move a chosen light over the ground, Page Up and Page Down lift and lower it; with Shift, farther.";
/** Members that are numbers: their words and the largest value. */
const NUMBERS: Record<string, readonly [string, string]> = {
  intensity: ["Intensity", ""],
  outer_cone_deg: ["Cone, degrees", "90"],
  inner_cone_deg: ["Full cone, degrees", "90"],
};
const VECTORS: Record<string, string> = { position: "Position", direction: "Direction" };

/** A light's members by name. */
type Members = Record<string, number | Triple | string>;

/** An entry of the list. */
interface Entry {
  item: HTMLLIElement;
  button: HTMLButtonElement;
  lamp: HTMLInputElement;
}

/** The list, and the fields of the chosen light. */
export class LightList implements Section {
  readonly element: HTMLElement;
  #host: RebounceViewer;
  #say: (text: string) => void;
  #list = make("ul", { class: "lights" });
  #fields = make("div", { class: "fields", id: "fields" });
  #add = (["point", "spot", "directional"] as const).map((type) => this.#button(`Add ${type}`, () => this.#new(type)));
  #entries: Entry[] = [];
  /** Sets the fields to a light's values. */
  #follow: ((light: Light) => void)[] = [];
  #chosen = -1;
  #kinds = "";
  /** Intensities of lights that are switched off, by place. */
  #kept: (number | undefined)[] = [];

  constructor(host: RebounceViewer, say: (text: string) => void) {
    this.#host = host;
    this.#say = say;
    const adding = make("div", { class: "state" }, ...this.#add);
    this.element = make("div", { class: "stack" }, this.#list, adding, make("p", { class: "hint", id: "hint" }, HINT));
  }

  /** Follows the lights; a field that is being typed in is left alone. */
  update(): void {
    const { lights } = this.#host;
    const kinds = lights.map(({ type }) => type).join();
    if (kinds !== this.#kinds) this.#rebuild(lights, kinds);
    lights.forEach((light, i) => {
      const { button, lamp } = this.#entries[i] as Entry;
      button.style.setProperty("--lamp", hexColor(light.color));
      lamp.checked = light.intensity > 0;
      if (lamp.checked) this.#kept[i] = undefined;
    });
    const light = lights[this.#chosen];
    if (light) for (const follow of this.#follow) follow(light);
  }

  #rebuild(lights: Light[], kinds: string): void {
    const focused = this.#entries.findIndex(({ button }) => button.matches(":focus"));
    this.#kinds = kinds;
    this.#kept.length = lights.length;
    this.#entries = lights.map(({ type, name: own }, i) => {
      const name = own || `Light ${i + 1}`;
      const button = make("button", { type: "button", class: "entry", "aria-describedby": "hint" }, `${name}, ${type}`);
      const lamp = make("input", { type: "checkbox", role: "switch", "aria-label": `${name} on` });
      button.addEventListener("click", () => this.#choose(this.#chosen === i ? -1 : i));
      button.addEventListener("keydown", (event) => this.#key(event, i));
      lamp.addEventListener("change", () => this.#switch(i, lamp.checked));
      return { item: make("li", {}, make("div", { class: "row" }, button, lamp)), button, lamp };
    });
    this.#list.replaceChildren(...this.#entries.map(({ item }) => item));
    this.#choose(this.#chosen < lights.length ? this.#chosen : -1);
    this.#entries[focused]?.button.focus();
  }

  /** Shows the fields of a light under its entry; of none with -1. */
  #choose(index: number): void {
    this.#chosen = index;
    this.#entries.forEach(({ button }, i) => button.setAttribute("aria-expanded", String(i === index)));
    this.#follow = [];
    this.#fields.remove();
    const light = this.#host.lights[index];
    if (!light) return;
    this.#fields.replaceChildren(...this.#fieldsOf(light), this.#button(`Remove light ${index + 1}`, () => this.#remove(index)));
    (this.#entries[index] as Entry).item.append(this.#fields);
    for (const follow of this.#follow) follow(light);
  }

  #fieldsOf(light: Light): Node[] {
    const color = make("input", { type: "color" });
    color.addEventListener("input", () => this.#set({ color: linearColor(color.value) }));
    this.#follow.push(({ color: now }) => idle(color) && (color.value = hexColor(now)));
    const fields: Node[] = [make("label", { class: "row" }, "Colour", color)];
    for (const [name, [words, max]] of Object.entries(NUMBERS)) {
      if (!(name in light)) continue;
      const unit = name !== "intensity" ? "" : light.type === "directional" ? ", lux" : ", candela";
      const input = this.#number((value) => this.#set({ [name]: value }), (now) => now[name] as number, { min: "0", max });
      fields.push(make("label", { class: "row" }, words + unit, input));
    }
    for (const [name, words] of Object.entries(VECTORS)) {
      if (!(name in light)) continue;
      const axes = ["x", "y", "z"].map((axis, i) => {
        const value = (now: Members) => (now[name] as Triple)[i] as number;
        const set = (to: number) => {
          const now = [...(this.#now()[name] as Triple)];
          now[i] = to;
          this.#set({ [name]: now as Triple });
        };
        return make("label", {}, axis, this.#number(set, value, { step: "0.1" }));
      });
      fields.push(make("fieldset", {}, make("legend", {}, words), make("div", { class: "axes" }, ...axes)));
    }
    return fields;
  }

  #number(set: (value: number) => void, get: (light: Members) => number, limits: Record<string, string>): HTMLInputElement {
    const input = make("input", { type: "number", step: "1", ...limits });
    input.addEventListener("input", () => {
      if (Number.isFinite(input.valueAsNumber) && !input.validity.rangeUnderflow) set(input.valueAsNumber);
    });
    this.#follow.push((light) => {
      if (idle(input)) input.value = String(Number(get(light as unknown as Members).toFixed(3)));
    });
    return input;
  }

  #now(): Members {
    return this.#host.lights[this.#chosen] as unknown as Members;
  }

  /** Changes members of the chosen light. */
  #set(members: Members): void {
    this.#replace(this.#chosen, (light) => ({ ...light, ...members }) as Light);
  }

  #replace(index: number, work: (light: Light) => Light): void {
    this.#try(() => {
      this.#host.lights = this.#host.lights.map((light, i) => (i === index ? work(light) : light));
    });
  }

  #switch(index: number, on: boolean): void {
    const before = this.#host.lights[index]?.intensity ?? 0;
    if (!on) this.#kept[index] = before;
    this.#replace(index, (light) => ({ ...light, intensity: on ? (this.#kept[index] ?? 10) : 0 }));
  }

  #key(event: KeyboardEvent, index: number): void {
    const { lights, camera } = this.#host;
    const light = lights[index];
    if (!light || !camera || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "Delete") return this.#remove(index);
    const moved = stepped(light, camera, event.key, event.shiftKey);
    if (!moved) return;
    event.preventDefault();
    this.#replace(index, () => moved);
    const at = "position" in moved ? moved.position : moved.direction;
    this.#say(`Light ${index + 1}: ${at.map((x) => x.toFixed(2)).join(", ")}`);
  }

  #new(type: Light["type"]): void {
    const { camera } = this.#host;
    if (!camera) return;
    this.#try(() => {
      const index = this.#host.addLight(newLight(type, camera));
      this.#chosen = index;
      this.update();
      this.#entries[index]?.button.focus();
      this.#say(`Light ${index + 1} is added.`);
    });
  }

  #remove(index: number): void {
    this.#try(() => {
      this.#host.removeLight(index);
      this.#kept.splice(index, 1);
      this.#kinds = "?";
      this.#chosen = -1;
      this.update();
      (this.#entries[Math.min(index, this.#entries.length - 1)]?.button ?? this.#add[0])?.focus();
      this.#say(`Light ${index + 1} is removed.`);
    });
  }

  /** What the viewer refuses is said. */
  #try(work: () => void): void {
    try {
      work();
    } catch (error) {
      this.#say(sentence(failureOf(error).message));
    }
  }

  #button(text: string, work: () => void): HTMLButtonElement {
    const button = make("button", { type: "button" }, text);
    button.addEventListener("click", work);
    return button;
  }
}

/** Whether nobody is typing in a field. */
const idle = (input: HTMLInputElement) => !input.matches(":focus");
