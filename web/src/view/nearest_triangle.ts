// SPDX-License-Identifier: Apache-2.0
// The triangle of a mesh that is nearest to a point.
import {Triangle, Vector3} from "three";

import type {Triple} from "../data";

interface Triangles {
  positions: Float32Array;
  triangles: Uint32Array;
}

/** Length of the longest edge. */
export function longestEdge({positions, triangles}: Triangles): number {
  let longest = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [3 * triangles[t + k], 3 * triangles[t + ((k + 1) % 3)]];
      longest = Math.max(
        longest,
        (positions[b] - positions[a]) ** 2 +
          (positions[b + 1] - positions[a + 1]) ** 2 +
          (positions[b + 2] - positions[a + 2]) ** 2,
      );
    }
  }
  return Math.sqrt(longest);
}

/**
 * @param edge length of the longest edge: triangles with a vertex that is farther are skipped
 * @param most the largest distance
 * @returns the number of the triangle; null: all are farther
 */
export function nearestTriangle(
  {positions, triangles}: Triangles,
  edge: number,
  point: Triple,
  most: number,
): number | null {
  const [x, y, z] = point;
  const at = new Vector3(x, y, z);
  const corners = new Triangle();
  const closest = new Vector3();
  let least = most;
  let nearest: number | null = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const v = 3 * triangles[t];
    const squared =
      (positions[v] - x) ** 2 + (positions[v + 1] - y) ** 2 + (positions[v + 2] - z) ** 2;
    if (squared > (least + edge) ** 2) continue;
    corners.a.fromArray(positions, v);
    corners.b.fromArray(positions, 3 * triangles[t + 1]);
    corners.c.fromArray(positions, 3 * triangles[t + 2]);
    const distance = corners.closestPointToPoint(at, closest).distanceTo(at);
    if (distance < least) [least, nearest] = [distance, t / 3];
  }
  return nearest;
}
