// Just enough of a test harness: names, outcomes, counts.

/** Tests that ran. */
export class Harness {
  passed = 0;
  failed = 0;
  /** What the tests that passed have looked at, such as "attribute src". */
  covered = new Set();
  /** Tests that take long and were left out. */
  left = 0;
  /** Whether those that take long are run, too. */
  #long;

  constructor(long = false) {
    this.#long = long;
  }

  /** As `test`, of one that takes long: what it looks at counts as looked at where it is left out. */
  async long(name, work, covers = "") {
    if (this.#long) return this.test(name, work, covers);
    this.left += 1;
    this.#cover(covers);
  }

  #cover(covers) {
    for (const what of covers.split(/[,\n]/)) this.covered.add(what.trim());
  }

  /** Runs one test and says how it went. Never throws. `covers`: what of the element it looks at, one a line. */
  async test(name, work, covers = "") {
    const began = performance.now();
    try {
      await work();
      this.passed += 1;
      this.#cover(covers);
      const seconds = Math.round((performance.now() - began) / 1000);
      console.log(`test ${name} ... ok${seconds < 5 ? "" : ` (${seconds} s)`}`);
    } catch (error) {
      this.failed += 1;
      console.log(`test ${name} ... FAILED\n${indent(error?.stack ?? String(error))}`);
    }
  }

  /** Counts tests that something else ran. */
  add({ passed, failed }) {
    this.passed += passed;
    this.failed += failed;
  }
}

/** Throws unless the claim holds. */
export function check(claim, message) {
  if (!claim) throw new Error(message);
}

/** Throws unless the two are the same value. */
export function equal(found, expected, what) {
  const text = (value) => String(JSON.stringify(value)).slice(0, 1000);
  check(Object.is(found, expected), `${what}: found ${text(found)}, expected ${text(expected)}`);
}

/** Throws unless the two are the same within `tolerance`. */
export function near(found, expected, tolerance, what) {
  check(Math.abs(found - expected) <= tolerance, `${what}: found ${found}, expected ${expected} to ${tolerance}`);
}

/** Throws unless the two are written the same as JSON. Small things only: both are printed. */
export function same(found, expected, what) {
  equal(JSON.stringify(found), JSON.stringify(expected), what);
}

function indent(text) {
  return text
    .split("\n")
    .map((line) => `    ${line}`)
    .join("\n");
}
