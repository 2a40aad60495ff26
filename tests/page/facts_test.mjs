// SPDX-License-Identifier: Apache-2.0
// Facts next to the mesh, of complete and incomplete results.
import assert from "node:assert/strict";
import {test} from "node:test";

import {
  SLOW,
  fileOf,
  open,
  picture,
  state,
  choose,
  rows,
  slide,
} from "./browser.mjs";
import {pages} from "./make_page.mjs";

test("several results", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("several").path);
  await choose(page, "colouring-component");
  const first = await picture(page);
  await page.locator("#result").selectOption("1");
  await page.waitForSelector("html[data-ready='1']");
  assert.notEqual(await picture(page), first);
  assert.equal(await page.locator("h1").textContent(), "second");
  assert.equal((await rows(page, "#levels")).length, 2);
  assert.match(await page.locator("#error").textContent(), /voxels$/);
  await page.locator("#result").selectOption("0");
  await page.waitForSelector("html[data-ready='0']");
  assert.equal(await picture(page), first);
  assert.deepEqual(trouble, []);
  await close();
});

test("missing facts are named", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("bare").path);
  assert.ok(await page.locator("#colouring-distance").isDisabled());
  const words = await page.locator("main").textContent();
  for (const text of [
    "no distance error",
    "does not contain the command",
    "does not contain the parameters",
    "No comparison with marching cubes",
    "does not contain the topology of the isosurface",
    "were not tested",
  ]) {
    assert.ok(words.includes(text), text);
  }
  assert.equal(await page.locator("#error").textContent(), "error not measured");
  assert.equal(await page.locator("#sampling").count(), 0);
  await close();
});

test(
  "the page counts shapes and kinds that a file does not contain",
  {timeout: 2 * SLOW},
  async () => {
    const {page, close} = await open(fileOf("terse").path);
    const {
      results: [expected],
    } = pages.ring();
    const least = (await rows(page, "#levels")).map((r) => r[4]);
    // The last digits differ, because positions in the page are rounded to a grid.
    least.forEach((text, level) =>
      assert.ok(
        Math.abs(Number(text) - expected.levels[level].quality.aspect_ratio.minimum) < 0.005,
        text,
      ),
    );
    assert.deepEqual(
      new Set((await rows(page, "#kinds")).map((r) => r.join())),
      new Set(["genus 1, 0 loops,1,1,✓", "genus 0, 2 loops,1,1,✓", "genus 0, 0 loops,4,4,✓"]),
    );
    assert.ok(
      (await page.locator("section[aria-label=Certificate]").textContent()).includes(
        "no certificate",
      ),
    );
    await close();
  },
);

test("many components: the first 10, then the others", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("dust").path);
  const listed = () => page.locator("#components [data-component]").count();
  assert.equal(await listed(), 10);
  assert.match(await page.locator("#rest").textContent(), /21 more/);
  await page.locator("#list-more").click();
  assert.equal(await listed(), 31);
  assert.equal(await page.locator("#list-more").count(), 0);
  assert.equal(await page.evaluate(() => document.activeElement.id), "shown-11");
  assert.ok(await page.locator("#level").isDisabled(), "one level: nothing to slide");
  await close();
});

test("inverted components and dropped components", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("balanced").path);
  assert.ok(
    (await page.locator("section[aria-label=Certificate]").textContent()).includes(
      "✗ 1 component inverted, or inside another",
    ),
  );
  assert.equal(
    await page.locator("#kept").textContent(),
    "Kept: 1 part in 3 components, the largest of 12.5 mm³.",
  );
  assert.equal(
    await page.locator("#dropped").textContent(),
    "Left out: 7 smaller components, the largest of 0.25 mm³ (--keep-components 1).",
  );
  assert.match(await page.locator("#same-components").textContent(), /only the kept components/);
  assert.match(await page.locator("header .soft").textContent(), /6 components of 13/);
  await close();
});

test("a mesh that is not a manifold", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("torn").path);
  assert.match(await page.locator("#not-manifold").textContent(), /Not an oriented manifold/);
  const [[, triangles, area, volume], [more]] = await rows(page, "#components");
  assert.deepEqual([triangles, area, volume], ["3", "24", "–"]);
  assert.equal(more, "4 × 4 × 8 mm · not a manifold");
  assert.ok(await page.locator("#fill-cuts").isDisabled(), "it has no inside");
  await slide(page, "#cut-x", 0.5);
  assert.match(await page.locator("#legend").textContent(), /inside$/);
  assert.deepEqual(trouble, []);
  await close();
});

test("hostile text stays text", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("hostile").path);
  const {results: [result]} = fileOf("hostile");
  assert.equal(await page.locator("h1").textContent(), result.title);
  assert.equal(await page.locator("#command").textContent(), result.command);
  assert.equal(await page.locator("h1 b, img").count(), 0);
  assert.deepEqual(trouble, []);
  await close();
});

test("far from the origin it looks the same", {timeout: 2 * SLOW}, async () => {
  const near = await open(fileOf("ring").path);
  const far = await open(fileOf("far").path);
  await slide(near.page, "#level", 2);  // the finest of the other
  // Pixels may differ, because positions are rounded differently. Positions and the worst triangle
  // are compared instead.
  const [a, b] = await Promise.all(
    [near, far].map(({page}) =>
      page.evaluate(() => window.isoatlas.project(window.isoatlas.centre)),
    ),
  );
  assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 1, `${a} and ${b}`);
  const worst = [await state(near.page, "worst"), await state(far.page, "worst")];
  assert.ok(Math.abs(worst[0].ratio - worst[1].ratio) < 0.01);
  assert.ok(Math.abs(worst[1].centroid[0]) > 9e5, "in the file's coordinates");
  await near.close();
  await far.close();
});
