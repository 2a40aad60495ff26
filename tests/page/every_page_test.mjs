// SPDX-License-Identifier: Apache-2.0
// Every page: its tables have the data, all levels are drawn, nothing overflows.
import assert from "node:assert/strict";
import {resolve} from "node:path";
import {describe, test} from "node:test";

import {
  SLOW,
  fileOf,
  open,
  picture,
  state,
  drawn,
  choose,
  rows,
  slide,
} from "./browser.mjs";
import {pages} from "./make_page.mjs";

async function overflowsNowhere(page, width) {
  const {scroll, client} = await page.evaluate(() => ({
    scroll: document.documentElement.scrollWidth,
    client: document.documentElement.clientWidth,
  }));
  assert.ok(scroll <= client, `at ${width} pixels nothing overflows: ${scroll} > ${client}`);
  for (const selector of ["table", "#facts section"]) {
    const over = await page
      .locator(selector)
      .evaluateAll(
        (all) =>
          all.filter(
            (e) =>
              e.getBoundingClientRect().right > innerWidth + 0.5 ||
              e.scrollWidth > e.clientWidth + 1,
          ).length,
      );
    assert.equal(over, 0, `at ${width} pixels no ${selector} overflows`);
  }
}

describe("every page", () => {
  const names = [
    ...Object.keys(pages).filter((name) => name !== "large"),
    ...(process.env.ISOATLAS_PAGE ? ["ISOATLAS_PAGE"] : []),
  ];
  for (const name of names) {
    test(name, {timeout: 4 * SLOW}, async () => {
      const path =
        name === "ISOATLAS_PAGE" ? resolve(process.env.ISOATLAS_PAGE) : fileOf(name).path;
      // A small window, in which pictures are drawn soon.
      const {page, trouble, close} = await open(path, {width: 360, height: 800});
      await overflowsNowhere(page, 360);
      const data = await page.evaluate(() =>
        JSON.parse(document.getElementById("isoatlas-data").textContent),
      );
      const [result] = data.results;
      assert.equal(await page.locator("h1").textContent(), result.title);

      // The level table contains the data of the JSON.
      const table = await rows(page, "#levels");
      assert.deepEqual(
        table.map((r) => r.slice(0, 3).map((text) => Number(text.replaceAll(",", "")))),
        result.levels.map((l) => [l.level + 1, l.vertices, l.triangles]),
      );

      // Every level is drawn, and the topology counted in the page agrees with the JSON.
      const last = result.levels.length - 1;
      assert.equal(await state(page, "level"), last);
      let before = null;
      for (let level = 0; level <= last; ++level) {
        await slide(page, "#level", level);
        const now = await picture(page);
        if (
          before !== null &&
          result.levels[level].triangles !== result.levels[level - 1].triangles
        ) {
          assert.notEqual(now, before, `level ${level} looks different`);
        }
        before = now;
        const components = await state(page, "components");
        assert.equal(components.length, result.levels[level].components);
        assert.equal(
          components.reduce((sum, c) => sum + c.triangles, 0),
          result.levels[level].triangles,
        );
        if (result.levels[level].genus !== null) {
          assert.equal(
            components.reduce((sum, c) => sum + c.genus, 0),
            result.levels[level].genus,
          );
        }
        if (result.levels[level].boundary_loops !== null) {
          assert.equal(
            components.reduce((sum, c) => sum + c.boundaryLoops, 0),
            result.levels[level].boundary_loops,
          );
        }
        assert.match(
          await page.locator("#view").getAttribute("aria-label"),
          new RegExp(
            `level ${result.levels[level].level + 1} of ${result.levels[last].level + 1}: ` +
              `${result.levels[level].vertices.toLocaleString("en")} vert`,
          ),
        );
      }

      await page.locator("#worst").click();
      const worst = await state(page, "worst");
      const {x, y, box} = await page.evaluate(() => {
        const [px, py] = window.isoatlas.project(window.isoatlas.worst.centroid);
        const {width, height} = document.getElementById("view").getBoundingClientRect();
        return {x: px, y: py, box: {width, height}};
      });
      assert.ok(
        Math.abs(x - box.width / 2) < 1 && Math.abs(y - box.height / 2) < 1,
        `the worst triangle is at ${x}, ${y} of ${box.width} x ${box.height}`,
      );
      assert.ok(
        (await page.locator("#status").textContent()).includes(
          `${Number(worst.ratio.toPrecision(3))}`,
        ),
      );

      for (const colour of [
        "aspect",
        "component",
        ...(result.nested === false ? [] : ["level"]),
        ...(result.geometry.levels.some((l) => l.distance) ? ["distance"] : []),
      ])
        await choose(page, `colouring-${colour}`);
      for (const style of ["lines", "split", "smooth"]) await choose(page, `style-${style}`);
      assert.deepEqual(trouble, []);
      await close();

      const {page: wide, close: done} = await open(path, {width: 1440, height: 800});
      await overflowsNowhere(wide, 1440);
      await done();
    });
  }
});
