// SPDX-License-Identifier: Apache-2.0
// Files that the page saves: the picture and meshes.
//   ISOATLAS_TOOL=PATH   also lets the tool check the saved meshes
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {readFileSync} from "node:fs";
import {join} from "node:path";
import {test} from "node:test";

import {SLOW, fileOf, folder, front, open, slide} from "./browser.mjs";

async function saved(page, button) {
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.locator(button).click(),
  ]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  return {name: download.suggestedFilename(), path, bytes: readFileSync(path)};
}

/** The pixels of a PNG, decoded by the browser, at shares of its width and height. */
const pixels = (page, bytes, shares) =>
  page.evaluate(
    async ([base64, at]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [image.width, image.height];
      const context = canvas.getContext("2d", {willReadFrequently: true});
      context.drawImage(image, 0, 0);
      return at.map(([x, y]) => [
        ...context.getImageData(
          Math.floor(x * image.width), Math.floor(y * image.height), 1, 1).data,
      ]);
    },
    [bytes.toString("base64"), shares],
  );

test("the picture, with its background, axes and scale", {timeout: 3 * SLOW}, async () => {
  for (const dark of [false, true]) {
    const {page, trouble, close} = await open(fileOf("balls").path, {dark});
    await front(page);
    const before = await page.evaluate(() => window.isoatlas.picture());
    const {name, bytes} = await saved(page, "#save-picture");
    assert.equal(name, "balls_level_1.png");
    assert.equal(bytes.subarray(1, 4).toString(), "PNG");
    const [width, height] = [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
    const box = await page.locator("#view").boundingBox();
    assert.equal(width, 2400);
    assert.ok(Math.abs(width / height - box.width / box.height) < 0.01, `${width} x ${height}`);
    const [x, y] = await page.evaluate(() => window.isoatlas.project([0, -20, 0]));
    const scale = await page.evaluate(() => {
      const {width: w, height: h} = document.getElementById("view").getBoundingClientRect();
      const bar = document.querySelector(".scale-line").getBBox();
      return [(bar.x + bar.width / 2) / w, (bar.y + bar.height) / h];
    });
    const [corner, ball, bar] = await pixels(page, bytes, [
      [0.01, 0.01],
      [x / box.width, y / box.height],
      scale,
    ]);
    const background = await page.evaluate(() =>
      getComputedStyle(document.querySelector(".stage")).backgroundColor.match(/\d+/g).map(Number),
    );
    assert.deepEqual(corner, [...background, 255]);
    assert.notDeepEqual(ball, corner, "the mesh is in it");
    assert.notDeepEqual(bar, corner, "the scale is in it");
    assert.equal(
      await page.evaluate(() => window.isoatlas.picture()), before, "the page looks as before");
    assert.deepEqual(trouble, []);
    await close();
  }
});

/** Compares a file with what the tool counts on its triangles. */
function check(path, topology, triangles) {
  if (!process.env.ISOATLAS_TOOL) return;
  const run = (...words) =>
    JSON.parse(execFileSync(process.env.ISOATLAS_TOOL, [...words, "--json"], {encoding: "utf8"}));
  const found = path.endsWith(".glb") ? run("levels", path).levels[0] : run("check", path);
  assert.equal(found.triangles, triangles, path);
  for (const [key, value] of Object.entries(topology)) assert.equal(found[key], value, path);
}

/** Positions of .ply (doubles), to compare with those of the page. */
function plyPositions(bytes) {
  const end = bytes.indexOf("end_header\n") + 11;
  const [, vertices] = bytes.subarray(0, end).toString().match(/element vertex (\d+)/);
  return Array.from({length: Number(vertices)}, (_, v) =>
    [0, 1, 2].map((axis) => bytes.readDoubleLE(end + 24 * v + 8 * axis)),
  );
}

test("meshes in three formats, as shown", {timeout: 3 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("far").path);
  const {results: [result]} = fileOf("far");
  const levels = result.levels.map(({triangles}) => triangles);
  for (const format of ["ply", "glb", "stl"]) {
    await page.locator("#format").selectOption(format);
    for (const level of [0, 2]) {
      await slide(page, "#level", level);
      const {name, path, bytes} = await saved(page, "#save-mesh");
      assert.equal(name, `far_from_the_origin_level_${level + 1}.${format}`);
      if (format === "ply") {
        const positions = plyPositions(bytes);
        assert.equal(positions.length, result.levels[level].vertices);
        assert.ok(positions.every(([x, y]) => Math.abs(x - 1e6) < 90 && Math.abs(y + 1e6) < 90));
        assert.match(bytes.subarray(0, 300).toString(), /comment SPACE=LPS\n/);
      }
      // Floats far from the origin merge vertices of a .stl.
      if (format !== "stl") check(path, {components: 6, genus: 1}, levels[level]);
      else assert.equal(bytes.readUInt32LE(80), levels[level]);
      assert.match(await page.locator("#status").textContent(), /^Saved .*: 6 components, /);
    }
  }
  assert.deepEqual(trouble, []);
  await close();
});

test("only shown components are saved", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("balls").path);
  await page.locator("#only-4").click();
  for (const format of ["stl", "ply", "glb"]) {
    await page.locator("#format").selectOption(format);
    const {path, bytes} = await saved(page, "#save-mesh");
    if (format === "stl") {
      assert.equal(bytes.readUInt32LE(80), 128);
      assert.equal(bytes.length, 84 + 50 * 128);
      assert.match(bytes.subarray(0, 80).toString(), /^SPACE=LPS UNIT=mm isoatlas/);
      // Normals point outward, away from the centre of the ball at (40, 0, 0).
      const at = (k) => bytes.readFloatLE(84 + 4 * k);
      const normal = [0, 1, 2].map(at);
      const corner = [3, 4, 5].map(at).map((v, axis) => v - [40, 0, 0][axis]);
      assert.ok(normal.reduce((sum, v, axis) => sum + v * corner[axis], 0) > 0);
    }
    check(path, {components: 1, genus: 0, boundary_loops: 0}, 128);
    assert.match(
      await page.locator("#status").textContent(), /: 1 of 4 components, 128 triangles\. Cuts/);
  }
  assert.deepEqual(trouble, []);
  await close();
});
