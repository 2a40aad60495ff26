// What is computed of a mesh in the page: aspect ratios, components, normals. Flat arrays in, flat arrays out.

/** Per triangle, shortest edge over longest. */
export function aspectRatios(positions: Float32Array, triangles: Uint32Array): Float32Array {
  const out = new Float32Array(triangles.length / 3);
  const squared = (a: number, b: number): number => {
    const x = positions[3 * a] - positions[3 * b];
    const y = positions[3 * a + 1] - positions[3 * b + 1];
    const z = positions[3 * a + 2] - positions[3 * b + 2];
    return x * x + y * y + z * z;
  };
  for (let t = 0; t < out.length; ++t) {
    const [a, b, c] = [triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]];
    const p = squared(a, b);
    const q = squared(b, c);
    const r = squared(c, a);
    const longest = Math.max(p, q, r);
    out[t] = longest > 0 ? Math.sqrt(Math.min(p, q, r) / longest) : 0;
  }
  return out;
}

/** Per vertex, the component it is in: the one with most vertices is 0. */
export function components(vertices: number, triangles: Uint32Array): {of: Uint32Array; sizes: number[]} {
  const parent = Uint32Array.from({length: vertices}, (_, v) => v);
  const root = (v: number): number => {
    while (parent[v] !== v) {
      parent[v] = parent[parent[v]];
      v = parent[v];
    }
    return v;
  };
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 1; k < 3; ++k) {
      const a = root(triangles[i]);
      const b = root(triangles[i + k]);
      if (a !== b) parent[Math.max(a, b)] = Math.min(a, b);
    }
  }
  const size = new Map<number, number>();
  for (let v = 0; v < vertices; ++v) {
    const r = root(v);
    size.set(r, (size.get(r) ?? 0) + 1);
  }
  const order = [...size].sort((a, b) => b[1] - a[1] || a[0] - b[0]);
  const rank = new Map(order.map(([r], i) => [r, i]));
  return {of: Uint32Array.from(parent, (_, v) => rank.get(root(v))!), sizes: order.map(([, n]) => n)};
}

/** Per vertex, the area vectors of the triangles around it, summed, of length 1. */
export function vertexNormals(positions: Float32Array, triangles: Uint32Array): Float32Array {
  const out = new Float32Array(positions.length);
  const p = positions;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      out[v] += x;
      out[v + 1] += y;
      out[v + 2] += z;
    }
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
    out[i] /= length;
    out[i + 1] /= length;
    out[i + 2] /= length;
  }
  return out;
}

/** Every edge once, as pairs of vertices. */
export function edges(triangles: Uint32Array, vertices: number): Uint32Array {
  const keys = new Float64Array(triangles.length);
  for (let i = 0; i < triangles.length; ++i) {
    const a = triangles[i];
    const b = triangles[i % 3 === 2 ? i - 2 : i + 1];
    keys[i] = Math.min(a, b) * vertices + Math.max(a, b);
  }
  keys.sort();
  const out: number[] = [];
  let last = -1;
  for (const key of keys) {
    if (key === last) continue;
    last = key;
    out.push(Math.floor(key / vertices), key % vertices);
  }
  return Uint32Array.from(out);
}
