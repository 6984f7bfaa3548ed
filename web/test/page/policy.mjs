// A page that trusts nothing: the strictest content security policy, every script held to its hash; what the element asks
// for and what it leaves behind.

import { readFile } from "node:fs/promises";
import { within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { document, serveStrictly, STRICTEST } from "../strict.mjs";
import { expectFailure, open, outcome } from "./open.mjs";

const DIST = new URL("../../dist/", import.meta.url);

/** The head of web/README.md: the script and all that it may load, each with its hash. */
function head({ integrity }) {
  const links = Object.entries(integrity).map(([file, hash]) => `<link rel="modulepreload" href="${file}" integrity="${hash}">`);
  return `${links.join("")}<script type="module" src="rebounce-viewer.js" integrity="${integrity["./rebounce-viewer.js"]}"></script>`;
}

/** In the page, before its scripts: what the policy has stopped. */
function watchPolicy() {
  globalThis.violations = [];
  globalThis.document.addEventListener("securitypolicyviolation", (event) => {
    violations.push(`${event.effectiveDirective}: ${event.blockedURI} ${event.sourceFile}`);
  });
}

/** Runs the tests. */
export async function policy(harness, context) {
  const hashes = JSON.parse(await readFile(new URL("integrity.json", DIST), "utf8"));
  const body = '<rebounce-viewer src="scene.rbn" controls autoplay alt="A room"></rebounce-viewer>';
  // A byte more, at the end, where it changes nothing but the hash.
  const tampered = (name, type) => async (_, response) => {
    const bytes = await readFile(new URL(name, DIST));
    const more = type === "application/wasm" ? Buffer.from([0, 1, 0]) : Buffer.from("\n");
    response.writeHead(200, { "content-type": type }).end(Buffer.concat([bytes, more]));
  };
  const faults = { "scene.rbn": (_, response) => response.writeHead(200).end(context.bytes) };
  const server = await serveStrictly({ pages: { "": document(body, head(hashes)) }, faults });
  const opened = (prepare) => open({ ...context, address: server.address }, { viewport: { width: 640, height: 480 }, prepare });

  try {
    await harness.test("page::policy::the_readme_has_the_policy_that_is_tested", async () => {
      const readme = await readFile(new URL("../../README.md", import.meta.url), "utf8");
      const said = /```\n(default-src[^`]*)```/.exec(readme)?.[1].replaceAll(/\s+/g, " ").trim();
      equal(said, STRICTEST, "the policy in the README");
    });

    await harness.test("page::policy::nothing_is_violated_nobody_else_is_asked_and_nothing_is_left_behind", async () => {
      const { page, faults } = await opened(watchPolicy);
      const session = await page.context().newCDPSession(page);
      const asked = [];
      session.on("Network.requestWillBeSent", ({ request }) => asked.push(request.url));
      session.on("Network.webSocketCreated", ({ url }) => asked.push(url));
      await session.send("Network.enable");
      // Once all has come: a page that is left before tells of the requests that it gave up.
      equal((await outcome(page)).type, "load", "the event before");
      await page.reload();
      equal((await outcome(page)).type, "load", "the event");
      // All that a visitor can do: the panel, every section of it, lights, pictures, links, a failure.
      await within("a visit", page.evaluate(async () => {
        const { shadowRoot } = viewer;
        await until(() => shadowRoot.querySelector("details"));
        for (const details of shadowRoot.querySelectorAll("details")) details.open = true;
        viewer.addLight({ type: "spot", position: [0, 1, 0], direction: [0, -1, 0], outer_cone_deg: 30, intensity: 1 });
        viewer.animations = [{ name: "on", duration: 1, tracks: [{ light: 0, property: "intensity", times: [0, 1], values: [1, 2] }] }];
        viewer.play({ repetitions: 1 });
        await until(() => events.some(({ type }) => type === "finished"));
        Object.assign(viewer, { overlay: "levels", toneMapping: "neutral", mode: "indirect", exposure: 1, width: 400, height: 300 });
        await viewer.toBlob();
        await viewer.counts();
        location.hash = new URL(viewer.stateLink()).hash;
        for (const button of shadowRoot.querySelectorAll("button")) if (!/remove|try/i.test(button.textContent)) button.click();
        await pause(1500);
        viewer.src = "nothing.rbn";
        await until(() => events.some(({ type }) => type === "error"));
      }));
      same(await page.evaluate(() => violations), [], "violations");
      // Pictures that the panel saves are made in the page.
      const others = asked.filter((url) => !url.startsWith(server.address) && !url.startsWith(`blob:${server.address}`));
      same(others, [], "requests to others");
      check(asked.some((url) => url.endsWith(".wasm")) && asked.some((url) => url.endsWith("panel.js")), `requests: ${asked.length}`);
      const left = await page.evaluate(async () => ({
        cookies: globalThis.document.cookie,
        local: localStorage.length,
        session: sessionStorage.length,
        databases: (await indexedDB.databases()).length,
        caches: (await caches.keys()).length,
        workers: (await navigator.serviceWorker.getRegistrations()).length,
      }));
      same(left, { cookies: "", local: 0, session: 0, databases: 0, caches: 0, workers: 0 }, "what is left behind");
      same(await page.context().cookies(), [], "cookies");
      const own = faults.filter((fault) => !fault.includes("404"));
      equal(own.join("\n"), "", "faults");
      await page.close();
    });

    await harness.test("page::policy::every_module_has_its_hash", async () => {
      const modules = server.asked.filter((name) => name.endsWith(".js"));
      check(modules.length >= 3, `${modules.length} modules`);
      same(modules.filter((name) => !(`./${name}` in hashes.integrity)), [], "modules without a hash");
    });

    for (const name of ["rebounce-viewer.js", "rebounce_viewer.js"]) {
      await harness.test(`page::policy::a_changed_${name}_is_not_run`, async () => {
        faults[name] = tampered(name, "text/javascript");
        try {
          const { page, faults: told } = await opened();
          while (!told.some((text) => /integrity/.test(text))) await page.waitForTimeout(50);
          await page.waitForTimeout(500);
          equal(await page.evaluate(() => customElements.get("rebounce-viewer") === undefined), true, "the element is not there");
          await page.close();
        } finally {
          delete faults[name];
        }
      });
    }

    await harness.test("page::policy::a_changed_program_is_not_run_and_that_is_said", async () => {
      const name = "rebounce_viewer_bg.wasm";
      faults[name] = tampered(name, "application/wasm");
      try {
        const { page } = await opened();
        await expectFailure(page, "network");
        await page.close();
      } finally {
        delete faults[name];
      }
    });
  } finally {
    server.end();
  }
}
