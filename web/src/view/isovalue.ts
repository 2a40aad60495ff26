// SPDX-License-Identifier: Apache-2.0
// Isovalues as text and in steps.
import type {Volume} from "./server";

export type Parsed = {value: number} | {problem: string};

/** The samples of the volume, as far as an isovalue depends on them. */
export type Range = Pick<Volume, "minimum" | "maximum" | "histogram">;

/** @param text as typed */
export function parseIsovalue(text: string, {minimum, maximum}: Range): Parsed {
  const trimmed = text.trim().replace("−", "-");
  if (trimmed === "") return {problem: "Expected a number like 300.5."};
  if (/^[+-]?\d+,\d+$/.test(trimmed))
    return {problem: `Expected a decimal point: ${trimmed.replace(",", ".")}.`};
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(trimmed))
    return {problem: `Expected a number like 300.5, got “${trimmed}”.`};
  const value = Number(trimmed);
  if (!(value >= minimum && value <= maximum))
    return {
      problem: `There is no isosurface at ${trimmed}: samples are from ${minimum} to ${maximum}.`,
    };
  return {value};
}

/** The first and last value of a histogram. Integers are in the middle of their bins. */
export function ends({histogram: {lowest, width, counts, of_integers}}: Range): [number, number] {
  const start = of_integers ? lowest - 0.5 : lowest;
  return [start, start + width * counts.length];
}

/** The step of the arrow keys. */
export function stepOf(range: Range): number {
  if (range.histogram.of_integers) return 1;
  return 10 ** Math.round(Math.log10((range.maximum - range.minimum || 1) / 500));
}

/** Of integers: half-way between two, so that no sample equals it. */
export function snapped(value: number, step: number, range: Range): number {
  const {minimum, maximum, histogram} = range;
  if (histogram.of_integers) {
    const half = Math.floor(value) + 0.5;
    return maximum > minimum ? Math.min(Math.max(half, minimum + 0.5), maximum - 0.5) : half;
  }
  const decimals = Math.min(Math.max(-Math.floor(Math.log10(step) + 1e-9), 0), 20);
  const rounded = Number((Math.round(value / step) * step).toFixed(decimals));
  return Math.min(Math.max(rounded, minimum), maximum);
}

/** The share of the finite samples that are below a value, as far as the bins resolve it. */
export function shareBelow(value: number, range: Range): number {
  const {counts, width} = range.histogram;
  const at = (value - ends(range)[0]) / width;
  let below = 0;
  let all = 0;
  counts.forEach((count, bin) => {
    below += count * Math.min(Math.max(at - bin, 0), 1);
    all += count;
  });
  return all > 0 ? below / all : 0;
}

/** Round values for the marks of a scale, at most `most` of them. */
export function ticks([from, to]: [number, number], most: number): number[] {
  const least = (to - from) / most;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= least) ?? 10 * power;
  const out: number[] = [];
  for (let k = Math.ceil(from / step); k * step <= to; ++k) out.push(k * step + 0);  // not -0
  return out;
}
