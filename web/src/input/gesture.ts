/** When a hand begins to change camera or lights, and when it has ended: pointers, keys, wheel and stick together. */

/** A wheel that has not turned for so many milliseconds stands still. */
const WHEEL_PAUSE = 400;

/** Makes what is told of everything that is held or let go, by a name of its own; `tell` hears of the first and the last. */
export function gestures(tell: (began: boolean) => void): (what: string, held: boolean) => void {
  const held = new Set<string>();
  let pause = 0;
  const note = (what: string, is: boolean) => {
    const before = held.size > 0;
    if (is) held.add(what);
    else held.delete(what);
    if (before !== held.size > 0) tell(!before);
  };
  return (what, is) => {
    note(what, is);
    if (what !== "wheel") return;
    clearTimeout(pause);
    pause = setTimeout(() => note(what, false), WHEEL_PAUSE) as unknown as number;
  };
}
