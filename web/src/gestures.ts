/** When a hand on the picture begins and ends to change something. */

/** The wheel has come to rest when it has not turned for so long, milliseconds. */
const REST = 300;

/** Tells of the first pointer or key that goes down and the last that goes up, and of turns of the wheel. */
export function gestures(canvas: HTMLCanvasElement, tell: (began: boolean) => void, signal: AbortSignal): void {
  const held = new Set<number | string>();
  let rest = 0;
  const down = (what: number | string) => {
    held.add(what);
    tell(true);
  };
  const up = (what: number | string) => {
    if (held.delete(what) && held.size === 0) tell(false);
  };
  const listen = <K extends keyof HTMLElementEventMap>(type: K, work: (event: HTMLElementEventMap[K]) => void) =>
    canvas.addEventListener(type, work, { signal, passive: true });
  listen("pointerdown", ({ pointerId }) => down(pointerId));
  listen("pointerup", ({ pointerId }) => up(pointerId));
  listen("pointercancel", ({ pointerId }) => up(pointerId));
  listen("keydown", ({ code, ctrlKey, metaKey, altKey }) => ctrlKey || metaKey || altKey || down(code));
  listen("keyup", ({ code }) => up(code));
  listen("blur", () => {
    held.clear();
    tell(false);
  });
  listen("wheel", () => {
    tell(true);
    clearTimeout(rest);
    rest = setTimeout(() => held.size === 0 && tell(false), REST);
  });
}
