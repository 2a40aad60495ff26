// SPDX-License-Identifier: Apache-2.0
// The isoline of a slice: marching squares with linear interpolation, like the surface in the faces
// of grid cells.
import type {Side} from "./server";

/** Which samples are inside. */
export interface InsideRule {
  isovalue: number;
  inside: Side;
  /** The side of NaN samples. */
  nan: Side;
  /** The distance of the substitute of a sample that is not finite from the isovalue. */
  offset: number;
}

/** Samples of a slice along two directions. */
export interface Samples {
  samples: ArrayLike<number>;
  /** Numbers of samples, and the distances of neighbours in `samples`. */
  width: number;
  height: number;
  right: number;
  down: number;
}

/** Samples first to last, both included. */
export interface SampleRange {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** A sample as a number that is >= 0 inside and < 0 outside. */
export function insideness({isovalue, inside, nan, offset}: InsideRule): (v: number) => number {
  const sign = inside === "above" ? 1 : -1;
  const nanValue = sign * (nan === "above" ? offset : -offset);
  return (v) =>
    v - v === 0  // finite
      ? sign * (v - isovalue)
      : v !== v
        ? nanValue
        : sign * (v > 0 ? offset : -offset);
}

/**
 * The segments of the isoline, 4 numbers each: x and y of both ends, in samples.
 * @param shown the samples that are considered
 * @cost O(samples); a few ms for 512 x 512
 */
export function isoline(of: Samples, rule: InsideRule, shown: SampleRange): Float32Array {
  const {samples, right, down} = of;
  const [left, top] = [Math.max(shown.left, 0), Math.max(shown.top, 0)];
  const columns = Math.min(shown.right, of.width - 1) - left + 1;
  const rows = Math.min(shown.bottom, of.height - 1) - top + 1;
  const value = insideness(rule);
  let out = new Float32Array(1024);
  let end = 0;
  const segment = (ax: number, ay: number, bx: number, by: number): void => {
    if (end + 4 > out.length) {
      const longer = new Float32Array(2 * out.length);
      longer.set(out);
      out = longer;
    }
    out[end] = ax, out[end + 1] = ay, out[end + 2] = bx, out[end + 3] = by;
    end += 4;
  };
  if (columns < 2 || rows < 2) return out.subarray(0, 0);
  let upper = new Float64Array(columns);
  let lower = new Float64Array(columns);
  const read = (into: Float64Array, y: number): void => {
    let at = (top + y) * down + left * right;
    for (let x = 0; x < columns; ++x, at += right) into[x] = value(samples[at]);
  };
  read(lower, 0);
  for (let y = 0; y + 1 < rows; ++y) {
    [upper, lower] = [lower, upper];
    read(lower, y + 1);
    for (let x = 0; x + 1 < columns; ++x) {
      const a = upper[x], b = upper[x + 1], c = lower[x + 1], d = lower[x];
      const corners =
        (a >= 0 ? 1 : 0) | (b >= 0 ? 2 : 0) | (c >= 0 ? 4 : 0) | (d >= 0 ? 8 : 0);
      if (corners === 0 || corners === 15) continue;
      const X = left + x, Y = top + y;
      // Where the isoline crosses the sides of the square.
      const ab = X + a / (a - b), bc = Y + b / (b - c), dc = X + d / (d - c), ad = Y + a / (a - d);
      switch (corners) {
        case 1: case 14: segment(X, ad, ab, Y); break;
        case 2: case 13: segment(ab, Y, X + 1, bc); break;
        case 4: case 11: segment(X + 1, bc, dc, Y + 1); break;
        case 8: case 7: segment(dc, Y + 1, X, ad); break;
        case 3: case 12: segment(X, ad, X + 1, bc); break;
        case 6: case 9: segment(ab, Y, dc, Y + 1); break;
        default: {
          // Two opposite corners are inside. They are connected if the saddle is inside.
          const isSaddleInside = corners === 5 ? a * c >= b * d : b * d >= a * c;
          if (isSaddleInside === (corners === 5)) {
            segment(ab, Y, X + 1, bc);
            segment(dc, Y + 1, X, ad);
          } else {
            segment(X, ad, ab, Y);
            segment(X + 1, bc, dc, Y + 1);
          }
        }
      }
    }
  }
  return out.subarray(0, end);
}
