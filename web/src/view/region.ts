// SPDX-License-Identifier: Apache-2.0
// The region of interest: first and last sample along each axis, both included.
import type {Triple} from "../data";

export type Ends = [first: number, last: number];

export class Region {
  readonly ends: [Ends, Ends, Ends];

  constructor(private readonly size: Triple) {
    this.ends = size.map((n): Ends => [0, n - 1]) as [Ends, Ends, Ends];
  }

  get isWhole(): boolean {
    return this.ends.every(([first, last], axis) => first === 0 && last === this.size[axis] - 1);
  }

  reset(): void {
    this.size.forEach((n, axis) => (this.ends[axis] = [0, n - 1]));
  }

  /** Why these ends cannot be; "" if they can. */
  problem(axis: number, [first, last]: Ends): string {
    const most = this.size[axis] - 1;
    if (![first, last].every(Number.isInteger)) return "Expected whole numbers of samples.";
    if (first < 0 || last > most) return `Expected samples from 0 to ${most}.`;
    if (last <= first) return "The last sample has to be after the first one.";
    return "";
  }

  /** @returns false if these ends cannot be */
  set(axis: number, ends: Ends): boolean {
    if (this.problem(axis, ends)) return false;
    this.ends[axis] = ends;
    return true;
  }

  /** Moves one end as far as it can be moved towards a position. */
  drag(axis: number, end: 0 | 1, to: number): void {
    const [first, last] = this.ends[axis];
    const at = Math.round(to);
    this.ends[axis] =
      end === 0
        ? [Math.min(Math.max(at, 0), last - 1), last]
        : [first, Math.max(Math.min(at, this.size[axis] - 1), first + 1)];
  }

  /** As the option --roi. */
  get text(): string {
    return this.ends
      .map(([first, last], axis) =>
        first === 0 && last === this.size[axis] - 1 ? ":" : `${first}:${last}`,
      )
      .join(",");
  }
}
