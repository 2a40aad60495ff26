// SPDX-License-Identifier: Apache-2.0
// What the tool puts into the page, and how it is read: JSON for facts, one base64 text for all geometry.
// The format is "isoatlas-page-1"; its writer is src/page/ of the tool.
import {MeshoptDecoder} from "meshoptimizer/decoder";

export type Triple = [number, number, number];

/** Bytes of the geometry text, decoded from base64. */
interface Range {
  offset: number;
  bytes: number;
}

/** Positions are origin + step * integers: uint32 x 3, in meshoptimizer's vertex codec. */
interface QuantisedPositions extends Range {
  count: number;
  origin: Triple;
  step: number;
}

interface LevelGeometry {
  vertices: number;
  /** In meshoptimizer's index codec. */
  triangles: Range & {count: number};
  /** With balanced placement each level has positions of its own. */
  own_positions?: QuantisedPositions | null;
  /** One byte per vertex: the largest distance of its cell from the surface, in steps of maximum / 255; absent: not known. */
  distance?: (Range & {maximum: number}) | null;
}

export interface Kind {
  genus: number;
  boundary_loops: number;
  count: number;
}

export interface Metric {
  /** null: infinity. */
  maximum: number | null;
  mean: number | null;
}

export interface Constraint {
  quantity: string;
  bound: number;
  reached: number | null;
  unit: string;
  satisfied: boolean;
  default?: boolean;
  reason: string | null;
}

export interface AspectRatio {
  minimum: number;
  share_below_third: number;
  /** Bins of equal width over [0, 1]. */
  histogram: number[];
}

/** How densely distances in one direction were sampled. */
export interface Sampling {
  samples: number;
  samples_per_voxel_face: number;
}

/** An object of the report's `levels`. What a file does not tell is absent. */
export interface LevelFacts {
  level: number;
  vertices: number;
  triangles: number;
  components: number;
  /** false: genus and loops mean nothing. */
  manifold?: boolean;
  euler_characteristic: number | null;
  genus: number | null;
  boundary_loops: number | null;
  kinds?: Kind[] | null;
  self_intersections?: number | null;
  /** Closed components that face another way, or lie in another component, than on the isosurface. */
  inverted_components?: number | null;
  certificate?: {passed: boolean; cells_checked: number; arcs_checked: number; triples_checked: number; repair_sites: number} | null;
  quality?: {aspect_ratio?: Partial<AspectRatio> | null} | null;
  metrics?: Record<string, Metric | null> | null;
  measured?: {maximum: number; mesh_to_surface?: Sampling; surface_to_mesh?: Sampling} | null;
  distance_at_most?: number | null;
  constraints?: Constraint[] | null;
}

/** Parts are what the volume's border connects. Sizes are volumes, in cubic units of length; `largest` is that of a part. */
export interface RankedComponents {
  components: number;
  parts: number;
  largest: number;
}

export interface Result {
  title: string;
  /** Unit of lengths, for people: mm, or voxels. */
  unit: string;
  command: string | null;
  parameters: Record<string, unknown> | null;
  input: Record<string, unknown> | null;
  surface: Record<string, unknown> | null;
  reference: ({kinds: Kind[]; components: number; genus: number; boundary_loops: number; euler_characteristic: number} & Record<string, unknown>) | null;
  /** Components by whether they were kept, where smaller ones were left out because that was asked for. */
  kept?: RankedComponents;
  dropped?: RankedComponents;
  levels: LevelFacts[];
  /** false: vertices have other indices in each level. */
  nested?: boolean;
  marching_cubes: {triangles: number; histogram: number[]; share_below_third: number; minimum: number} | null;
  geometry: {positions: QuantisedPositions; levels: LevelGeometry[]};
}

export interface Page {
  schema: "isoatlas-page-1";
  version: string;
  results: Result[];
}

export interface Level {
  facts: LevelFacts;
  vertices: number;
  /** 3 per vertex, from the mesh's centre. */
  positions: Float32Array;
  /** 3 per triangle. */
  triangles: Uint32Array;
  /** Per vertex in steps of maximum / 255, in the result's unit; null: not known. */
  distance: {steps: Uint8Array; maximum: number} | null;
}

