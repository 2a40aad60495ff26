// SPDX-License-Identifier: Apache-2.0
// Makes pages of made-up results in the format of the tool ("isoatlas-page-2"), to test the page
// without the tool. As a program, `node make_page.mjs FOLDER` writes all of them.
import {mkdirSync, readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";
import {fileURLToPath} from "node:url";

import {MeshoptEncoder, bundleFolder} from "./modules.mjs";

await MeshoptEncoder.ready;
// Debian's libmeshoptimizer 0.18 writes version 0 of the vertex codec and by default 1 of the index
// codec.
const VERTEX_CODEC = 0;

/** A closed or open grid of u by v quads on the surface `of`: [0, 1)^2 -> R^3, oriented outward. */
function grid(u, v, of, closed = true) {
  const positions = [];
  const triangles = [];
  const columns = closed ? v : v + 1;
  for (let i = 0; i < u; ++i) for (let j = 0; j < columns; ++j) positions.push(of(i / u, j / v));
  const at = (i, j) => (i % u) * columns + (closed ? j % v : j);
  for (let i = 0; i < u; ++i) {
    for (let j = 0; j < v; ++j) {
      triangles.push(
        [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
        [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
      );
    }
  }
  return {positions, triangles};
}

export function torus(u, v, [cx, cy, cz], radius, tube) {
  return grid(u, v, (s, t) => {
    const [a, b] = [2 * Math.PI * s, 2 * Math.PI * t];
    const bump = 1 + 0.16 * Math.sin(3 * a) * Math.cos(2 * b);
    return [
      cx + Math.cos(a) * (radius + tube * bump * Math.cos(b)),
      cy + Math.sin(a) * (radius + tube * bump * Math.cos(b)),
      cz + tube * bump * Math.sin(b),
    ];
  });
}

/** A tube that is open at both ends: genus 0, two boundary loops. */
export function tubePiece(u, v, [cx, cy, cz], radius, length) {
  return grid(u, v, (s, t) => {
    const a = 2 * Math.PI * s;
    const r = radius * (1 + 0.25 * Math.sin(2 * Math.PI * t));
    return [cx + r * Math.cos(a), cy + r * Math.sin(a), cz + length * (t - 0.5)];
  }, false);
}

export function sphere(times, [cx, cy, cz], radius) {
  let positions = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
  let triangles = [
    [0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4],
    [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5],
  ];
  for (let k = 0; k < times; ++k) ({positions, triangles} = subdivide({positions, triangles}));
  return {
    positions: positions.map((p) =>
      p.map((x, i) => [cx, cy, cz][i] + (radius * x) / Math.hypot(...p)),
    ),
    triangles,
  };
}

/**
 * Splits each triangle into four. Old vertices keep their indices, as in nested levels.
 * @param selects by the triangle's vertices: whether it is split
 */
export function subdivide({positions, triangles}, selects = () => true) {
  const out = positions.slice();
  const middle = new Map();
  const between = (a, b) => {
    const key = `${Math.min(a, b)} ${Math.max(a, b)}`;
    if (!middle.has(key))
      middle.set(key, out.push(out[a].map((x, i) => (x + out[b][i]) / 2)) - 1);
    return middle.get(key);
  };
  const subdivided = triangles.flatMap(([a, b, c]) => {
    if (!selects([a, b, c])) return [[a, b, c]];
    const [d, e, f] = [between(a, b), between(b, c), between(c, a)];
    return [[a, d, f], [d, b, e], [f, e, c], [d, e, f]];
  });
  return {positions: out, triangles: subdivided};
}

export function join_meshes(...meshes) {
  const positions = [];
  const triangles = [];
  for (const mesh of meshes) {
    const first = positions.length;
    for (const p of mesh.positions) positions.push(p);
    for (const t of mesh.triangles) triangles.push(t.map((v) => v + first));
  }
  return {positions, triangles};
}

function aspect({positions, triangles}) {
  const histogram = new Array(20).fill(0);
  const ratios = triangles.map(([a, b, c]) => {
    const length = (p, q) => Math.hypot(...positions[p].map((x, i) => x - positions[q][i]));
    const edges = [length(a, b), length(b, c), length(c, a)];
    const ratio = Math.min(...edges) / Math.max(...edges);
    ++histogram[Math.min(Math.floor(ratio * 20), 19)];
    return ratio;
  }).sort((a, b) => a - b);
  const at = (share) => ratios[Math.floor(share * (ratios.length - 1))];
  return {
    minimum: ratios[0],
    p01: at(0.01),
    median: at(0.5),
    share_below_third: ratios.filter((r) => r < 1 / 3).length / ratios.length,
    histogram,
  };
}

export class Geometry {
  parts = [];
  length = 0;

  add(bytes) {
    const range = {offset: this.length, bytes: bytes.length};
    this.parts.push(bytes);
    this.length += bytes.length;
    return range;
  }

  positions(points, origin, step) {
    const integers = Uint32Array.from(
      points.flatMap((p) => p.map((x, i) => Math.max(0, Math.round((x - origin[i]) / step)))),
    );
    const bytes = MeshoptEncoder.encodeVertexBufferLevel(
      new Uint8Array(integers.buffer),
      points.length,
      12,
      2,
      VERTEX_CODEC,
    );
    return {...this.add(bytes), count: points.length, origin, step};
  }

  triangles(triangles) {
    const bytes = MeshoptEncoder.encodeIndexBuffer(
      new Uint8Array(Uint32Array.from(triangles.flat()).buffer),
      3 * triangles.length,
      4,
    );
    return {...this.add(bytes), count: triangles.length};
  }

  base64() {
    return Buffer.concat(this.parts).toString("base64");
  }
}

/**
 * @param levels meshes, coarse to fine; each starts with the vertices of the previous level
 * @param topology {components, genus, loops, kinds}
 */
export function makeResult(geometry, levels, topology, options = {}) {
  const finest = levels[levels.length - 1];
  const low = [0, 1, 2].map((i) =>
    finest.positions.reduce((least, p) => Math.min(least, p[i]), Infinity),
  );
  const high = [0, 1, 2].map((i) =>
    finest.positions.reduce((most, p) => Math.max(most, p[i]), -Infinity),
  );
  const step = Math.max(...high.map((h, i) => h - low[i])) / 65535;
  const placed = options.placed ?? false;
  const shared = placed ? levels[levels.length - 1].positions : finest.positions;
  const facts = levels.map((mesh, level) => ({
    level,
    vertices: mesh.positions.length,
    triangles: mesh.triangles.length,
    components: topology.components,
    euler_characteristic: topology.euler,
    genus: topology.genus,
    boundary_loops: topology.loops,
    kinds: topology.kinds,
    ...(options.inverted_components === undefined
      ? {}
      : {inverted_components: options.inverted_components}),
    self_intersections:
      level === 0 ? 0 : options.self_intersections === undefined ? 0 : options.self_intersections,
    certificate: {
      passed: true,
      cells_checked: mesh.positions.length,
      arcs_checked: mesh.positions.length * 3,
      triples_checked: mesh.triangles.length,
      repair_rounds: 1,
      repair_sites: 4,
    },
    quality: {aspect_ratio: aspect(mesh), angle_degrees: {minimum: 21, maximum: 110}},
    metrics:
      options.distances === false
        ? null
        : {"max-distance": {maximum: 1.6842 / 4 ** level, mean: 0.4 / 4 ** level, unit: "world"}},
    ...(level === 2 ? {distance_at_most: 0.106} : {}),
    constraints:
      level === 0
        ? []
        : [
            {
              quantity: "max-distance",
              bound: 1.7 / 4 ** level,
              reached: 1.6842 / 4 ** level,
              unit: "world",
              satisfied: true,
              default: false,
              reason: null,
            },
            {
              quantity: "min-aspect",
              bound: 1 / 3,
              reached: 0.31,
              unit: "ratio",
              satisfied: false,
              default: true,
              reason: "178 cells are at the resolution limit; supersampling would help there",
            },
          ],
  }));
  return {
    title: options.title ?? "ring_and_ball.nhdr",
    unit: options.unit ?? "mm",
    command:
      options.command === undefined
        ? "isoatlas extract ring_and_ball.nhdr --iso 100 --refine max-distance:1.7 " +
          "--refine max-distance:0.42 -o ring.glb --html ring.html"
        : options.command,
    parameters:
      options.parameters === undefined
        ? {
            space: "lps",
            supersample: 1,
            keep_components: options.kept?.parts ?? 0,
            max_radius: null,
            placement: placed ? "balanced" : "surface",
            refine: [[{quantity: "max-distance", bound: 0.42}]],
            vertices_on_surface: true,
          }
        : options.parameters,
    input:
      options.input === undefined
        ? {
            path: "ring_and_ball.nhdr",
            sample_type: "uint8",
            size: [96, 96, 64],
            spacing: [1, 1, 1.5],
            origin: [0, 0, 0],
            direction: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            format: "NRRD",
            decisions: [{key: "space", value: "left-posterior-superior"}],
          }
        : options.input,
    surface:
      options.surface === undefined
        ? {isovalue: 100, inside: "above", topology: "trilinear"}
        : options.surface,
    reference:
      options.reference === undefined
        ? {
            c_vertices: 40000,
            components: topology.components,
            euler_characteristic: topology.euler,
            genus: topology.genus,
            boundary_loops: topology.loops,
            kinds: topology.kinds,
          }
        : options.reference,
    ...(options.kept ? {kept: options.kept, dropped: options.dropped} : {}),
    levels: facts,
    marching_cubes:
      options.marching_cubes === undefined
        ? {
            triangles: 84312,
            histogram: [
              4100, 4000, 3800, 3700, 3900, 4000, 4200, 4100, 4000, 4300, 4600, 5000, 5400, 7900,
              9800, 5200, 2900, 1800, 1100, 512,
            ],
            share_below_third: 0.341,
            minimum: 0.0004,
          }
        : options.marching_cubes,
    geometry: {
      positions: geometry.positions(shared, low, step),
      levels: levels.map((mesh, level) => ({
        vertices: mesh.positions.length,
        triangles: geometry.triangles(mesh.triangles),
        ...(placed ? {own_positions: geometry.positions(mesh.positions, low, step)} : {}),
        ...(options.distances === false
          ? {}
          : {
              distance: {
                ...geometry.add(
                  Uint8Array.from(mesh.positions, (p) =>
                    Math.round(255 * (0.5 + 0.5 * Math.sin(0.21 * p[0] - 0.13 * p[2])) ** 2),
                  ),
                ),
                maximum: 1.6842 / 4 ** level,
              },
            }),
      })),
    },
  };
}

/** JSON for HTML, with `<` escaped. */
const safe = (value) => JSON.stringify(value).replaceAll("<", "\\u003c");
const text = (value) => value.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

export function assemble(results, geometry) {
  const [script, style] = ["page.js", "page.css"].map((name) =>
    readFileSync(join(bundleFolder, name), "utf8"),
  );
  const data = safe({schema: "isoatlas-page-2", version: "0.1.0", results});
  return `<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${text(results[0].title)}</title><style>${style}</style></head><body>
<noscript>This page needs JavaScript.</noscript>
<script type="application/json" id="isoatlas-data">${data}</script>
<script type="text/plain" id="isoatlas-geometry">${geometry.base64()}</script>
<script>${script}</script></body></html>
`;
}

function nested(mesh, levels) {
  const out = [mesh];
  while (out.length < levels) out.push(subdivide(out[out.length - 1]));
  return out;
}

/** A ring around a ball, an open tube, and three small balls. */
function ringAndBall(levels, u = 18, v = 9, offset = [0, 0, 0]) {
  const at = (x, y, z) => [x + offset[0], y + offset[1], z + offset[2]];
  const parts = [
    torus(u, v, at(0, 0, 0), 40, 15),
    sphere(1, at(0, 0, 3), 14),
    tubePiece(8, 6, at(52, 30, 24), 6, 30),
  ];
  for (let k = 0; k < 3; ++k) parts.push(sphere(0, at(-50 + 9 * k, 38 + 6 * k, 26), 3.4 - 0.7 * k));
  return nested(join_meshes(...parts), levels);
}

const RING = {
  components: 6,
  euler: 8,
  genus: 1,
  loops: 2,
  kinds: [
    {genus: 0, boundary_loops: 0, count: 4},
    {genus: 1, boundary_loops: 0, count: 1},
    {genus: 0, boundary_loops: 2, count: 1},
  ],
};
const TORUS = {
  components: 1,
  euler: 0,
  genus: 1,
  loops: 0,
  kinds: [{genus: 1, boundary_loops: 0, count: 1}],
};

function page(...make) {
  const geometry = new Geometry();
  const results = make.map((one) => one(geometry));
  return {html: assemble(results, geometry), results};
}

/** The facts in a file of another program: no shapes, kinds or certificate. */
function terse(result) {
  for (const level of result.levels)
    for (const key of ["quality", "kinds", "certificate", "constraints"]) delete level[key];
  return result;
}

function dust(count) {
  const balls = Array.from({length: count}, (_, i) =>
    sphere(0, [12 * (i % 6), 12 * Math.floor(i / 6), 5 * Math.sin(i)], 2 + (i % 7) / 2),
  );
  return [join_meshes(...balls)];
}

/** Turns all triangles around. */
const flip = ({positions, triangles}) => ({
  positions,
  triangles: triangles.map(([a, b, c]) => [a, c, b]),
});

/**
 * A ball of radius 20 with a cavity of radius 8, a ball of radius 10 beside it, and above them an
 * open tube.
 */
function balls(geometry, {title = "balls", flipped = false} = {}) {
  const mesh = join_meshes(
    sphere(4, [0, 0, 0], 20),
    flip(sphere(3, [0, 0, 0], 8)),
    sphere(2, [40, 0, 0], 10),
    tubePiece(24, 6, [0, 0, 40], 6, 20),
  );
  const topology = {
    components: 4,
    euler: 6,
    genus: 0,
    loops: 2,
    kinds: [
      {genus: 0, boundary_loops: 0, count: 3},
      {genus: 0, boundary_loops: 2, count: 1},
    ],
  };
  return makeResult(geometry, [flipped ? flip(mesh) : mesh], topology, {title});
}

export const pages = {
  ring: () => page((g) => makeResult(g, ringAndBall(4), RING, {inverted_components: 0})),
  // 1,600 to 102,400 triangles.
  large: () =>
    page((g) =>
      makeResult(g, nested(torus(40, 20, [0, 0, 0], 40, 16), 4), TORUS, {title: "large.nrrd"}),
    ),
  balanced: () =>
    page((g) => {
      const [coarse, fine] = ringAndBall(2);
      const shrunk = {
        positions: coarse.positions.map((p) => p.map((x) => 0.97 * x)),
        triangles: coarse.triangles,
      };
      return makeResult(g, [shrunk, fine], RING, {
        placed: true,
        title: "balanced",
        inverted_components: 1,
        kept: {components: 3, parts: 1, largest: 12.5},
        dropped: {components: 7, parts: 7, largest: 0.25},
      });
    }),
  bare: () =>
    page((g) =>
      makeResult(g, ringAndBall(2), RING, {
        title: "bare.glb",
        distances: false,
        command: null,
        parameters: null,
        input: null,
        surface: null,
        reference: null,
        marching_cubes: null,
        self_intersections: null,
      }),
    ),
  terse: () => page((g) => terse(makeResult(g, ringAndBall(3), RING, {title: "terse.vtm"}))),
  hostile: () =>
    page((g) =>
      makeResult(g, ringAndBall(2), RING, {
        title: "</script><b>bold</b><img src=x onerror=alert(1)>",
        command:
          "isoatlas extract '</script><script>document.title=\"owned\"</script><!--' --iso 1",
        input: {path: "<script>a</script>.nrrd", size: [1, 2, 3]},
      }),
    ),
  far: () =>
    page((g) =>
      makeResult(g, ringAndBall(3, 18, 9, [1e6, -1e6, 1e6]), RING, {title: "far from the origin"}),
    ),
  balls: () => page(balls),
  // Samples below the isovalue are inside: all triangles face the other way.
  inverted: () => page((g) => balls(g, {title: "inverted", flipped: true})),
  // Only the finest of two levels is in the files.
  finest: () =>
    page((g) => {
      const result = makeResult(g, ringAndBall(1), RING, {title: "finest.stl"});
      result.levels[0].level = 1;
      result.nested = false;
      return result;
    }),
  // Three triangles share an edge.
  torn: () =>
    page((g) => {
      const mesh = {
        positions: [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [0, 0, -4]],
        triangles: [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
      };
      const topology = {components: 1, euler: null, genus: null, loops: null, kinds: null};
      const result = makeResult(g, [mesh], topology, {title: "torn", reference: null});
      Object.assign(result.levels[0], {manifold: false, certificate: null});
      return result;
    }),
  // The ball has fewer triangles than the ring in the coarse level, and more in the fine one.
  reordered: () =>
    page((g) => {
      const ball = sphere(0, [40, 0, 0], 10);
      const coarse = join_meshes(ball, torus(9, 5, [0, 0, 0], 20, 6));
      let fine = coarse;
      for (let k = 0; k < 3; ++k)
        fine = subdivide(fine, (corners) => corners.some((v) => fine.positions[v][0] > 29));
      const topology = {
        components: 2,
        euler: 2,
        genus: 1,
        loops: 0,
        kinds: [
          {genus: 0, boundary_loops: 0, count: 1},
          {genus: 1, boundary_loops: 0, count: 1},
        ],
      };
      return makeResult(g, [coarse, fine], topology, {title: "reordered"});
    }),
  several: () =>
    page(
      (g) => makeResult(g, ringAndBall(3), RING, {title: "first"}),
      (g) =>
        makeResult(g, nested(torus(12, 7, [9, 9, 9], 30, 12), 2), TORUS, {
          title: "second",
          unit: "voxels",
          input: {path: "second.tif", format: "TIFF", size: [64, 64, 64]},
        }),
    ),
  dust: () =>
    page((g) =>
      makeResult(
        g,
        dust(31),
        {
          components: 31,
          euler: 62,
          genus: 0,
          loops: 0,
          kinds: [{genus: 0, boundary_loops: 0, count: 31}],
        },
        {title: "dust"},
      ),
    ),
};

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const folder = process.argv[2] ?? "build/pages";
  mkdirSync(folder, {recursive: true});
  for (const [name, make] of Object.entries(pages)) {
    const {html} = make();
    writeFileSync(join(folder, `${name}.html`), html);
    console.log(`${name}.html: ${(html.length / 1e6).toFixed(2)} MB`);
  }
}
