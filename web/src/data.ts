// What the tool puts into the page, and how it is read: JSON for facts, one base64 text for all geometry.
// The format is described in docs/report.md ("isoatlas-page-1"); its writer is src/page/ of the tool.
import {MeshoptDecoder} from "meshoptimizer";

/** Bytes of the geometry text. */
interface Range {
  offset: number;
  bytes: number;
}

/** Positions are origin + step * integers. */
interface QuantisedPositions extends Range {
  count: number;
  origin: [number, number, number];
  step: number;
}

interface LevelGeometry {
  vertices: number;
  triangles: Range & {count: number};
  /** With balanced placement each level has positions of its own. */
  placed?: QuantisedPositions;
  /** Per vertex, the largest distance of its cell from the surface, in steps of maximum / 255; absent: not known. */
  distance?: Range & {maximum: number};
}

export interface Kind {
  genus: number;
  boundary_loops: number;
  count: number;
}

export interface LevelFacts {
  level: number;
  vertices: number;
  triangles: number;
  components: number;
  euler_characteristic: number;
  genus: number;
  boundary_loops: number;
  kinds: Kind[];
  self_intersections?: number | null;
  certificate?: {passed: boolean; cells_checked: number; arcs_checked: number; triples_checked: number; repair_sites: number};
  quality: {
    aspect_ratio: {minimum: number; p01: number; median: number; share_below_third: number; histogram: number[]};
    angle_degrees: {minimum: number; maximum: number};
  };
  metrics?: Record<string, {maximum: number | null; mean: number | null; unit: string}> | null;
  constraints?: {quantity: string; wanted: number; reached: number; unit: string; met: boolean; reason: string | null}[];
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
  levels: LevelFacts[];
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
  /** 3 per vertex. */
  positions: Float32Array;
  /** 3 per triangle. */
  triangles: Uint32Array;
  /** Per vertex, in the result's unit; null: not known. */
  distance: Float32Array | null;
}

export interface Mesh {
  levels: Level[];
  /** Added to the positions gives those in the file: near the origin floats are finer. */
  centre: [number, number, number];
  /** Per vertex of the finest level, the level that brought it. */
  levelOf: Uint8Array;
}

export function readPage(): Page {
  const page = JSON.parse(document.getElementById("isoatlas-data")!.textContent!) as Page;
  if (page.schema !== "isoatlas-page-1") throw new Error(`this page does not know ${String(page.schema)}`);
  return page;
}

async function bytesOfBase64(text: string): Promise<Uint8Array> {
  const answer = await fetch(`data:application/octet-stream;base64,${text}`);
  return new Uint8Array(await answer.arrayBuffer());
}

let geometry: Promise<Uint8Array> | null = null;

function geometryBytes(): Promise<Uint8Array> {
  geometry ??= bytesOfBase64(document.getElementById("isoatlas-geometry")!.textContent!.trim());
  return geometry;
}

function positionsOf(source: Uint8Array, from: QuantisedPositions, centre: readonly number[]): Float32Array {
  const grid = new Uint8Array(12 * from.count);
  MeshoptDecoder.decodeVertexBuffer(grid, from.count, 12, source.subarray(from.offset, from.offset + from.bytes));
  const integers = new Uint32Array(grid.buffer);
  const out = new Float32Array(integers.length);
  for (let i = 0; i < out.length; ++i) out[i] = from.origin[i % 3] - centre[i % 3] + from.step * integers[i];
  return out;
}

function trianglesOf(source: Uint8Array, from: Range & {count: number}): Uint32Array {
  const out = new Uint8Array(12 * from.count);
  MeshoptDecoder.decodeIndexBuffer(out, 3 * from.count, 4, source.subarray(from.offset, from.offset + from.bytes));
  return new Uint32Array(out.buffer);
}

export async function readMesh(result: Result): Promise<Mesh> {
  await MeshoptDecoder.ready;
  const source = await geometryBytes();
  const {positions, levels} = result.geometry;
  const middle = (axis: number): number => positions.origin[axis];
  const centre: [number, number, number] = [middle(0), middle(1), middle(2)];
  const shared = positionsOf(source, positions, centre);
  const levelOf = new Uint8Array(positions.count);
  let before = 0;
  const read = levels.map((level, k): Level => {
    levelOf.fill(k, before, level.vertices);
    before = level.vertices;
    let distance: Float32Array | null = null;
    if (level.distance) {
      const {offset, bytes, maximum} = level.distance;
      distance = Float32Array.from(source.subarray(offset, offset + bytes), (step) => (step * maximum) / 255);
    }
    return {
      facts: result.levels[k],
      positions: level.placed ? positionsOf(source, level.placed, centre) : shared.subarray(0, 3 * level.vertices),
      triangles: trianglesOf(source, level.triangles),
      distance,
    };
  });
  return {levels: read, centre, levelOf};
}
