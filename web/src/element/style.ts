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
canvas, .poster, .cover { position: absolute; inset: 0; width: 100%; height: 100%; display: block; }
canvas { touch-action: pan-x pan-y; cursor: grab; outline: none; visibility: hidden; }
canvas:active { cursor: grabbing; }
:host(:focus-within) canvas, :host([interaction="all"]) canvas { touch-action: none; }
:host([interaction="page"]) canvas { touch-action: pan-y; }
:host([interaction="none"]) canvas { touch-action: auto; pointer-events: none; }
canvas.shown { visibility: visible; }
canvas:focus-visible { outline: 3px solid var(--accent); outline-offset: -3px; }
.tap {
  display: none; position: absolute; bottom: 0.75rem; left: 50%; translate: -50%; padding: 0.3em 0.9em;
  border-radius: 1em; background: rgb(21 23 26 / 0.85); pointer-events: none; white-space: nowrap;
}
@media (pointer: coarse) {
  :host(:not(:focus-within, [interaction="all"], [interaction="page"], [interaction="none"])) .shown ~ .tap { display: block; }
}
.poster { object-fit: cover; }
.cover { pointer-events: none; }
.progress { position: absolute; inset: 0; pointer-events: none; }
.bar { position: absolute; left: 0; right: 0; bottom: 0; height: 4px; background: rgb(255 255 255 / 0.12); }
.bar > div {
  height: 100%; width: calc(var(--rebounce-progress) * 100%); background: var(--accent); transition: width 0.15s;
}
@media (prefers-reduced-motion: reduce) { .bar > div { transition: none; } }
.message {
  position: absolute; inset: 0; padding: 1.5rem; text-align: center; overflow: auto;
  display: flex; flex-direction: column; gap: 1rem; align-items: center; justify-content: center;
  background: rgb(21 23 26 / 0.92);
}
.message.strip { top: auto; padding: 0.5rem 1rem; font-size: 0.8rem; }
.message p { margin: 0; max-width: 34rem; overflow-wrap: anywhere; }
[hidden] { display: none !important; }
button, input, select { font: inherit; color: inherit; }
button, .button {
  padding: 0.4em 1.1em; border-radius: 6px; border: 1px solid rgb(255 255 255 / 0.25);
  background: rgb(255 255 255 / 0.08); cursor: pointer;
}
button:hover, .button:hover { background: rgb(255 255 255 / 0.16); }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
`;

/** A style sheet that is made when it is first asked for. */
export function sheet(css: string): () => CSSStyleSheet {
  let made: CSSStyleSheet | undefined;
  return () => {
    if (!made) {
      made = new CSSStyleSheet();
      made.replaceSync(css);
    }
    return made;
  };
}

export const style = sheet(CSS);
