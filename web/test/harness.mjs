// Just enough of a test harness: names, outcomes, counts, and how long each took.

/** Tests named at the end of a run. */
const SLOWEST = 20;

/** Tests that ran. */
export class Harness {
  passed = 0;
  failed = 0;
  /** Milliseconds of each test and of each file, by name. */
  times = { tests: [], files: [] };
  /** What the tests that passed have looked at, such as "attribute src". */
  covered = new Set();

  /** Runs one test and says how it went. Never throws. `covers`: what of the element it looks at, one a line. */
  async test(name, work, covers = "") {
    const began = performance.now();
    const note = () => this.times.tests.push({ name, ms: performance.now() - began });
    try {
      await work();
      note();
      this.passed += 1;
      for (const what of covers.split(/[,\n]/)) this.covered.add(what.trim());
      console.log(`test ${name} ... ok (${seconds(this.times.tests.at(-1).ms)})`);
    } catch (error) {
      note();
      this.failed += 1;
      console.log(`test ${name} ... FAILED\n${indent(error?.stack ?? String(error))}`);
    }
  }

  /** Runs the tests of a file, with what they need before and between them, and keeps how long all of it took. */
  async file(name, work) {
    const began = performance.now();
    try {
      await work();
    } finally {
      this.times.files.push({ name, ms: performance.now() - began });
    }
  }

  /** The slowest tests and files, for those who look for time; no test depends on it. */
  summary() {
    const list = (what, times) => {
      const slowest = [...times].sort((a, b) => b.ms - a.ms).slice(0, SLOWEST);
      return `slowest ${what} (${seconds(times.reduce((sum, { ms }) => sum + ms, 0))} in all):\n${slowest.map(({ name, ms }) => `${seconds(ms).padStart(10)}  ${name}`).join("\n")}`;
    };
    const { tests, files } = this.times;
    return [list("tests", tests), ...(files.length > 1 ? [list("files", files)] : [])].join("\n\n");
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

function seconds(ms) {
  return `${(ms / 1000).toFixed(1)} s`;
}

function indent(text) {
  return text
    .split("\n")
    .map((line) => `    ${line}`)
    .join("\n");
}
