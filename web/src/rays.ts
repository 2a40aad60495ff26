// SPDX-License-Identifier: Apache-2.0
// Where a ray crosses triangles: what is under the pointer, and whether a point is hidden.

export interface Ray {
  from: ArrayLike<number>;
  along: ArrayLike<number>;
}

/**
 * Visits the crossings of a line with triangles, in the order of the triangles.
 * @param positions 3 per vertex
 * @param triangles 3 vertices per triangle; null: positions are 3 corners per triangle
 * @param visit gets the triangle, its distance along the line in lengths of `along` (it can be
 *        negative), the weights of its second and third corner, and whether the line enters the
 *        side that the triangle faces away from; it returns true to stop
 * @returns whether a visit stopped the search
 * @cost a few operations per triangle: about 10 ms for a million triangles
 */
export function visitCrossings(
  positions: Float32Array,
  triangles: Uint32Array | null,
  {from, along}: Ray,
  visit: (triangle: number, at: number, second: number, third: number, enters: boolean) => boolean,
): boolean {
  const p = positions;
  const [ox, oy, oz] = [from[0], from[1], from[2]];
  const [dx, dy, dz] = [along[0], along[1], along[2]];
  const corners = triangles ? triangles.length : p.length / 3;
  for (let i = 0; i < corners; i += 3) {
    const a = 3 * (triangles ? triangles[i] : i);
    const b = 3 * (triangles ? triangles[i + 1] : i + 1);
    const c = 3 * (triangles ? triangles[i + 2] : i + 2);
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const hx = dy * vz - dz * vy, hy = dz * vx - dx * vz, hz = dx * vy - dy * vx;
    const det = ux * hx + uy * hy + uz * hz;
    if (det === 0) continue;
    const sx = ox - p[a], sy = oy - p[a + 1], sz = oz - p[a + 2];
    const second = (sx * hx + sy * hy + sz * hz) / det;
    if (second < 0 || second > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const third = (dx * qx + dy * qy + dz * qz) / det;
    if (third < 0 || second + third > 1) continue;
    const at = (vx * qx + vy * qy + vz * qz) / det;
    if (visit(i / 3, at, second, third, det > 0)) return true;
  }
  return false;
}

/** Whether the ray hits a triangle other than `own` farther than `least` from its start. */
export function isHidden(
  positions: Float32Array,
  triangles: Uint32Array,
  own: number,
  ray: Ray,
  least: number,
): boolean {
  return visitCrossings(
    positions,
    triangles,
    ray,
    (triangle, at) => triangle !== own && at > least,
  );
}

/** The part of a line that cuts leave, in lengths of `along`. */
export interface Span {
  first: number;
  last: number;
}

/** A point of a surface, or of the filled section of a cut if `triangle` is null. */
export interface Hit {
  /** Distance along the ray, in lengths of `along`. */
  at: number;
  triangle: number | null;
  /** Weights of the three corners. */
  weights: [number, number, number];
}

/** What a ray can hit. */
export interface Target {
  /** 3 per vertex. */
  positions: Float32Array;
  triangles: Uint32Array;
  isShown: (triangle: number) => boolean;
  /** Whether the triangles of outer surfaces face inward. */
  facesInward: boolean;
  /**
   * Set if the ray starts on a filled cut: which triangles bound the filled solid, and the
   * triangles that close its open ends, 3 corners each.
   */
  filled: {bounds: (triangle: number) => boolean; closing: Float32Array} | null;
}

/** The first visible point on a line. @param span the part of the line that cuts leave */
export function firstHit(target: Target, ray: Ray, {first, last}: Span): Hit | null {
  const {positions, triangles, isShown, facesInward, filled} = target;
  let best: Hit | null = null;
  let exits = 0;  // number of exits from the solid beyond the start, minus that of entries
  const exit = (enters: boolean): number => (enters === facesInward ? 1 : -1);
  visitCrossings(positions, triangles, ray, (triangle, at, second, third, enters) => {
    if (at < first || !isShown(triangle)) return false;
    if (filled?.bounds(triangle)) exits += exit(enters);
    if (at <= last && (!best || at < best.at))
      best = {at, triangle, weights: [1 - second - third, second, third]};
    return false;
  });
  if (filled) {
    visitCrossings(filled.closing, null, ray, (_triangle, at, _second, _third, enters) => {
      if (at >= first) exits += exit(enters);
      return false;
    });
    if (exits > 0 && first <= last) return {at: first, triangle: null, weights: [0, 0, 0]};
  }
  return best;
}
