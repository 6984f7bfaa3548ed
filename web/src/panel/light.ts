/** The fields of one light: name, intensity, colour, cone, size, place, the way it shines. */

import { make } from "../element/element.js";
import { type Field, KINDS } from "../wire/light-kinds.js";
import { hexColor, linearColor, type Members } from "../wire/lights.js";
import { button, slider } from "./parts.js";
import { colorKelvin, compass, KELVIN, kelvinColor, perIntensity, sunAngles, sunDirection } from "./photometry.js";
import type { Light, Triple } from "../wire/shot.js";

/** What the fields of a light work with. */
export interface LightDesk {
  /** The light now. */
  now(): Light;
  /** Changes members of it. */
  set(members: Members): void;
  /** What it is called where it has no name. */
  called: string;
  /** Points it at what the camera looks at. */
  aim(): void;
  /** Has the next click in the picture point it at what is there. */
  pick(): void;
}

/** Units that were chosen, by the kind of light. */
const chosen: Record<string, string> = {};

/** Digits of a number in a field. */
const short = (value: number) => String(Number(value.toPrecision(5)));
/** Whether nobody is typing in a field. */
const idle = (input: HTMLInputElement) => !input.matches(":focus");

/** The fields of a light, and how they follow it. */
export class LightFields {
  readonly nodes: Node[] = [];
  #desk: LightDesk;
  #follow: ((light: Light) => void)[] = [];

  constructor(desk: LightDesk) {
    this.#desk = desk;
    const light = desk.now();
    // Shining surfaces are found by the name.
    if (light.type !== "emissive") this.#name();
    this.#intensity(light);
    this.#color();
    const { fields } = KINDS[light.type];
    // Which surfaces shine is no choice.
    const others = fields.filter(({ name, width }) => width === 1 && name !== "intensity" && name !== "group");
    for (const field of others) this.#figure(field);
    const isPlaced = "position" in light;
    for (const field of fields) {
      if (field.name === "direction" && !isPlaced) this.#sun();
      else if (field.width === 3 && field.name !== "color") this.#vector(field);
    }
    this.follow(light);
  }

  /** Shows a light; a field that is being typed in is left alone. */
  follow(light: Light): void {
    for (const follow of this.#follow) follow(light);
  }

  #name(): void {
    const input = make("input", { type: "text", class: "name", placeholder: this.#desk.called, maxlength: "80" });
    input.addEventListener("input", () => this.#desk.set({ name: input.value.trim() || undefined }));
    this.#follow.push((light) => idle(input) && (input.value = light.name ?? ""));
    this.nodes.push(make("label", { class: "row" }, "Name", input));
  }

  #intensity(light: Light): void {
    const { set, now } = this.#desk;
    const unit = make("select", { "aria-label": "Unit" }, ...KINDS[light.type].units.map((name) => make("option", {}, name)));
    unit.value = chosen[light.type] ?? unit.value;
    const factor = () => perIntensity(now(), unit.value);
    const number = this.#number("Intensity, in the unit", (value) => set({ intensity: value / factor() }), ({ intensity }) => intensity * factor());
    unit.addEventListener("change", () => {
      chosen[light.type] = unit.value;
      this.follow(now());
    });
    const units = unit.length > 1 ? unit : make("span", {}, unit.value);
    this.nodes.push(make("div", { class: "row units" }, number, units));
  }

  #color(): void {
    const { set } = this.#desk;
    const color = make("input", { type: "color" });
    color.addEventListener("input", () => set({ color: linearColor(color.value) }));
    const bar = slider("Colour temperature", KELVIN, (kelvin) => set({ color: kelvinColor(kelvin) }));
    this.#follow.push(({ color: now }) => {
      if (idle(color)) color.value = hexColor(now);
      const kelvin = colorKelvin(now);
      bar.show(kelvin ?? 6500, kelvin ? `${kelvin} K` : "not a white");
    });
    this.nodes.push(make("label", { class: "row" }, "Colour", color), bar.element);
  }

  /** Where the sun stands. Straight above, its azimuth is the one before. */
  #sun(): void {
    const { set, now } = this.#desk;
    let [azimuth, elevation] = [0, 0];
    const read = ({ direction }: Light & { direction: Triple }) => {
      const [a, e] = sunAngles(direction);
      elevation = e;
      if (Math.abs(e) < 89.9) azimuth = a;
    };
    const turn = (a: number, e: number) => {
      azimuth = a;
      set({ direction: sunDirection(a, e) });
    };
    const sun = () => now() as Light & { direction: Triple };
    const from = slider("Azimuth", { min: 0, max: 360, step: 1 }, (value) => (read(sun()), turn(value, elevation)));
    const height = slider("Elevation", { min: -90, max: 90, step: 1 }, (value) => (read(sun()), turn(azimuth, value)));
    this.#follow.push((light) => {
      read(light as Light & { direction: Triple });
      from.show(azimuth, `${azimuth.toFixed(0)}° ${compass(azimuth)}`);
      height.show(elevation, `${elevation.toFixed(0)}°`);
    });
    this.nodes.push(from.element, height.element);
  }

  #figure({ name, row, absent, max }: Field): void {
    const get = (light: Light) => ((light as unknown as Members)[name] ?? absent) as number;
    if (Number.isNaN(get(this.#desk.now()))) return;
    const input = this.#number(row, (value) => this.#desk.set({ [name]: value }), get, { max: `${max ?? ""}`, min: name === "rotation_deg" ? "" : "0" });
    this.nodes.push(make("div", { class: "row" }, make("span", { "aria-hidden": "true" }, row), input));
  }

  /** A place or a direction, which has buttons besides. */
  #vector({ name, row }: Field): void {
    if (name === "direction") {
      const pick = button("Aim", () => this.#desk.pick(), { title: "The next click in the picture is where it shines" });
      const ahead = button("Aim where the camera looks", () => this.#desk.aim());
      this.nodes.push(make("div", { class: "buttons" }, pick, ahead));
    }
    const get = (light: Light) => ((light as unknown as Members)[name] ?? [0, 0, 0]) as Triple;
    const axes = ["x", "y", "z"].map((axis, i) => {
      const set = (value: number) => {
        const now = [...get(this.#desk.now())] as Triple;
        now[i] = value;
        this.#desk.set({ [name]: now });
      };
      const input = this.#number(axis, set, (light) => get(light)[i] as number, { step: "0.1", min: "" });
      return make("div", {}, make("span", { "aria-hidden": "true" }, axis), input);
    });
    this.nodes.push(make("fieldset", {}, make("legend", {}, row), make("div", { class: "axes" }, ...axes)));
  }

  #number(label: string, set: (value: number) => void, get: (light: Light) => number, limits: Record<string, string> = {}): HTMLInputElement {
    const input = make("input", { type: "number", step: "any", min: "0", "aria-label": label, ...limits });
    input.addEventListener("input", () => {
      if (Number.isFinite(input.valueAsNumber) && !input.validity.rangeUnderflow) set(input.valueAsNumber);
    });
    this.#follow.push((light) => idle(input) && (input.value = short(get(light))));
    return input;
  }
}
