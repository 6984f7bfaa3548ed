/** The look of the panel. */

import { sheet } from "../element/style.js";

const CSS = `
.dock { position: absolute; inset: 0; pointer-events: none; container-type: size; isolation: isolate; }
.dock > * {
  pointer-events: auto; position: absolute; box-sizing: border-box;
  --target: 1.8rem; --head: max(2.25rem, var(--target)); --edge: rgb(255 255 255 / 0.14);
}
.panel {
  top: 0.75rem; right: 0.75rem; width: max-content; max-width: calc(100% - 1.5rem); --height: calc(100cqh - 1.5rem);
  overflow: hidden; background: #15171ae6; border: 1px solid var(--edge); border-radius: 10px;
}
.panel[open] { width: 19rem; background: #15171a; }
.panel summary { cursor: pointer; font-weight: 600; user-select: none; }
.panel > summary {
  display: flex; gap: 0.5rem; align-items: center; height: var(--head); padding: 0 0.75rem; box-sizing: border-box;
}
.panel > summary::-webkit-details-marker { display: none; }
.panel > summary:focus-visible { outline-offset: -3px; }
.panel[open] > summary { border-bottom: 1px solid var(--edge); }
svg { width: 1.15rem; height: 1.15rem; fill: none; stroke: currentColor; stroke-width: 2; stroke-linecap: round; stroke-linejoin: round; }
.panel .close { margin-left: auto; }
.panel[open] > summary .settings, .panel:not([open]) .close { display: none; }
.screen {
  right: 0.75rem; bottom: 0.75rem; width: var(--head); height: var(--head); padding: 0;
  display: grid; place-items: center; background: #15171ae6; border-color: var(--edge); z-index: -1;
}
.panel[open] ~ .screen { right: 20.5rem; }
.screen:hover { background: #2b2e32; }
.body { display: flex; flex-direction: column; max-height: calc(var(--height) - var(--head) - 2px); }
.panel form { padding: 0.7rem 0.8rem; display: grid; gap: 0.7rem; margin: 0; overflow: auto; overscroll-behavior: contain; }
.panel label, .panel legend, .panel span { color: #b8bec5; }
.row { display: flex; justify-content: space-between; align-items: center; gap: 0.5rem; }
.panel :is(button, .button, select, summary, .choices label, .check, input:not([type="checkbox"], [type="radio"])) {
  min-height: var(--target); box-sizing: border-box;
}
input[type="range"] { width: 100%; margin: 0; accent-color: var(--accent); display: block; }
fieldset { border: 0; margin: 0; padding: 0; min-width: 0; }
.choices { display: grid; grid-auto-flow: column; grid-auto-columns: 1fr; margin-top: 0.25rem;
  border: 1px solid rgb(255 255 255 / 0.18); border-radius: 7px; overflow: hidden; }
.choices label { position: relative; display: grid; place-items: center; cursor: pointer; color: inherit; }
.choices label:has(:checked) { background: var(--accent); color: #15171a; }
.choices label:has(:focus-visible) { outline: 2px solid #fff; outline-offset: -3px; }
.choices input { position: absolute; opacity: 0; inset: 0; margin: 0; cursor: pointer; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #b8bec5; padding-bottom: 0.2rem; }
th { font-weight: 400; text-align: left; padding: 0.08rem 0; }
td { text-align: right; padding: 0.08rem 0; white-space: nowrap; }
.adapter { color: #9aa1a9; margin: 0; overflow-wrap: anywhere; font-size: 0.8rem; }
.stack, .fields { display: grid; gap: 0.5rem; }
.panel form, .stack, .fields, .lights { grid-template-columns: minmax(0, 1fr); }
.section > summary { line-height: var(--target); }
/* In the heading, but no part of what it opens. */
.steps { position: absolute; top: 0; right: 2.5rem; display: flex; }
.steps button { width: 2.75rem; height: var(--head); padding: 0; border: 0; background: none; }
.panel form > * + * + * { border-top: 1px solid var(--edge); padding-top: 0.4rem; }
.panel form > .play { padding-top: 0.7rem; }
.check { display: flex; gap: 0.5rem; align-items: center; }
.check input { accent-color: var(--accent); margin: 0; }
.buttons, .play { display: flex; flex-wrap: wrap; gap: 0.4rem; align-items: center; }
.buttons > *, .play select { flex: 1 1 auto; text-align: center; padding: 0 0.5em; }
.buttons button, .buttons .button { display: flex; gap: 0.4em; align-items: center; justify-content: center; }
.buttons > .button { color: inherit; position: relative; overflow: hidden; }
[aria-disabled="true"] { color: #8a9199; cursor: default; }
.button:has(:focus-visible) { outline: 2px solid var(--accent); outline-offset: 2px; }
.button input { position: absolute; inset: 0; opacity: 0; cursor: pointer; }
.play input { flex: 1 1 4rem; width: 4rem; }
.lights { list-style: none; margin: 0; padding: 0; display: grid; gap: 0.3rem; }
.entry {
  flex: 1; min-width: 0; text-align: left; padding: 0 0.6em; border-left: 5px solid var(--lamp);
  display: flex; justify-content: space-between; align-items: center; gap: 0.6em;
}
.panel .entry span { color: inherit; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.entry small { color: #b8bec5; }
.entry[aria-expanded="true"] { background: rgb(255 255 255 / 0.16); }
.hovered .entry { border-color: var(--accent); border-left-color: var(--lamp); }
/* The name is in the entry above. */
.fader { display: flex; gap: 0.6em; align-items: center; }
.fader .row { order: 1; width: 4.2rem; justify-content: flex-end; font-variant-numeric: tabular-nums; font-size: 0.8rem; }
.fader input { flex: 1; }
.solo { width: var(--target); padding: 0; font-weight: 600; }
.solo[aria-pressed="true"] { background: #ffd08f; color: #15171a; }
.silent .entry { border-left-style: dotted; }
.panel .silent .entry span { color: #9aa1a9; }
[role="switch"] { width: 1.5rem; height: 1.5rem; margin: calc((var(--target) - 1.5rem) / 2); accent-color: var(--accent); }
.fields { padding: 0.6rem 0 0.5rem 0.6rem; }
.axes { display: grid; grid-template-columns: repeat(3, 1fr); gap: 0.4rem; }
input[type="number"], input[type="text"], select {
  width: 6.5rem; padding: 0 0.4em; min-width: 0;
  background: #15171a; border: 1px solid rgb(255 255 255 / 0.25); border-radius: 5px;
}
/* Without arrows, which cover digits. */
input[type="number"] { appearance: textfield; font-variant-numeric: tabular-nums; }
input::-webkit-inner-spin-button { appearance: none; margin: 0; }
.axes input, .units > *, .panel .name, .panel .row select { width: 100%; flex: 1; }
input[type="color"] { width: 3.5rem; height: 1.8rem; padding: 0; border: 0; background: none; }
.hint { margin: 0; font-size: 0.8rem; color: #b8bec5; }
.status { margin: 0; }
.panel .status span {
  display: block; padding: 0.5rem 0.8rem; color: #ffd08f; overflow-wrap: anywhere; border-top: 1px solid var(--edge);
}
.status :not(.stays) { animation: gone 1ms 12s forwards; }
@keyframes gone { to { font-size: 0; padding: 0; border: 0; } }
@media (pointer: coarse) { .dock > * { --target: 44px; } .hint { display: none; } }
/* On a phone a sheet, below the picture. */
@container (max-width: 30rem) {
  .dock > * { --target: 44px; }
  .panel[open] ~ .screen { right: 0.75rem; bottom: calc(max(50cqh, min(100cqh, 16rem)) + 0.75rem); }
  .panel[open] {
    inset: auto 0 0; width: auto; max-width: none; --height: max(50cqh, min(100cqh, 16rem)); border-radius: 12px 12px 0 0; border-width: 1px 0 0;
  }
}
`;

export const panelStyle = sheet(CSS);
