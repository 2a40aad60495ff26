// SPDX-License-Identifier: Apache-2.0
// Slices of the volume, fetched when they are first shown. Keeps the last ones.
import type {Triple} from "../data";
import type {Server} from "./server";

const MOST_BYTES = 64e6;

/** A slice across an axis. The earlier of the two other axes is the faster one. */
export interface Slice {
  axis: number;
  index: number;
  samples: Float32Array;
  /** Distance in `samples` between neighbours along each axis of the volume. */
  strides: Triple;
}

export class SliceStore {
  private readonly kept = new Map<string, Slice>();  // the one used last is the last one
  private bytes = 0;
  /** Per axis, the slice that is being fetched, and the one to fetch next. */
  private readonly running: [boolean, boolean, boolean] = [false, false, false];
  private readonly next: (number | null)[] = [null, null, null];

  /** @param arrived called for each slice */
  constructor(
    private readonly server: Server,
    private readonly size: Triple,
    private readonly arrived: (slice: Slice) => void,
    private readonly failed: (reason: unknown) => void,
  ) {}

  /** A slice that is here. */
  get(axis: number, index: number): Slice | null {
    const key = `${axis}/${index}`;
    const found = this.kept.get(key);
    if (!found) return null;
    this.kept.delete(key);
    this.kept.set(key, found);
    return found;
  }

  /** Fetches a slice, unless a later one of this axis is wanted before its turn. */
  want(axis: number, index: number): void {
    if (this.kept.has(`${axis}/${index}`)) {
      this.next[axis] = null;
      return;
    }
    this.next[axis] = index;
    if (!this.running[axis]) void this.fetchNext(axis);
  }

  private async fetchNext(axis: number): Promise<void> {
    this.running[axis] = true;
    for (let index = this.next[axis]; index !== null; index = this.next[axis]) {
      this.next[axis] = null;
      try {
        const slice = {axis, index, samples: await this.server.slice(axis, index),
          strides: this.strides(axis)};
        this.keep(slice);
        this.arrived(slice);
      } catch (reason) {
        this.failed(reason);
      }
    }
    this.running[axis] = false;
  }

  private strides(axis: number): Triple {
    const out: Triple = [0, 0, 0];
    const [fast, slow] = [0, 1, 2].filter((other) => other !== axis);
    out[fast] = 1;
    out[slow] = this.size[fast];
    return out;
  }

  private keep(slice: Slice): void {
    this.kept.set(`${slice.axis}/${slice.index}`, slice);
    this.bytes += slice.samples.byteLength;
    for (const [key, old] of this.kept) {
      if (this.bytes <= MOST_BYTES || old === slice) break;
      this.kept.delete(key);
      this.bytes -= old.samples.byteLength;
    }
  }
}
