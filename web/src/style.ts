/** The look of the element, in its shadow tree. */

const CSS = `
:host {
  display: block;
  position: relative;
  width: 100%;
  aspect-ratio: 16 / 9;
  min-height: 6rem;
  overflow: hidden;
  contain: content;
  background: var(--rebounce-background, #15171a);
  color: #e9ecef;
  font: 400 0.875rem/1.45 system-ui, sans-serif;
  --accent: var(--rebounce-accent, #ffb454);
}
:host([hidden]) { display: none; }
canvas, .poster { position: absolute; inset: 0; width: 100%; height: 100%; display: block; }
canvas { touch-action: none; cursor: grab; outline: none; visibility: hidden; }
canvas:active { cursor: grabbing; }
canvas.shown { visibility: visible; }
canvas:focus-visible { box-shadow: inset 0 0 0 3px var(--accent); }
.poster { object-fit: cover; }
.bar {
  position: absolute; left: 0; right: 0; bottom: 0; height: 4px;
  background: rgb(255 255 255 / 0.12);
}
.bar > div { height: 100%; width: 0; background: var(--accent); transition: width 0.15s; }
.message {
  position: absolute; inset: 0; padding: 1.5rem; text-align: center; overflow: auto;
  display: flex; flex-direction: column; gap: 1rem; align-items: center; justify-content: center;
  background: rgb(21 23 26 / 0.92);
}
.message p { margin: 0; max-width: 34rem; overflow-wrap: anywhere; }
[hidden] { display: none !important; }
button, input, select { font: inherit; color: inherit; }
button {
  padding: 0.4em 1.1em; border-radius: 6px; border: 1px solid rgb(255 255 255 / 0.25);
  background: rgb(255 255 255 / 0.08); cursor: pointer;
}
button:hover { background: rgb(255 255 255 / 0.16); }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
.panel {
  position: absolute; top: 0.75rem; right: 0.75rem; width: 15.5rem; max-width: calc(100% - 1.5rem);
  max-height: calc(100% - 1.5rem); overflow: auto; box-sizing: border-box;
  background: rgb(21 23 26 / 0.78); backdrop-filter: blur(10px);
  border: 1px solid rgb(255 255 255 / 0.12); border-radius: 10px;
}
.panel summary { padding: 0.5rem 0.8rem; cursor: pointer; font-weight: 600; user-select: none; }
.panel[open] summary { border-bottom: 1px solid rgb(255 255 255 / 0.1); }
.panel form { padding: 0.7rem 0.8rem; display: grid; gap: 0.7rem; margin: 0; }
.panel label, .panel legend { color: #b8bec5; }
.row { display: flex; justify-content: space-between; gap: 0.5rem; }
input[type="range"] { width: 100%; margin: 0.2rem 0 0; accent-color: var(--accent); }
fieldset { border: 0; margin: 0; padding: 0; min-width: 0; }
.choices { display: grid; grid-auto-flow: column; grid-auto-columns: 1fr; margin-top: 0.25rem;
  border: 1px solid rgb(255 255 255 / 0.18); border-radius: 7px; overflow: hidden; }
.choices label { position: relative; text-align: center; padding: 0.25rem 0; cursor: pointer; color: inherit; }
.choices label:has(:checked) { background: var(--accent); color: #15171a; }
.choices label:has(:focus-visible) { outline: 2px solid #fff; outline-offset: -3px; }
.choices input { position: absolute; opacity: 0; inset: 0; margin: 0; cursor: pointer; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #b8bec5; padding-bottom: 0.2rem; }
th { font-weight: 400; text-align: left; padding: 0.08rem 0; }
td { text-align: right; padding: 0.08rem 0; white-space: nowrap; }
.adapter { color: #9aa1a9; margin: 0; overflow-wrap: anywhere; font-size: 0.8rem; }
`;

let sheet: CSSStyleSheet | undefined;

/** The style sheet, made once. */
export function style(): CSSStyleSheet {
  if (!sheet) {
    sheet = new CSSStyleSheet();
    sheet.replaceSync(CSS);
  }
  return sheet;
}
