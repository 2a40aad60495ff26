// SPDX-License-Identifier: Apache-2.0
// Browsers without WebGL, broken pages, large meshes.
import assert from "node:assert/strict";
import {readFileSync, statSync, writeFileSync} from "node:fs";
import {join} from "node:path";
import {test} from "node:test";
import {pathToFileURL} from "node:url";

import {
  LAUNCH,
  SLOW,
  browser,
  folder,
  fileOf,
  open,
  rows,
  slide,
} from "./browser.mjs";
import {chromium} from "./modules.mjs";

test("without WebGL: a message and all tables", {timeout: 2 * SLOW}, async () => {
  const blind = await chromium.launch({
    ...LAUNCH,
    args: ["--headless=new", "--no-sandbox", "--disable-3d-apis"],
  });
  const {page, trouble, close} = await open(fileOf("ring").path, {in: blind});
  assert.match(await page.locator("[role=alert]").textContent(), /no WebGL 2/);
  assert.equal((await rows(page, "#levels")).length, 4);
  assert.equal(await page.locator("#components [data-component]").count(), 6);
  await slide(page, "#level", 0);
  assert.equal(await page.locator("#levels tr[aria-current] th").textContent(), "1");
  assert.deepEqual(trouble.filter((text) => !text.includes("WebGL")), []);
  await close();
  await blind.close();
});

test("a broken page shows an error", {timeout: 2 * SLOW}, async () => {
  const html = readFileSync(fileOf("ring").path, "utf8").replace(
    /(id="isoatlas-geometry">.{1000})[^<]*/,
    "$1",
  );
  const path = join(folder, "broken.html");
  writeFileSync(path, html);
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(pathToFileURL(path).href);
  await page.waitForSelector("[role=alert]");
  assert.match(await page.locator("[role=alert]").textContent(), /cannot be shown: its geometry/);
  await context.close();
});

test("100,000 triangles open in time, in a small file", {timeout: 4 * SLOW}, async () => {
  const {path, results: [result]} = fileOf("large");
  const {triangles} = result.levels[result.levels.length - 1];
  assert.ok(triangles >= 100_000);
  const bytes = statSync(path).size;
  assert.ok(bytes < 5e6, `${bytes} bytes`);
  const times = [];
  for (let k = 0; k < 3; ++k) {
    const {page, trouble, close} = await open(path);
    times.push(await page.evaluate(() => performance.getEntriesByName("ready")[0].startTime));
    assert.deepEqual(trouble, []);
    await close();
  }
  console.log(
    `${triangles.toLocaleString("en")} triangles, ${(bytes / 1e6).toFixed(2)} MB: ` +
      `ready after ${times.map((t) => Math.round(t)).join(", ")} ms; target: 2000`,
  );
  // The target is for an idle machine; this test detects an order of magnitude.
  assert.ok(Math.min(...times) < 8000, `${times}`);
});
