// SPDX-License-Identifier: Apache-2.0
// Reads the data of the page: JSON with the facts, and one base64 text with all geometry. The
// format is "isoatlas-page-2"; src/page/ of the tool writes it.
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
  /** The positions of this level, with balanced placement. */
  own_positions?: QuantisedPositions | null;
  /**
   * One byte per vertex: the largest two-sided distance in its Voronoi cell, in steps of
   * maximum / 255; absent if unknown.
   */
  distance?: (Range & {maximum: number}) | null;
}

export interface Kind {
  genus: number;
  boundary_loops: number;
  count: number;
}

export interface Metric {
  /** null: infinite. */
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

/** The number and density of the samples of distances in one direction. */
export interface Sampling {
  samples: number;
  samples_per_voxel_face: number;
}

/** An entry of `levels` in the report. Facts that a file does not contain are absent. */
export interface LevelFacts {
  level: number;
  vertices: number;
  triangles: number;
  components: number;
  /** false: not an oriented manifold; genus and loops are not defined. */
  manifold?: boolean;
  euler_characteristic: number | null;
  genus: number | null;
  boundary_loops: number | null;
  kinds?: Kind[] | null;
  self_intersections?: number | null;
  /** Closed components whose orientation or nesting differs from that on the isosurface. */
  inverted_components?: number | null;
  certificate?: {
    passed: boolean;
    cells_checked: number;
    arcs_checked: number;
    triples_checked: number;
    repair_sites: number;
  } | null;
  quality?: {aspect_ratio?: Partial<AspectRatio> | null} | null;
  metrics?: Record<string, Metric | null> | null;
  measured?: {maximum: number; mesh_to_surface?: Sampling; surface_to_mesh?: Sampling} | null;
  distance_at_most?: number | null;
  constraints?: Constraint[] | null;
}

/**
 * A part consists of the components that the volume boundary connects. `largest` is the volume of
 * the largest part, in cubic units of length.
 */
export interface RankedComponents {
  components: number;
  parts: number;
  largest: number;
}

export interface Result {
  title: string;
  /** Unit of lengths, for display: mm, or voxels. */
  unit: string;
  command: string | null;
  parameters: Record<string, unknown> | null;
  input: Record<string, unknown> | null;
  surface: Record<string, unknown> | null;
  reference:
    | ({
        kinds: Kind[];
        components: number;
        genus: number;
        boundary_loops: number;
        euler_characteristic: number;
      } & Record<string, unknown>)
    | null;
  /** The kept and the dropped components, if the options drop some. */
  kept?: RankedComponents;
  dropped?: RankedComponents;
  levels: LevelFacts[];
  /** false: a vertex can have different indices in different levels. */
  nested?: boolean;
  marching_cubes: {
    triangles: number;
    histogram: number[];
    share_below_third: number;
    minimum: number;
  } | null;
  geometry: {positions: QuantisedPositions; levels: LevelGeometry[]};
}

export interface Page {
  schema: "isoatlas-page-2";
  version: string;
  results: Result[];
}

export interface Level {
  facts: LevelFacts;
  vertices: number;
  /** 3 per vertex, relative to the centre of the mesh. */
  positions: Float32Array;
  /** 3 per triangle. */
  triangles: Uint32Array;
  /** Per vertex in steps of maximum / 255, in the unit of the result; null: unknown. */
  distance: {steps: Uint8Array; maximum: number} | null;
  /** Whether a vertex has the same index in finer levels. */
  nested: boolean;
}

export interface Mesh {
  levels: Level[];
  /** Centre of the bounding box of the finest level. Positions are relative to it, because floats
   * are more precise near 0. */
  centre: Triple;
  /** Half the size of that box. */
  half: Triple;
  /** Per vertex of the finest level, the first level that contains it. */
  levelOf: Uint8Array;
}

export function readPage(): Page {
  const page = JSON.parse(document.getElementById("isoatlas-data")!.textContent!) as Page;
  if (page.schema !== "isoatlas-page-2")
    throw new Error(`its schema is ${String(page.schema)}, expected isoatlas-page-2`);
  if (page.results.length === 0) throw new Error("it has no results");
  return page;
}

let blob: Uint8Array | null = null;

/** Decodes without fetch() of a data URL, which files and strict policies do not allow. */
function geometryBytes(): Uint8Array {
  if (!blob) {
    const holder = document.getElementById("isoatlas-geometry")!;
    const text = atob(holder.textContent!.trim());
    holder.remove();  // megabytes of text that are not needed any more
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
  MeshoptDecoder.decodeVertexBuffer(
    new Uint8Array(grid.buffer),
    from.count,
    12,
    slice(source, from),
  );
  return grid;
}

/** Subtracts in doubles before rounding to float. */
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
  if (from.count > 0) {
    MeshoptDecoder.decodeIndexBuffer(
      new Uint8Array(out.buffer),
      out.length,
      4,
      slice(source, from),
    );
  }
  return out;
}

function boxOf(
  grid: Uint32Array,
  {origin, step}: QuantisedPositions,
): {centre: Triple; half: Triple} {
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
      positions: level.own_positions
        ? positionsOf(gridOf(source, level.own_positions), level.own_positions, centre)
        : shared.subarray(0, 3 * level.vertices),
      triangles: trianglesOf(source, level.triangles),
      distance: level.distance
        ? {steps: slice(source, level.distance), maximum: level.distance.maximum}
        : null,
      nested: result.nested !== false,
    };
  });
  return {levels: read, centre, half, levelOf};
}
