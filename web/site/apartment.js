// The apartment's page: the hour of the day sets sun and sky, and the lamps come on at dusk.

import { daylight, show, steppedByKeys } from "./day.js";

/** Hours of the day that pass in a second. */
const PACE = 1.2;
/** What a switch turns on, by the names of the file's lights: lamps, and what shines with them. */
const LAMPS = {
  "Floor lamp": ["Living room", "Lamp shade"],
  "Dining table": ["Dining table"],
  Kitchen: ["Kitchen"],
  Bedside: ["Bedroom", "Bedside shade"],
  Desk: ["Study"],
  Television: ["Television"],
};
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

/** What the lamps shine with when they are on, by name. */
const full = new Map();

const lamps = Object.entries(LAMPS).map(([name, lights]) => {
  const box = document.createElement("input");
  box.type = "checkbox";
  box.addEventListener("change", () => {
    auto.checked = false;
    light();
  });
  const label = document.createElement("label");
  label.append(box, name);
  find("lamps").append(label);
  return { box, lights };
});

for (const [name, view] of Object.entries(ROOMS)) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = name;
  button.addEventListener("click", () => (viewer.camera = { ...view, up: [0, 1, 0], yfov_deg: 62 }));
  find("rooms").append(button);
}

/** Puts the hour's light into the scene; the lamps stay where they may have been dragged to. */
function light() {
  const { lights, isDark } = daylight(hour.valueAsNumber);
  show(hour, find("clock"));
  if (auto.checked) for (const { box } of lamps) box.checked = isDark;
  if (full.size === 0) return;
  const isOn = (name) => lamps.some(({ box, lights }) => box.checked && lights.includes(name));
  const switched = viewer.lights.map((lamp) =>
    full.has(lamp.name) ? { ...lamp, intensity: isOn(lamp.name) ? full.get(lamp.name) : 0 } : lamp,
  );
  viewer.lights = lights(switched);
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
steppedByKeys(hour);
hour.addEventListener("input", () => {
  play.setAttribute("aria-pressed", "false");
  light();
});
auto.addEventListener("change", light);
play.hidden = matchMedia("(prefers-reduced-motion: reduce)").matches;

/** The scene is there: its lamps and the hour go together from now on. */
function begin() {
  const names = new Set(Object.values(LAMPS).flat());
  for (const { name, intensity } of viewer.lights) if (names.has(name)) full.set(name, intensity);
  light();
}
viewer.addEventListener("load", begin);
if (viewer.loaded) begin();
else light();
find("light").hidden = false;
