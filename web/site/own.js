// The first page's bake of a visitor's scene. Nothing is fetched before the visitor asks.

const $ = (id) => document.getElementById(`own-${id}`);
const [viewer, bar, line, said, cancel, save] = ["viewer", "progress", "line", "said", "cancel", "save"].map($);
const samples = document.querySelectorAll("[data-sample]");

/** The scene's name, as its file is saved under. */
let name = "scene";
/** Whether the scene is baked, and not shown only; how many quarters of the bake were told; when it began. */
let [isBaking, quarters, began] = [false, 0, 0];

/** Shows a sentence; `isSaid`: screen readers hear it. */
function tell(sentence, isSaid = true) {
  line.textContent = sentence;
  if (isSaid) said.textContent = sentence;
}

/** What is shown of progress, Cancel and Save. */
function state({ busy, saves = false }) {
  const hadFocus = document.activeElement === cancel;
  viewer.classList.toggle("busy", busy);
  bar.hidden = cancel.hidden = !busy;
  save.hidden = !saves;
  save.textContent = `Save ${name}.rbn`;
  // What had the focus is gone.
  if (hadFocus && !busy) (saves ? save : $("files")).focus();
}

/** Begins with a scene: `open` hands it to the viewer. */
function begin(of, open, sample) {
  name = of.replace(/.*\//, "").replace(/\.(glb|gltf|rbn)$/i, "") || "scene";
  for (const button of samples) button.setAttribute("aria-current", String(button === sample));
  open();
  viewer.scrollIntoView({ block: "nearest" });
}

/** The name of what is the scene among files. */
const sceneOf = (files) => {
  const names = [...files].map((file) => file.webkitRelativePath || file.name);
  return names.find((one) => /\.(glb|gltf|rbn)$/i.test(one)) ?? names[0] ?? "";
};

for (const button of samples) {
  const { sample } = button.dataset;
  button.addEventListener("click", () => begin(sample, () => (viewer.src = `samples/${sample}.glb`), button));
}
for (const kind of ["files", "folder"]) {
  const input = $(`${kind}-input`);
  $(kind).addEventListener("click", () => input.click());
  input.addEventListener("change", () => {
    if (input.files.length) begin(sceneOf(input.files), () => viewer.open(...input.files));
    // The same file may be chosen again.
    input.value = "";
  });
}
$("folder").hidden = !("webkitdirectory" in HTMLInputElement.prototype);

// ---- drops: the viewer takes them from the first file on that is dragged over the page

const isFiles = ({ dataTransfer }) => dataTransfer?.types.includes("Files");
document.addEventListener("dragover", (event) => {
  if (!isFiles(event)) return;
  viewer.drop = true;
  const isOver = viewer.contains(event.target);
  viewer.classList.toggle("over", isOver);
  // Beside the viewer a file would take the place of the page.
  event.preventDefault();
  event.dataTransfer.dropEffect = isOver ? "copy" : "none";
});
document.addEventListener("dragleave", ({ relatedTarget }) => relatedTarget || viewer.classList.remove("over"));
document.addEventListener("drop", (event) => {
  if (!isFiles(event)) return;
  viewer.classList.remove("over");
  const { files } = event.dataTransfer;
  const isTaken = event.defaultPrevented;
  event.preventDefault();
  // The viewer's own module may still be on its way.
  if (viewer.contains(event.target)) begin(sceneOf(files), () => isTaken || viewer.open(...files));
});

// ---- what the viewer tells

viewer.addEventListener("progress", ({ detail: { loaded } }) => {
  if (loaded > 0) return;
  [isBaking, quarters, began] = [false, 0, performance.now()];
  bar.removeAttribute("value");
  tell("Reading the scene.");
  state({ busy: true });
});
viewer.addEventListener("bake-progress", ({ detail: { stage, ratio, secondsLeft } }) => {
  isBaking = true;
  bar.value = ratio;
  if (stage === "done") {
    const seconds = Math.max(Math.round((performance.now() - began) / 1000), 1);
    tell(`Baked in ${seconds} s. Drag a light’s handle: the bounced light follows.`);
    state({ busy: false, saves: true });
    return;
  }
  const percent = `${Math.floor(100 * ratio)}%`;
  const left = Number.isFinite(secondsLeft) && secondsLeft >= 1 ? `, ${Math.round(secondsLeft)} s left` : "";
  const sentence = `${stage[0].toUpperCase()}${stage.slice(1)}: ${percent}${left}`;
  // Screen readers hear each quarter.
  const isQuarter = Math.floor(4 * ratio) > quarters;
  quarters = Math.max(quarters, Math.floor(4 * ratio));
  tell(sentence, isQuarter);
});
viewer.addEventListener("load", () => {
  if (isBaking) return;
  tell("Shown as it was baked.");
  state({ busy: false });
});
viewer.addEventListener("error", ({ detail: { message } }) => {
  state({ busy: false });
  // Where no picture is left, the viewer says why itself.
  if (viewer.loaded) tell(message);
  else tell("", false);
});
cancel.addEventListener("click", () => {
  viewer.cancel();
  tell(viewer.loaded ? "Cancelled. What you see is the last preview." : "Cancelled.");
  state({ busy: false });
});
save.addEventListener("click", () => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([viewer.toRbn()]));
  link.download = `${name}.rbn`;
  link.click();
  // The browser takes what the link leads to after the click.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
});
