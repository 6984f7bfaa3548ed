// The first page's apartment: a slider moves the hour of its daylight.

import { daylight, show, steppedByKeys } from "./day.js";

const viewer = document.getElementById("viewer");
const hour = document.getElementById("hour");

function light() {
  show(hour, document.getElementById("clock"));
  viewer.lights = daylight(hour.valueAsNumber).lights(viewer.lights);
}

steppedByKeys(hour);
hour.addEventListener("input", () => viewer.loaded && light());
document.getElementById("day").hidden = false;