export interface Mesh {
  levels: Level[];
  /** The middle of the finest level's box; positions are stored from here, since floats are finer near 0. */
  centre: Triple;
  /** Half the size of that box. */
  half: Triple;
  /** Per vertex of the finest level, the level that brought it. */
  levelOf: Uint8Array;
}

export function readPage(): Page {
  const page = JSON.parse(document.getElementById("isoatlas-data")!.textContent!) as Page;
  if (page.schema !== "isoatlas-page-1") throw new Error(`it is of the kind ${String(page.schema)}, which this page does not know`);
  if (page.results.length === 0) throw new Error("it has no results");
  return page;
}

let blob: Uint8Array | null = null;

/** Not fetch() of a data address: a page opened as a file, or under a strict policy, may not do that. */
function geometryBytes(): Uint8Array {
  if (!blob) {
    const holder = document.getElementById("isoatlas-geometry")!;
    const text = atob(holder.textContent!.trim());
    holder.remove();  // megabytes of text that nobody reads again
    blob = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) blob[i] = text.charCodeAt(i);
  }
  return blob;
}

function slice(source: Uint8Array, {offset, bytes}: Range): Uint8Array {
  if (offset < 0 || offset + bytes > source.length) throw new Error("its geometry is cut off");
  return source.subarray(offset, offset + bytes);
}

function gridOf(source: Uint8Array, from: QuantisedPositions): Uint32Array {
  const grid = new Uint32Array(3 * from.count);
  MeshoptDecoder.decodeVertexBuffer(new Uint8Array(grid.buffer), from.count, 12, slice(source, from));
  return grid;
}

/** The subtraction is done in doubles, before anything is rounded to float. */
function positionsOf(grid: Uint32Array, from: QuantisedPositions, centre: Triple): Float32Array {
  const out = new Float32Array(grid.length);
  for (let axis = 0; axis < 3; ++axis) {
    const start = from.origin[axis] - centre[axis];
    for (let i = axis; i < out.length; i += 3) out[i] = start + from.step * grid[i];
  }
  return out;
}

function trianglesOf(source: Uint8Array, from: Range & {count: number}): Uint32Array {
  const out = new Uint32Array(3 * from.count);
  if (from.count > 0) MeshoptDecoder.decodeIndexBuffer(new Uint8Array(out.buffer), out.length, 4, slice(source, from));
  return out;
}

function boxOf(grid: Uint32Array, {origin, step}: QuantisedPositions): {centre: Triple; half: Triple} {
  const centre: Triple = [...origin];
  const half: Triple = [0, 0, 0];
  for (let axis = 0; axis < 3 && grid.length > 0; ++axis) {
    let low = Infinity;
    let high = -Infinity;
    for (let i = axis; i < grid.length; i += 3) {
      low = Math.min(low, grid[i]);
      high = Math.max(high, grid[i]);
    }
    centre[axis] = origin[axis] + (step * (low + high)) / 2;
    half[axis] = (step * (high - low)) / 2;
  }
  return {centre, half};
}

export async function readMesh(result: Result): Promise<Mesh> {
  await MeshoptDecoder.ready;
  const source = geometryBytes();
  const {positions, levels} = result.geometry;
  const grid = gridOf(source, positions);
  const finest = levels[levels.length - 1].own_positions;
  const {centre, half} = finest ? boxOf(gridOf(source, finest), finest) : boxOf(grid, positions);
  const shared = positionsOf(grid, positions, centre);
  const levelOf = new Uint8Array(levels[levels.length - 1].vertices);
  let before = 0;
  const read = levels.map((level, k): Level => {
    levelOf.fill(k, before, level.vertices);
    before = level.vertices;
    return {
      facts: result.levels[k],
      vertices: level.vertices,
      positions: level.own_positions ? positionsOf(gridOf(source, level.own_positions), level.own_positions, centre) : shared.subarray(0, 3 * level.vertices),
      triangles: trianglesOf(source, level.triangles),
      distance: level.distance ? {steps: slice(source, level.distance), maximum: level.distance.maximum} : null,
    };
  });
  return {levels: read, centre, half, levelOf};
}
