// SPDX-License-Identifier: Apache-2.0
// Texts about levels, shared by the picture, the tables and the histogram.
import type {LevelFacts} from "./data";
import {number} from "./dom";

/** Levels are counted from 1 on the page; the report and the tool count them from 0. */
export const levelName = ({level}: LevelFacts): string => `${level + 1}`;

/** The largest two-sided distance between surface and mesh of a level; null: unknown. */
export function errorOf(level: LevelFacts): number | null {
  const metric = level.metrics?.["max-distance"];
  const known = [
    metric ? (metric.maximum ?? Infinity) : null,
    level.measured?.maximum ?? null,
  ].filter((error) => error !== null);
  return known.length > 0 ? Math.max(...known) : null;
}

export function errorText(level: LevelFacts, unit: string): string {
  const error = errorOf(level);
  if (error === null) return "error not measured";
  return error === Infinity ? "infinite error" : `error ${number(error)} ${unit}`;
}

const FINER = "--supersample 2 makes it finer";
const REASONS: [RegExp, string][] = [
  [
    /^1 cell is at the resolution limit.*$/,
    `at 1 place the volume is too coarse for this bound; ${FINER}`,
  ],
  [
    /^([\d,]+) cells are at the resolution limit.*$/,
    `at $1 places the volume is too coarse for this bound; ${FINER}`,
  ],
  [
    /^cells cannot be smaller: the surface has ([\d,]+) c-vertices.*$/,
    `a volume this coarse has only $1 places for vertices; ${FINER}`,
  ],
  [
    /^([\d,]+) triangles cannot be made better where c-vertices are this sparse$/,
    `$1 triangles stay thin where the volume is too coarse; ${FINER}`,
  ],
  [/^(.+) comes first$/, "$1 has priority"],
];

/** Why a bound is violated, without the terms of the method. */
export function plainReason(reason: string): string {
  for (const [pattern, plain] of REASONS)
    if (pattern.test(reason)) return reason.replace(pattern, plain);
  return reason;
}
