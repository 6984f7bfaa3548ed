// A share of the damaged files that `cargo xtask damage` opens: each is refused, or gives a picture.

import { openDamaged, summary } from "../damaged.mjs";
import { check, equal } from "../harness.mjs";
import { document, serveStrictly } from "../strict.mjs";
import { open, outcome } from "./open.mjs";

/** Runs the tests. `damaged`: the folder that the program `damage` has filled. */
export async function damaged(harness, context) {
  await harness.test("page::damaged::every_file_is_refused_or_gives_a_picture", async () => {
    const result = await openDamaged(context.browser, context.damaged, { each: 30 });
    console.log(`    ${summary(result)}`);
    equal(result.faults.join("\n"), "", "faults");
    equal(result.errors + result.pictures, result.files, "files that came to an end");
    check(result.errors > 10 && result.pictures > 0, summary(result));
  });

  await harness.test("page::damaged::a_picture_is_as_large_as_it_is_not_as_the_file_says", async () => {
    const server = await serveStrictly({ folders: [context.damaged], pages: { "": document("<rebounce-viewer></rebounce-viewer>") } });
    try {
      const { page } = await open({ ...context, address: server.address });
      const bytes = async (file, seen) => {
        await page.evaluate((name) => (viewer.src = name), file);
        equal((await outcome(page, seen)).type, "load", "the event");
        return page.evaluate(() => viewer.stats().bytes.textures);
      };
      equal(await bytes("large-claim.rbn", 0), await bytes("whole.rbn", 1), "bytes of textures");
      await page.close();
    } finally {
      server.end();
    }
  });
}
