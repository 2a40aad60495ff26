// SPDX-License-Identifier: Apache-2.0
// Writes a mesh into the bytes of a file: .glb, .ply or .stl.
import type {Triple} from "./data";

export interface TriangleMesh {
  /** 3 per vertex, relative to `centre`. */
  positions: Float32Array;
  centre: Triple;
  /** 3 vertices per triangle. */
  triangles: Uint32Array;
}

/** What a file states about its mesh. */
export interface MeshInfo {
  /** One line of ASCII. */
  comment: string;
  /** "LPS" or "RAS", as 3D Slicer reads it from .ply and .stl files; null: not stated. */
  space: string | null;
  /** Symbol of the unit of positions: A, nm, um, mm, cm, m or in. Others are not known. */
  unit: string;
}

const MILLIMETRES = new Map([
  ["A", 1e-7], ["nm", 1e-6], ["um", 1e-3], ["mm", 1], ["cm", 10], ["m", 1000], ["in", 25.4],
]);

export type MeshFormat = "glb" | "ply" | "stl";

/** The triangles that `keeps` selects, with only the vertices that they use. */
export function partOf(mesh: TriangleMesh, keeps: (triangle: number) => boolean): TriangleMesh {
  const {positions, centre, triangles} = mesh;
  const kept: number[] = [];
  const numberOf = new Int32Array(positions.length / 3).fill(-1);
  const vertices: number[] = [];
  for (let i = 0; i < triangles.length; i += 3) {
    if (!keeps(i / 3)) continue;
    for (let k = 0; k < 3; ++k) {
      const v = triangles[i + k];
      if (numberOf[v] < 0) numberOf[v] = vertices.push(v) - 1;
      kept.push(numberOf[v]);
    }
  }
  const out = new Float32Array(3 * vertices.length);
  vertices.forEach((v, i) => out.set(positions.subarray(3 * v, 3 * v + 3), 3 * i));
  return {positions: out, centre, triangles: Uint32Array.from(kept)};
}

export function meshFile(format: MeshFormat, mesh: TriangleMesh, info: MeshInfo): Uint8Array {
  switch (format) {
    case "glb": return glb(mesh, info);
    case "ply": return ply(mesh, info);
    case "stl": return stl(mesh, info);
  }
}

const bytesOf = (text: string): Uint8Array => new TextEncoder().encode(text);

/** Binary PLY. Positions are doubles, because meshes can be far from the origin. */
function ply({positions, centre, triangles}: TriangleMesh, {comment, space}: MeshInfo): Uint8Array {
  const [vertices, count] = [positions.length / 3, triangles.length / 3];
  const header = bytesOf(
    [
      "ply",
      "format binary_little_endian 1.0",
      `comment ${comment}`,
      ...(space ? [`comment SPACE=${space}`] : []),
      `element vertex ${vertices}`,
      "property double x",
      "property double y",
      "property double z",
      `element face ${count}`,
      "property list uchar int vertex_indices",
      "end_header\n",
    ].join("\n"),
  );
  const out = new Uint8Array(header.length + 24 * vertices + 13 * count);
  out.set(header);
  const view = new DataView(out.buffer);
  let at = header.length;
  positions.forEach((v, i) => view.setFloat64(at + 8 * i, v + centre[i % 3], true));
  at += 24 * vertices;
  for (let i = 0; i < triangles.length; i += 3, at += 13) {
    view.setUint8(at, 3);
    for (let k = 0; k < 3; ++k) view.setInt32(at + 1 + 4 * k, triangles[i + k], true);
  }
  return out;
}

/**
 * Binary STL. Positions are floats, as the format requires. If the unit is known, they are in
 * millimetres, as programs for printing read them.
 */
function stl({positions, centre, triangles}: TriangleMesh, info: MeshInfo): Uint8Array {
  const {comment, space, unit} = info;
  const scale = MILLIMETRES.get(unit);
  const out = new Uint8Array(84 + (50 * triangles.length) / 3);
  // A header that starts with "solid" would be read as text.
  const header = [space ? `SPACE=${space}` : "STL", ...(scale ? ["UNIT=mm"] : []), comment];
  out.set(bytesOf(header.join(" ")).subarray(0, 80));
  const view = new DataView(out.buffer);
  view.setUint32(80, triangles.length / 3, true);
  const corner = new Float32Array(9);
  for (let i = 0, at = 84; i < triangles.length; i += 3, at += 50) {
    for (let k = 0; k < 9; ++k)
      corner[k] =
        (positions[3 * triangles[i + Math.floor(k / 3)] + (k % 3)] + centre[k % 3]) * (scale ?? 1);
    normalOf(corner).forEach((v, axis) => view.setFloat32(at + 4 * axis, v, true));
    corner.forEach((v, k) => view.setFloat32(at + 12 + 4 * k, v, true));
  }
  return out;
}

/** The unit normal of a triangle; 0 if it has no area, so that readers compute their own. */
function normalOf(p: Float32Array): Triple {
  const [ux, uy, uz] = [p[3] - p[0], p[4] - p[1], p[5] - p[2]];
  const [vx, vy, vz] = [p[6] - p[0], p[7] - p[1], p[8] - p[2]];
  const normal: Triple = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const length = Math.hypot(...normal);
  return length > 0 ? (normal.map((v) => v / length) as Triple) : [0, 0, 0];
}

/** glTF 2.0. Positions are floats relative to the translation of the node. */
function glb(mesh: TriangleMesh, {comment}: MeshInfo): Uint8Array {
  const {positions, centre, triangles} = mesh;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((v, i) => {
    low[i % 3] = Math.min(low[i % 3], v);
    high[i % 3] = Math.max(high[i % 3], v);
  });
  const FLOAT = 5126;
  const UNSIGNED_INT = 5125;
  const json = {
    asset: {version: "2.0", generator: comment},
    scene: 0,
    scenes: [{nodes: [0]}],
    nodes: [{mesh: 0, translation: centre}],
    meshes: [{primitives: [{attributes: {POSITION: 0}, indices: 1}]}],
    accessors: [
      {
        bufferView: 0,
        componentType: FLOAT,
        count: positions.length / 3,
        type: "VEC3",
        min: low,
        max: high,
      },
      {bufferView: 1, componentType: UNSIGNED_INT, count: triangles.length, type: "SCALAR"},
    ],
    bufferViews: [
      {buffer: 0, byteOffset: 0, byteLength: positions.byteLength, target: 34962},
      {
        buffer: 0,
        byteOffset: positions.byteLength,
        byteLength: triangles.byteLength,
        target: 34963,
      },
    ],
    buffers: [{byteLength: positions.byteLength + triangles.byteLength}],
  };
  const text = bytesOf(JSON.stringify(json));
  const padded = Math.ceil(text.length / 4) * 4;  // chunks have a multiple of 4 bytes
  const binary = positions.byteLength + triangles.byteLength;
  const out = new Uint8Array(12 + 8 + padded + 8 + binary);
  const view = new DataView(out.buffer);
  [0x46546c67, 2, out.length, padded, 0x4e4f534a].forEach((word, i) =>
    view.setUint32(4 * i, word, true),
  );
  out.fill(0x20, 20, 20 + padded);
  out.set(text, 20);
  view.setUint32(20 + padded, binary, true);
  view.setUint32(24 + padded, 0x004e4942, true);
  let at = 28 + padded;
  positions.forEach((v, i) => view.setFloat32(at + 4 * i, v, true));
  at += positions.byteLength;
  triangles.forEach((v, i) => view.setUint32(at + 4 * i, v, true));
  return out;
}
