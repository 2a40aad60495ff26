// SPDX-License-Identifier: Apache-2.0
// Modules of the page of `isoatlas view` that need no browser.
import assert from "node:assert/strict";
import {describe, test} from "node:test";

import {imported} from "./source.mjs";

const {isoline} = await imported("view/isoline.ts");
const {parseIsovalue, snapped, stepOf, ends, shareBelow, ticks} =
  await imported("view/isovalue.ts");
const {Region} = await imported("view/region.ts");
const {Grid} = await imported("view/grid.ts");
const {defaultRange, paint, palette} = await imported("view/grey.ts");
const {longestEdge, nearestTriangle} = await imported("view/nearest_triangle.ts");

const everything = {left: 0, right: Infinity, top: 0, bottom: Infinity};
const rule = (isovalue, more = {}) => ({
  isovalue,
  inside: "above",
  nan: "below",
  offset: 10,
  ...more,
});
const slice = (width, height, value) => {
  const samples = new Float32Array(width * height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) samples[y * width + x] = value(x, y);
  return {samples, width, height, right: 1, down: width};
};
const segmentsOf = (flat) =>
  Array.from({length: flat.length / 4}, (_, i) => [...flat.subarray(4 * i, 4 * i + 4)]);

describe("isoline", () => {
  test("of a ball: a closed line on its circle", () => {
    const circle = slice(40, 30, (x, y) => 10 - Math.hypot(x - 19.2, y - 14.7));
    for (const inside of ["above", "below"]) {
      const segments = segmentsOf(isoline(circle, rule(2, {inside}), everything));
      assert.ok(segments.length > 40);
      const count = new Map();
      for (const [ax, ay, bx, by] of segments) {
        for (const [x, y] of [[ax, ay], [bx, by]]) {
          assert.ok(Math.abs(Math.hypot(x - 19.2, y - 14.7) - 8) < 0.03);
          const key = `${x.toFixed(3)} ${y.toFixed(3)}`;
          count.set(key, (count.get(key) ?? 0) + 1);
        }
      }
      assert.deepEqual([...new Set(count.values())], [2], "each end belongs to two segments");
    }
  });

  test("a plane is where it is, in transposed slices, too", () => {
    const {samples} = slice(5, 4, (x) => x);
    for (const [ax, , bx] of segmentsOf(
      isoline({samples, width: 5, height: 4, right: 1, down: 5}, rule(1.25), everything)))
      assert.deepEqual([ax, bx], [1.25, 1.25]);
    const turned = segmentsOf(
      isoline({samples, width: 4, height: 5, right: 5, down: 1}, rule(1.25), everything));
    assert.equal(turned.length, 3);
    for (const [, ay, , by] of turned) assert.deepEqual([ay, by], [1.25, 1.25]);
  });

  test("opposite corners are connected if the saddle is inside", () => {
    const connected = (a, b, c, d, iso) => {
      const square = slice(2, 2, (x, y) => [[a, b], [d, c]][y][x]);
      const segments = segmentsOf(isoline(square, rule(iso), everything));
      assert.equal(segments.length, 2);
      // Whether the upper left corner is cut off from its neighbours by a segment of its own.
      return segments.some(([ax, ay, bx, by]) => Math.min(ax, bx) === 0 && Math.min(ay, by) === 0);
    };
    // The saddle of 3, 0, 3, 0 is 1.5.
    assert.equal(connected(3, 0, 3, 0, 1), false, "the inside corners are connected");
    assert.equal(connected(3, 0, 3, 0, 2), true, "they are separate");
    assert.equal(connected(0, 3, 0, 3, 1), true, "the outside corners are cut off");
    assert.equal(connected(0, 3, 0, 3, 2), false);
  });

  test("NaN samples are on their side", () => {
    const half = slice(6, 3, (x) => (x < 3 ? NaN : 8));
    const at = (nan, isovalue) => segmentsOf(isoline(half, rule(isovalue, {nan}), everything));
    for (const [ax, , bx] of at("below", 5)) {
      assert.equal(ax, bx);
      assert.ok(ax > 2 && ax < 3);
    }
    assert.equal(at("below", 5).length, 2);
    assert.equal(at("above", 5).length, 0);
    assert.equal(at("above", 9).length, 2);
    const infinite = slice(4, 2, (x) => (x < 2 ? -Infinity : Infinity));
    assert.equal(isoline(infinite, rule(0), everything).length, 4);
  });

  test("only the part that is visible", () => {
    const stripes = slice(100, 100, (x) => x % 2);
    const all = isoline(stripes, rule(0.5), everything).length / 4;
    assert.equal(all, 99 * 99);
    const part = isoline(stripes, rule(0.5), {left: 10, right: 20, top: -5, bottom: 4});
    assert.equal(part.length / 4, 10 * 4);
  });

  test("a slice of 512 x 512 takes a few ms", () => {
    const waves = slice(512, 512, (x, y) => Math.sin(x / 5) + Math.sin(y / 7));
    const run = () => {
      const begin = performance.now();
      isoline(waves, rule(0.3), everything);
      return performance.now() - begin;
    };
    const least = Math.min(...Array.from({length: 10}, run));
    console.log(`isoline of 512 x 512: ${least.toFixed(1)} ms`);
    assert.ok(least < 200);
  });
});

