// A share of the damaged files that `cargo xtask damage` opens: each is refused, or gives a picture.

import { openDamaged, summary } from "../damaged.mjs";
import { check, equal } from "../harness.mjs";

/** Runs the tests. `damaged`: the folder that the program `damage` has filled. */
export async function damaged(harness, context) {
  await harness.test("page::damaged::every_file_is_refused_or_gives_a_picture", async () => {
    const result = await openDamaged(context.browser, context.damaged, { each: 30 });
    console.log(`    ${summary(result)}`);
    equal(result.faults.join("\n"), "", "faults");
    equal(result.errors + result.pictures, result.files, "files that came to an end");
    check(result.errors > 10 && result.pictures > 0, summary(result));
  });
}
