// SPDX-License-Identifier: Apache-2.0
// The server of `isoatlas view`, at the address of the page: what it offers, and its messages.
import type {LevelFacts, Mesh, Triple} from "../data";

/** An option of `isoatlas extract` without dashes, and its value; "" for a flag. */
export type Option = [name: string, value: string];

export type Side = "above" | "below";

export interface Volume {
  schema: "isoatlas-view-1";
  version: string;
  title: string;
  path: string;
  size: Triple;
  sample_type: string;
  minimum: number;
  maximum: number;
  /** Number of NaN and infinite samples. */
  not_finite: number;
  spacing: Triple;
  /** mm, µm, ...; "" if the volume states none. */
  unit: string;
  /** Rows of the matrix from (i, j, k, 1) to world coordinates. */
  index_to_world: [number, number, number, number][];
  /** Whether world coordinates are LPS of a patient; or `input`, as in a report. */
  anatomical?: boolean;
  input?: Record<string, unknown>;
  histogram: Histogram;
  suggested: {isovalue: number; reason: string}[];
  isovalue: number;
  inside: Side;
  /** First and last sample along each axis. */
  roi: [number, number][] | null;
  warnings: string[];
  formats: string[];
  defaults: Record<string, string>;
}

export interface Histogram {
  /** Start of the first bin. */
  lowest: number;
  /** Width of a bin. */
  width: number;
  of_integers: boolean;
  counts: number[];
}

export interface MeshHeader {
  vertices: number;
  triangles: number;
  centre: Triple;
  half: Triple;
  unit: string;
  /** Time to make the mesh. */
  seconds: number;
  /** The number of samples along each axis that were made one; 1: the whole volume. */
  reduction: number;
  facts: LevelFacts;
  /** Numbers of components of the isosurface. */
  kept: number;
  dropped: number;
  /** The largest dropped ones. `size` is the enclosed volume. */
  dropped_components: {size: number; position: Triple}[];
}

export interface MadeMesh {
  header: MeshHeader;
  mesh: Mesh;
}

export interface SavedMessage {
  type: "saved";
  request: number;
  id: number;
  name: string;
  bytes: number;
  /** Whether the mesh satisfies all bounds. */
  satisfied: boolean;
  /** Lines about the mesh, which state bounds that are violated. */
  summary: string;
}

export type Message =
  | {type: "progress"; request: number; stage: string; fraction: number | null}
  | {type: "mesh"; request: number; id: number; reduction: number; final: boolean}
  | SavedMessage
  | {type: "failed"; request: number; message: string}
  | {type: "cancelled"; request: number}
  | {type: "bye"; message: string};

/** The server has refused a request. The message is one line for the user. */
export class Refused extends Error {}

const PROBE_AFTER = 400;  // ms
const ENDED = "isoatlas view has ended.";

/** Numbers of requests, larger than those of earlier pages. */
let lastRequest = 0;
export const nextRequest = (): number => (lastRequest = Math.max(lastRequest + 1, Date.now()));

export class Server {
  private events: EventSource | null = null;
  private hasEnded = false;

  /**
   * @param ended called once, when no message can arrive any more: the server cannot be reached, or
   *        refuses to send them to this page. Gets sentences for the user
   */
  constructor(
    private readonly heard: (message: Message) => void,
    private readonly ended: (why: string) => void,
  ) {}

  async volume(): Promise<Volume> {
    const volume = (await (await this.get("volume")).json()) as Volume;
    if (volume.schema !== "isoatlas-view-1")
      throw new Error(`the schema of its volume is ${volume.schema}, expected isoatlas-view-1`);
    return volume;
  }

  async slice(axis: number, index: number): Promise<Float32Array> {
    return new Float32Array(await (await this.get(`slices/${axis}/${index}`)).arrayBuffer());
  }

  async mesh(id: number): Promise<MadeMesh> {
    return readMesh(await (await this.get(`meshes/${id}`)).arrayBuffer());
  }

  /** @throws Refused with the server's line */
  async post<T>(name: string, body: object): Promise<T> {
    const init = {
      method: "POST",
      headers: {"Content-Type": "application/json"},
      body: JSON.stringify(body),
    };
    return (await (await this.get(name, init)).json()) as T;
  }

  /** Receives messages. @param opened called when they can arrive, at first and after a gap */
  listen(opened: () => void): void {
    if (this.hasEnded) return;
    const events = new EventSource("events");
    this.events = events;
    events.addEventListener("message", ({data}) => {
      const message = JSON.parse(data as string) as Message;
      if (message.type === "bye") this.end(`${ENDED} ${message.message}`);
      else this.heard(message);
    });
    events.addEventListener("error", () => {
      if (events.readyState === EventSource.CLOSED) void this.closed(opened);
      // The browser connects again, and states the last message that it got. If there is no server
      // any more, it would try for ever.
      else setTimeout(() => void this.probe(), PROBE_AFTER);
    });
    events.addEventListener("open", opened);
  }

  /** Finds out why the server has answered a request for messages with something else. */
  private async closed(opened: () => void): Promise<void> {
    const abort = new AbortController();
    try {
      const response = await fetch("events", {cache: "no-store", signal: abort.signal});
      if (response.ok) setTimeout(() => this.listen(opened), PROBE_AFTER);
      else {
        this.end(
          `isoatlas view does not serve this page: ${await refusalOf(response)}. ` +
            "Then reload this page.",
        );
      }
    } catch {
      this.lost();
    }
    abort.abort();
  }

  private async probe(): Promise<void> {
    if (this.hasEnded || this.events?.readyState === EventSource.OPEN) return;
    try {
      await fetch("volume", {method: "GET", cache: "no-store"});
    } catch {
      this.lost();
    }
  }

  private lost(): void {
    this.end(`${ENDED} It does not answer any more.`);
  }

  private end(why: string): void {
    if (this.hasEnded) return;
    this.hasEnded = true;
    this.events?.close();
    this.ended(why);
  }

  private async get(name: string, init?: RequestInit): Promise<Response> {
    let response: Response;
    try {
      response = await fetch(name, init);
    } catch {
      this.lost();
      throw new Refused("isoatlas view has ended");
    }
    if (response.ok) return response;
    throw new Refused(await refusalOf(response));
  }
}

/** The line of the server in an answer that is not ok. */
async function refusalOf(response: Response): Promise<string> {
  const {error} = (await response.json().catch(() => ({}))) as {error?: string};
  const name = new URL(response.url).pathname.split("/").slice(2).join("/");
  return error ?? `${name}: the server answered ${response.status}`;
}

/** uint32 L, L bytes of JSON, 3 float32 per vertex, 3 uint32 per triangle. */
function readMesh(bytes: ArrayBuffer): MadeMesh {
  const length = new DataView(bytes).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(bytes, 4, length));
  const header = JSON.parse(text) as MeshHeader;
  const {vertices, triangles, centre, half, facts} = header;
  const start = 4 + length;
  const level = {
    facts,
    vertices,
    positions: new Float32Array(bytes, start, 3 * vertices),
    triangles: new Uint32Array(bytes, start + 12 * vertices, 3 * triangles),
    distance: null,
    nested: true,
  };
  return {header, mesh: {levels: [level], centre, half, levelOf: new Uint8Array()}};
}