const bytes = {
  minimum: 0,
  maximum: 255,
  histogram: {lowest: 0, width: 1, of_integers: true, counts: new Array(256).fill(1)},
};
const floats = {
  minimum: -2,
  maximum: 3,
  histogram: {lowest: -2, width: 0.01, of_integers: false, counts: new Array(500).fill(2)},
};

describe("isovalues", () => {
  test("numbers, and words for everything else", () => {
    for (const [text, value] of [["100", 100], [" 80.5 ", 80.5], ["1e2", 100], [".5", 0.5]])
      assert.deepEqual(parseIsovalue(text, bytes), {value});
    assert.deepEqual(parseIsovalue("−1.5", floats), {value: -1.5});
    for (const [text, problem] of [
      ["", /^Expected a number like 300\.5\.$/],
      ["abc", /Expected a number like 300\.5, got “abc”/],
      ["1.2.3", /got “1\.2\.3”/],
      ["NaN", /got “NaN”/],
      ["0x10", /got “0x10”/],
      ["80,5", /decimal point: 80\.5/],
      ["300", /no isosurface at 300: samples are from 0 to 255/],
      ["1e999", /no isosurface/],
    ])
      assert.match(parseIsovalue(text, bytes).problem, problem);
  });

  test("steps: half-way between integers, round numbers otherwise", () => {
    assert.equal(stepOf(bytes), 1);
    assert.equal(snapped(99.9, 1, bytes), 99.5);
    assert.equal(snapped(-3, 1, bytes), 0.5);
    assert.equal(snapped(999, 1, bytes), 254.5);
    assert.equal(stepOf(floats), 0.01);
    assert.equal(snapped(0.30000000000000004, 0.01, floats), 0.3);
    assert.equal(snapped(7, 0.01, floats), 3);
    assert.deepEqual(ends(bytes), [-0.5, 255.5]);
    assert.equal(shareBelow(63.5, bytes), 0.25);
    assert.equal(shareBelow(0.5, floats), 0.5);
    assert.deepEqual(ticks([-0.5, 255.5], 6), [0, 50, 100, 150, 200, 250]);
  });
});

test("window and level leave out half a per cent at both ends", () => {
  const counts = new Array(100).fill(0);
  counts[0] = 1000, counts[1] = 3, counts[50] = 500, counts[98] = 2, counts[99] = 2;
  const {low, high} = defaultRange({lowest: 10, width: 2, counts, of_integers: false});
  assert.deepEqual([low, high], [10, 10 + 2 * 51]);
  const flat = defaultRange({lowest: 0, width: 1, counts: [10_000, 1, 1], of_integers: true});
  assert.deepEqual(flat, {low: 0, high: 3});
});

