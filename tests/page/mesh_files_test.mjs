// SPDX-License-Identifier: Apache-2.0
// The files that pages save. Needs no browser.
import assert from "node:assert/strict";
import {test} from "node:test";

import {imported} from "./source.mjs";

const {meshFile} = await imported("mesh_files.ts");

const mesh = {
  positions: Float32Array.from([-1, -1, 0, 1, -1, 0, 0, 2, 0]),
  centre: [1000, 2000, -3000],
  triangles: Uint32Array.from([0, 1, 2]),
};

test("an .stl is in millimetres if the unit is known", () => {
  for (const [unit, scale] of [["um", 1e-3], ["mm", 1], ["cm", 10], ["units", 1], ["voxels", 1]]) {
    const bytes = Buffer.from(meshFile("stl", mesh, {comment: "c", space: "LPS", unit}));
    assert.equal(bytes.length, 84 + 50);
    const isKnown = unit.length === 2;
    assert.equal(
      bytes.subarray(0, 80).toString().replaceAll("\0", ""),
      isKnown ? "SPACE=LPS UNIT=mm c" : "SPACE=LPS c",
    );
    [999, 1999, -3000].forEach((v, axis) =>
      assert.ok(Math.abs(bytes.readFloatLE(84 + 12 + 4 * axis) - v * scale) < 1e-3 * scale, unit),
    );
    // The normal is a direction.
    assert.deepEqual([0, 1, 2].map((axis) => bytes.readFloatLE(84 + 4 * axis)), [0, 0, 1]);
  }
});

test("other formats keep the unit", () => {
  const ply = Buffer.from(meshFile("ply", mesh, {comment: "c", space: null, unit: "um"}));
  const end = ply.indexOf("end_header\n") + "end_header\n".length;
  assert.equal(ply.readDoubleLE(end), 999);
});
