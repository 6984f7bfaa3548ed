// The first page's apartment: a slider moves the hour of its daylight.

import { clock, daylight, steppedByKeys } from "./day.js";

const viewer = document.getElementById("viewer");
const hour = document.getElementById("hour");

function light() {
  document.getElementById("clock").value = clock(hour.valueAsNumber);
  hour.setAttribute("aria-valuetext", clock(hour.valueAsNumber));
  viewer.lights = daylight(hour.valueAsNumber).lights(viewer.lights);
}

steppedByKeys(hour);
hour.addEventListener("input", () => viewer.loaded && light());
document.getElementById("day").hidden = false;
