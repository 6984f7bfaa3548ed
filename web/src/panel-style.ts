/** The look of the panel. */

import { sheet } from "./style.js";

const CSS = `
.panel {
  position: absolute; top: 0.75rem; right: 0.75rem; width: 17rem; max-width: calc(100% - 1.5rem);
  max-height: calc(100% - 1.5rem); overflow: auto; box-sizing: border-box;
  background: #15171a;
  border: 1px solid rgb(255 255 255 / 0.12); border-radius: 10px;
}
.panel summary { padding: 0.5rem 0.8rem; cursor: pointer; font-weight: 600; user-select: none; }
.panel[open] > summary { border-bottom: 1px solid rgb(255 255 255 / 0.1); }
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
.stack, .fields { display: grid; gap: 0.7rem; }
.section > summary { padding: 0.1rem 0 0.5rem; }
.section + * { border-top: 1px solid rgb(255 255 255 / 0.1); padding-top: 0.6rem; }
.check { display: flex; gap: 0.5rem; align-items: center; }
.check input { accent-color: var(--accent); margin: 0; }
.state, .play { display: flex; flex-wrap: wrap; gap: 0.4rem; align-items: center; }
.state > *, .play select { flex: 1 1 auto; text-align: center; padding: 0.3em 0.5em; }
.state > .button { color: inherit; position: relative; overflow: hidden; }
.button:has(:focus-visible) { outline: 2px solid var(--accent); outline-offset: 2px; }
.button input { position: absolute; inset: 0; opacity: 0; cursor: pointer; }
.play input { flex: 1 1 4rem; width: 4rem; }
.lights { list-style: none; margin: 0; padding: 0; display: grid; gap: 0.3rem; }
.entry { flex: 1; text-align: left; padding: 0.3em 0.6em; border-left: 5px solid var(--lamp); }
.entry[aria-expanded="true"] { background: rgb(255 255 255 / 0.16); }
.row { align-items: center; }
[role="switch"] { width: 1.15rem; height: 1.15rem; accent-color: var(--accent); }
.fields { gap: 0.45rem; padding: 0.5rem 0 0.5rem 0.6rem; }
.axes { display: grid; grid-template-columns: repeat(3, 1fr); gap: 0.3rem; }
.axes label { display: flex; gap: 0.3rem; align-items: center; min-width: 0; }
input[type="number"], input[type="text"], select {
  width: 5.5rem; box-sizing: border-box; padding: 0.15em 0.3em; min-width: 0;
  background: #15171a; border: 1px solid rgb(255 255 255 / 0.25); border-radius: 5px;
}
.axes input[type="number"] { width: 100%; }
input[type="color"] { width: 3rem; height: 1.6rem; padding: 0; border: 0; background: none; }
.hint { margin: 0; font-size: 0.8rem; color: #b8bec5; }
.status { margin: 0; color: #ffd08f; overflow-wrap: anywhere; }
.status:empty { display: none; }
`;

export const panelStyle = sheet(CSS);
