// SPDX-License-Identifier: Apache-2.0
// Extent, area and enclosed volume of each component of a mesh.
import type {Triple} from "./data";

export interface Measures {
  /** Corners of the bounding box. */
  low: Triple;
  high: Triple;
  /** In square units of the positions. */
  area: number;
  /**
   * In cubic units of the positions: above 0 if the triangles face outward, below 0 if they face
   * inward, as around a cavity. Meaningless for a component with boundary loops.
   */
  volume: number;
}

/**
 * Measures all components. Sums are in doubles.
 * @param positions 3 per vertex
 * @param of per vertex, the number of its component
 * @param count number of components
 */
export function componentMeasures(
  positions: Float32Array,
  triangles: Uint32Array,
  of: Uint32Array,
  count: number,
): Measures[] {
  const p = positions;
  const out = Array.from(
    {length: count},
    (): Measures => ({
      low: [Infinity, Infinity, Infinity],
      high: [-Infinity, -Infinity, -Infinity],
      area: 0,
      volume: 0,
    }),
  );
  const origin = firstCorners(positions, triangles, of, count);
  for (let i = 0; i < triangles.length; i += 3) {
    const component = of[triangles[i]];
    const measures = out[component];
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const o = 3 * component;
    measures.area += Math.sqrt(x * x + y * y + z * z) / 2;
    // The tetrahedron of the triangle and a vertex of the component: small terms, small errors.
    measures.volume +=
      (x * (p[a] - origin[o]) + y * (p[a + 1] - origin[o + 1]) + z * (p[a + 2] - origin[o + 2])) /
      6;
    for (const corner of [a, b, c]) {
      for (let axis = 0; axis < 3; ++axis) {
        const at = p[corner + axis];
        if (at < measures.low[axis]) measures.low[axis] = at;
        if (at > measures.high[axis]) measures.high[axis] = at;
      }
    }
  }
  return out;
}

/** Per component, the position of one of its vertices. */
function firstCorners(
  positions: Float32Array,
  triangles: Uint32Array,
  of: Uint32Array,
  count: number,
): Float64Array {
  const out = new Float64Array(3 * count);
  const known = new Uint8Array(count);
  for (const v of triangles) {
    const component = of[v];
    if (known[component]) continue;
    known[component] = 1;
    out.set(positions.subarray(3 * v, 3 * v + 3), 3 * component);
  }
  return out;
}