test("pixels: grey, tinted inside, another colour for NaN, nothing beyond the samples", () => {
  const of = slice(4, 1, (x) => [0, 100, 200, NaN][x]);
  const pixels = new Uint32Array(6);
  paint(pixels, 6, 1, {startX: -1, stepX: 1, startY: 0, stepY: 1}, of, {
    range: {low: 0, high: 255},
    rule: rule(150),
    colours: palette([0, 0, 255]),
    notFinite: [10, 20, 30],
    smooth: true,
  });
  const rgba = (v) => [v & 255, (v >> 8) & 255, (v >> 16) & 255, v >>> 24];
  assert.deepEqual([...pixels].map(rgba), [
    [0, 0, 0, 0],
    [0, 0, 0, 255],
    [100, 100, 100, 255],
    [140, 140, 217, 255],
    [10, 20, 30, 255],
    [0, 0, 0, 0],
  ]);
});

test("the region of interest", () => {
  const region = new Region([10, 20, 30]);
  assert.ok(region.isWhole);
  assert.equal(region.text, ":,:,:");
  assert.ok(region.set(1, [3, 8]));
  assert.equal(region.text, ":,3:8,:");
  for (const ends of [[5, 5], [-1, 3], [0, 20], [0.5, 3], [NaN, 4], [8, 3]])
    assert.ok(!region.set(1, ends) && region.problem(1, ends), `${ends}`);
  region.drag(1, 0, 99);
  assert.deepEqual(region.ends[1], [7, 8], "an end stops before the other one");
  region.drag(1, 1, 1e9);
  assert.deepEqual(region.ends[1], [7, 19]);
  region.reset();
  assert.ok(region.isWhole);
});

describe("slices on the screen", () => {
  const grid = (rows, anatomical = true) =>
    new Grid({
      size: [10, 20, 30],
      spacing: [1, 1, 1],
      unit: "mm",
      anatomical,
      index_to_world: rows,
    });
  const endsOf = (of, axis) => {
    const {name, ends: {left, right, top, bottom}} = of.plane(axis);
    return [name, left, right, top, bottom].join(" ");
  };

  test("in LPS, right is left and anterior or superior is up", () => {
    const lps = grid([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]);
    assert.equal(endsOf(lps, 2), "Axial R L A P");
    assert.equal(endsOf(lps, 1), "Coronal R L S I");
    assert.equal(endsOf(lps, 0), "Sagittal A P S I");
    assert.deepEqual(lps.plane(1).down, {axis: 2, sign: -1});
  });

  test("flipped and permuted axes look the same", () => {
    // x towards R, y towards A, z towards I.
    const flipped = grid([[-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0]]);
    assert.equal(endsOf(flipped, 2), "Axial R L A P");
    assert.deepEqual(flipped.plane(2).right, {axis: 0, sign: -1});
    // x towards P, y towards I, z towards L: sagittal slices.
    const sagittal = grid([[0, 0, 1, 0], [1, 0, 0, 0], [0, -1, 0, 0]]);
    assert.equal(endsOf(sagittal, 2), "Sagittal A P S I");
    assert.equal(endsOf(sagittal, 0), "Coronal R L S I");
    assert.deepEqual(sagittal.plane(0).right, {axis: 2, sign: 1});
  });

  test("oblique directions have several letters; others have axes", () => {
    const [c, s] = [Math.cos(0.6), Math.sin(0.6)];
    const oblique = grid([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0]]);
    assert.equal(endsOf(oblique, 2), "Axial RA LP AL PR");
    const plain = grid([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], false);
    assert.equal(endsOf(plain, 2), " −x +x −y +y");
    assert.equal(endsOf(plain, 0), " −y +y +z −z");
  });

  test("world coordinates", () => {
    const of = grid([[0, 2, 0, 5], [3, 0, 0, 6], [0, 0, 4, 7]]);
    assert.deepEqual(of.world([1, 2, 3]), [9, 9, 19]);
  });
});

test("the nearest triangle is not that of the nearest vertex", () => {
  const mesh = {
    positions: Float32Array.of(0, 0, 0, 30, 0, 0, 0, 40, 0, 10, 10, 3, 11, 10, 3, 10, 11, 3),
    triangles: Uint32Array.of(0, 1, 2, 3, 4, 5),
  };
  assert.equal(longestEdge(mesh), 50);
  const nearest = (point, most) => nearestTriangle(mesh, longestEdge(mesh), point, most);
  assert.equal(nearest([10, 10, 1], 4), 0);
  assert.equal(nearest([10, 10, 2], 4), 1);
  assert.equal(nearest([10, 10, -4], 3), null);
});
