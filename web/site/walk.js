// The page of the walking figure: the moment of its walk, the lights, and what computes bounced light.

const SHOT = "shots/walk.json";

const find = (id) => document.getElementById(id);
const viewer = find("viewer");
const moment = find("moment");
const play = find("play");

/** Lights by the name of their choice. */
const lights = {};

function show(time) {
  moment.valueAsNumber = time;
  const text = `${moment.valueAsNumber.toFixed(1)} s`;
  find("seconds").textContent = text;
  moment.setAttribute("aria-valuetext", text);
}

function follow() {
  if (viewer.paused) return;
  show(viewer.currentTime);
  requestAnimationFrame(follow);
}

function pause() {
  viewer.pause();
  play.setAttribute("aria-pressed", "false");
}

play.addEventListener("click", () => {
  if (!viewer.loaded) return;
  if (!viewer.paused) return pause();
  play.setAttribute("aria-pressed", "true");
  viewer.play("walk");
  follow();
});
moment.addEventListener("input", () => {
  pause();
  viewer.animationName = "walk";
  viewer.currentTime = moment.valueAsNumber;
  show(moment.valueAsNumber);
});
for (const radio of document.getElementsByName("solver")) {
  radio.addEventListener("change", () => (viewer.solver = radio.value));
}
for (const radio of document.getElementsByName("light")) {
  radio.addEventListener("change", () => {
    if (radio.value in lights) viewer.lights = lights[radio.value];
  });
}
play.hidden = matchMedia("(prefers-reduced-motion: reduce)").matches;

/** The scene is there: it begins in the evening, with the figure between the rooms. */
async function begin() {
  lights.afternoon = viewer.lights;
  const shot = await (await fetch(SHOT)).json();
  viewer.shot = shot;
  lights.evening = viewer.lights;
  show(shot.time);
  find("walk").hidden = false;
}
viewer.addEventListener("load", begin);
if (viewer.loaded) begin();
