// SPDX-License-Identifier: Apache-2.0
// Draws the samples of a slice in grey values: window, level, and a tint where it is inside.
import {insideness, type InsideRule, type Samples} from "./isoline";
import type {Histogram} from "./server";

/** Samples at or below `low` are black, at or above `high` white. */
export interface GreyRange {
  low: number;
  high: number;
}

/** Colours as red, green and blue, 0 to 255. */
export type Rgb = [number, number, number];

const SHARES = [0.005, 0.995];

/** The range that leaves out the lowest and the highest half per cent of the samples. */
export function defaultRange({lowest, width, counts}: Histogram): GreyRange {
  const all = counts.reduce((a, b) => a + b, 0);
  const at = (share: number): number => {
    let sum = 0;
    for (let bin = 0; bin < counts.length; ++bin) {
      sum += counts[bin];
      if (sum >= share * all) return bin;
    }
    return counts.length - 1;
  };
  let [first, last] = SHARES.map(at);
  // Nearly all samples are equal: show all of them.
  if (first === last) [first, last] = [0, counts.length - 1];
  return {low: lowest + first * width, high: lowest + (last + 1) * width};
}

/** From a pixel to samples: sample = start + step * pixel, along both directions of the screen. */
export interface PixelGrid {
  startX: number;
  stepX: number;
  startY: number;
  stepY: number;
}

/** 512 colours: 256 grey values outside, and the same tinted inside. */
export function palette(tint: Rgb | null): Uint32Array {
  const out = new Uint32Array(512);
  const share = 0.3;
  for (let grey = 0; grey < 256; ++grey) {
    out[grey] = packed([grey, grey, grey]);
    out[256 + grey] = packed(
      tint ? (tint.map((v) => grey + share * (v - grey)) as Rgb) : [grey, grey, grey],
    );
  }
  return out;
}

const packed = ([r, g, b]: Rgb): number =>
  ((255 << 24) | (Math.round(b) << 16) | (Math.round(g) << 8) | Math.round(r)) >>> 0;

export interface Painting {
  range: GreyRange;
  rule: InsideRule;
  colours: Uint32Array;
  notFinite: Rgb;
  /** Whether values are interpolated between samples. */
  smooth: boolean;
}

/**
 * Draws into pixels, four bytes each. A pixel shows the value at its centre, bilinear between the
 * four nearest samples. It is tinted if the bilinear value is inside, as the isoline is drawn.
 * Pixels up to half a sample beyond the samples show the nearest one.
 * @cost O(pixels)
 */
export function paint(
  pixels: Uint32Array,
  width: number,
  height: number,
  grid: PixelGrid,
  of: Samples,
  {range, rule, colours, notFinite, smooth}: Painting,
): void {
  const {samples, right, down} = of;
  const columns = new Int32Array(width);  // offset of the left sample; -1: beyond the samples
  const shares = new Float64Array(width);
  const nextColumn = new Int32Array(width);
  for (let x = 0; x < width; ++x)
    columns[x] = place(grid.startX + grid.stepX * x, of.width, right, x, shares, nextColumn);
  const rowShare = new Float64Array(1);
  const nextRow = new Int32Array(1);
  const scale = 255 / (range.high - range.low || 1e-300);
  const {low} = range;
  const {isovalue} = rule;
  const above = rule.inside === "above";
  const value = insideness(rule);
  const strange = packed(notFinite);
  for (let y = 0; y < height; ++y) {
    const start = y * width;
    const row = place(grid.startY + grid.stepY * y, of.height, down, 0, rowShare, nextRow);
    if (row < 0) {
      pixels.fill(0, start, start + width);
      continue;
    }
    const v = rowShare[0];
    const below = nextRow[0];
    for (let x = 0; x < width; ++x) {
      const column = columns[x];
      if (column < 0) {
        pixels[start + x] = 0;
        continue;
      }
      const u = shares[x];
      const at = row + column;
      const across = nextColumn[x];
      const a = samples[at], b = samples[at + across];
      const c = samples[at + below], d = samples[at + below + across];
      const upper = a + u * (b - a);
      const bilinear = upper + v * (c + u * (d - c) - upper);
      const nearest = v < 0.5 ? (u < 0.5 ? a : b) : u < 0.5 ? c : d;
      let inside: boolean;
      if (bilinear - bilinear === 0) {
        inside = above ? bilinear >= isovalue : bilinear <= isovalue;
      } else {
        const first = value(a) + u * (value(b) - value(a));
        const second = value(c) + u * (value(d) - value(c));
        inside = first + v * (second - first) >= 0;
      }
      const shown = smooth && bilinear - bilinear === 0 ? bilinear : nearest;
      if (shown !== shown || shown - shown !== 0) {
        pixels[start + x] = strange;
        continue;
      }
      const grey = (shown - low) * scale;
      const entry = grey <= 0 ? 0 : grey >= 255 ? 255 : grey | 0;
      pixels[start + x] = colours[inside ? 256 + entry : entry];
    }
  }
}

/**
 * The sample before a position along one direction.
 * @returns its offset, or -1 beyond the samples; sets its distance and the offset of the next one
 */
function place(
  position: number,
  count: number,
  stride: number,
  slot: number,
  shares: Float64Array,
  next: Int32Array,
): number {
  if (position < -0.5 || position >= count - 0.5) return -1;
  const clamped = Math.min(Math.max(position, 0), count - 1);
  const before = Math.min(Math.floor(clamped), Math.max(count - 2, 0));
  shares[slot] = clamped - before;
  next[slot] = count > 1 ? stride : 0;
  return before * stride;
}
