// Just enough of a test harness: names, outcomes, counts.

/** Tests that ran. */
export class Harness {
  passed = 0;
  failed = 0;

  /** Runs one test and says how it went. Never throws. */
  async test(name, work) {
    try {
      await work();
      this.passed += 1;
      console.log(`test ${name} ... ok`);
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
  check(Object.is(found, expected), `${what}: found ${JSON.stringify(found)}, expected ${JSON.stringify(expected)}`);
}

function indent(text) {
  return text
    .split("\n")
    .map((line) => `    ${line}`)
    .join("\n");
}
