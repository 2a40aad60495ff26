// SPDX-License-Identifier: Apache-2.0
// Computations on a mesh, from flat arrays to flat arrays.
import type {AspectRatio} from "./data";

/** Per triangle, its shortest edge divided by its longest edge. */
export function aspectRatios(positions: Float32Array, triangles: Uint32Array): Float32Array {
  const out = new Float32Array(triangles.length / 3);
  const squared = (a: number, b: number): number => {
    const x = positions[3 * a] - positions[3 * b];
    const y = positions[3 * a + 1] - positions[3 * b + 1];
    const z = positions[3 * a + 2] - positions[3 * b + 2];
    return x * x + y * y + z * z;
  };
  for (let t = 0; t < out.length; ++t) {
    const a = triangles[3 * t];
    const b = triangles[3 * t + 1];
    const c = triangles[3 * t + 2];
    const p = squared(a, b);
    const q = squared(b, c);
    const r = squared(c, a);
    const longest = Math.max(p, q, r);
    out[t] = longest > 0 ? Math.sqrt(Math.min(p, q, r) / longest) : 0;
  }
  return out;
}

/** The statistics of aspect ratios in a report, for files without them. */
export function aspectFacts(ratios: Float32Array): AspectRatio {
  const histogram = new Array<number>(20).fill(0);
  let below = 0;
  for (const ratio of ratios) {
    ++histogram[Math.min(Math.floor(ratio * 20), 19)];
    if (ratio < 1 / 3) ++below;
  }
  return {
    minimum: ratios.reduce((least, ratio) => Math.min(least, ratio), 1),
    share_below_third: below / (ratios.length || 1),
    histogram,
  };
}

export interface Component {
  vertices: number;
  triangles: number;
  genus: number;
  boundaryLoops: number;
}

export interface Components {
  /** Per vertex, the number of its component; component 0 has the most triangles. */
  of: Uint32Array;
  list: Component[];
  /** The vertices of each boundary loop, in the order of the triangles' sides. */
  loops: number[][];
}

/** Components of a manifold mesh and their topology, counted on the triangles. */
export function components(vertices: number, triangles: Uint32Array): Components {
  const parent = Uint32Array.from({length: vertices}, (_, v) => v);
  const root = (v: number): number => {
    while (parent[v] !== v) {
      parent[v] = parent[parent[v]];
      v = parent[v];
    }
    return v;
  };
  // Half-edges by their start vertex, to check whether the opposite half-edge exists.
  const start = new Uint32Array(vertices + 1);
  for (const v of triangles) ++start[v + 1];
  for (let v = 0; v < vertices; ++v) start[v + 1] += start[v];
  const filled = start.slice(0, vertices);
  const end = new Uint32Array(triangles.length);
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const from = triangles[i + k];
      const to = triangles[i + ((k + 1) % 3)];
      end[filled[from]++] = to;
      const a = root(from);
      const b = root(to);
      if (a !== b) parent[Math.max(a, b)] = Math.min(a, b);
    }
  }
  const has = (from: number, to: number): boolean => {
    for (let i = start[from]; i < start[from + 1]; ++i) if (end[i] === to) return true;
    return false;
  };
  interface Count extends Component {
    root: number;
    boundaryEdges: number;
  }
  const byRoot = new Map<number, Count>();
  const countOf = (v: number): Count => {
    const r = root(v);
    let count = byRoot.get(r);
    if (!count) {
      byRoot.set(
        r,
        (count = {
          root: r,
          vertices: 0,
          triangles: 0,
          boundaryEdges: 0,
          genus: 0,
          boundaryLoops: 0,
        }),
      );
    }
    return count;
  };
  for (let i = 0; i < triangles.length; i += 3) ++countOf(triangles[i]).triangles;
  const next = new Map<number, number>();  // the next vertex along the boundary
  for (let v = 0; v < vertices; ++v) {
    if (start[v] === start[v + 1]) continue;  // in no triangle
    const count = countOf(v);
    ++count.vertices;
    for (let i = start[v]; i < start[v + 1]; ++i) {
      if (has(end[i], v)) continue;
      next.set(v, end[i]);
      ++count.boundaryEdges;
    }
  }
  const seen = new Set<number>();
  const loops: number[][] = [];
  for (const first of next.keys()) {
    if (seen.has(first)) continue;
    ++countOf(first).boundaryLoops;
    const loop: number[] = [];
    for (let v: number | undefined = first; v !== undefined && !seen.has(v); v = next.get(v)) {
      seen.add(v);
      loop.push(v);
    }
    loops.push(loop);
  }
  const list = [...byRoot.values()].sort((a, b) => b.triangles - a.triangles || a.root - b.root);
  const rank = new Uint32Array(vertices);
  list.forEach((count, i) => {
    rank[count.root] = i;
    const euler =
      count.vertices - (3 * count.triangles + count.boundaryEdges) / 2 + count.triangles;
    count.genus = (2 - euler - count.boundaryLoops) / 2;
  });
  return {of: Uint32Array.from({length: vertices}, (_, v) => rank[root(v)]), list, loops};
}

/** Per vertex, the unit normal: the angle-weighted mean of the normals of its triangles. */
export function vertexNormals(positions: Float32Array, triangles: Uint32Array): Float32Array {
  const out = new Float32Array(positions.length);
  const p = positions;
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i];
    const b = 3 * triangles[i + 1];
    const c = 3 * triangles[i + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const wx = vx - ux, wy = vy - uy, wz = vz - uz;
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const area = Math.sqrt(x * x + y * y + z * z);
    if (!(area > 0)) continue;
    const atA = Math.atan2(area, ux * vx + uy * vy + uz * vz);
    const atB = Math.atan2(area, -(ux * wx + uy * wy + uz * wz));
    const atC = Math.PI - atA - atB;
    out[a] += (atA * x) / area, out[a + 1] += (atA * y) / area, out[a + 2] += (atA * z) / area;
    out[b] += (atB * x) / area, out[b + 1] += (atB * y) / area, out[b + 2] += (atB * z) / area;
    out[c] += (atC * x) / area, out[c + 1] += (atC * y) / area, out[c + 2] += (atC * z) / area;
  }
  for (let i = 0; i < out.length; i += 3) {
    const length =
      Math.sqrt(out[i] * out[i] + out[i + 1] * out[i + 1] + out[i + 2] * out[i + 2]) || 1;
    out[i] /= length;
    out[i + 1] /= length;
    out[i + 2] /= length;
  }
  return out;
}

/** Signed volume: negative if triangles face inward on the whole. */
export function enclosedVolume(positions: Float32Array, triangles: Uint32Array): number {
  const p = positions;
  let sum = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i];
    const b = 3 * triangles[i + 1];
    const c = 3 * triangles[i + 2];
    sum +=
      p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]) +
      p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]) +
      p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
  }
  return sum / 6;
}
