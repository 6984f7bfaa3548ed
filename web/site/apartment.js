// The apartment's page: the hour of the day sets the sun, and the lamps come on at dusk.

import { sun } from "./rebounce-viewer/daylight.js";

/** Where the apartment stands, and how much of the sun's lux count beside its lamps. */
const PLACE = { latitude: 46, day: 100, scale: 4e-4 };
/** Height of the sun below which the hedge hides it and the lamps come on, as the sine. */
const DUSK = 0.3;
/** Moonlight, which keeps the night from being black. */
const MOON = { type: "directional", direction: [0.35, -0.75, -0.55], intensity: 0.12, color: [0.6, 0.72, 1] };
/** Hours of the day that pass in a second. */
const PACE = 1.2;
const LAMPS = ["Floor lamp", "Dining table", "Kitchen", "Bedside", "Desk"];
const ROOMS = {
  "Living room": { position: [5.2, 1.6, 3.1], target: [1.9, 0.95, 6.0] },
  Kitchen: { position: [3.7, 1.6, 6.6], target: [1.2, 1.0, 1.2] },
  Bedroom: { position: [8.2, 1.6, 3.0], target: [6.3, 0.85, 6.2] },
  Study: { position: [6.4, 1.6, 2.4], target: [8.6, 0.9, 0.6] },
};

const find = (id) => document.getElementById(id);
const viewer = find("viewer");
const hour = find("hour");
const auto = find("auto");
const play = find("play");

/** What the lamps shine with when they are on, candela. */
let full = [];

const lamps = LAMPS.map((name) => {
  const box = document.createElement("input");
  box.type = "checkbox";
  box.addEventListener("change", () => {
    auto.checked = false;
    light();
  });
  const label = document.createElement("label");
  label.append(box, name);
  find("lamps").append(label);
  return box;
});

for (const [name, view] of Object.entries(ROOMS)) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = name;
  button.addEventListener("click", () => (viewer.camera = { ...view, up: [0, 1, 0], yfov_deg: 62 }));
  find("rooms").append(button);
}

/** Hours and minutes of the slider. */
function clock() {
  const minutes = Math.round(hour.valueAsNumber * 60) % (24 * 60);
  return [Math.floor(minutes / 60), minutes % 60].map((part) => String(part).padStart(2, "0")).join(":");
}

/** Puts the hour's light into the scene; the lamps stay where they may have been dragged to. */
function light() {
  const daylight = sun({ ...PLACE, hour: hour.valueAsNumber });
  const height = -daylight.direction[1];
  find("clock").value = clock();
  hour.setAttribute("aria-valuetext", clock());
  if (auto.checked) for (const box of lamps) box.checked = height < DUSK;
  if (full.length === 0) return;
  const [, ...present] = viewer.lights;
  const lit = present.map((lamp, i) => ({ ...lamp, intensity: lamps[i]?.checked ? full[i] : 0 }));
  viewer.lights = [daylight.intensity > 0 ? daylight : MOON, ...lit];
}

let last;
function pass(now) {
  if (play.getAttribute("aria-pressed") !== "true") return;
  const hours = last === undefined ? 0 : Math.min((now - last) / 1000, 0.1) * PACE;
  last = now;
  hour.valueAsNumber = (hour.valueAsNumber + hours) % 24;
  light();
  requestAnimationFrame(pass);
}

play.addEventListener("click", () => {
  const playing = play.getAttribute("aria-pressed") !== "true";
  play.setAttribute("aria-pressed", String(playing));
  last = undefined;
  if (playing) requestAnimationFrame(pass);
});
hour.step = "any";
hour.addEventListener("input", () => {
  play.setAttribute("aria-pressed", "false");
  light();
});
// With step "any" the arrow keys would move by a hundredth of the day.
hour.addEventListener("keydown", (event) => {
  const steps = { ArrowRight: 0.25, ArrowUp: 0.25, ArrowLeft: -0.25, ArrowDown: -0.25, PageUp: 2, PageDown: -2 };
  const step = steps[event.key];
  if (step === undefined) return;
  event.preventDefault();
  hour.valueAsNumber = Math.min(Math.max(hour.valueAsNumber + step, 0), 24);
  hour.dispatchEvent(new Event("input"));
});
auto.addEventListener("change", light);
play.hidden = matchMedia("(prefers-reduced-motion: reduce)").matches;

/** The scene is there: its lamps and the hour go together from now on. */
function begin() {
  full = viewer.lights.slice(1).map(({ intensity }) => intensity);
  light();
}
viewer.addEventListener("load", begin);
if (viewer.loaded) begin();
else light();
find("light").hidden = false;
