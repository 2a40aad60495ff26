// SPDX-License-Identifier: Apache-2.0
// Colourings of a mesh. A colouring has one byte per corner of each triangle, a palette of 256
// colours with one entry per byte, and a legend.
import type {Level, Mesh} from "./data";
import {number, plural, count} from "./dom";
import type {Components} from "./shape";
import {levelName} from "./words";

export type Colouring = "plain" | "aspect" | "distance" | "component" | "level";

export interface Legend {
  title: string;
  /** A continuous scale: its colours from left to right, and the texts below the bar. */
  ramp?: {colours: string[]; ticks: string[]};
  /** A scale with steps: colours, their shares of the bar, and texts at positions from 0 to 1. */
  steps?: {colours: string[]; shares: number[]; ticks: {at: number; text: string}[]};
  classes?: {colour: string; name: string}[];
  note?: string;
}

export interface Colours {
  /** The colour at a point of a triangle: none, interpolated, or that of the nearest corner. */
  mode: "plain" | "blend" | "nearest";
  /** 3 per triangle; null for `plain`. */
  values: Uint8Array | null;
  /** 256 colours, RGBA. */
  palette: Uint8Array | null;
  legend: Legend | null;
}

type Rgb = [number, number, number];

/** Converts from OKLCh, a perceptually uniform space: lightness 0 to 1, chroma, hue in degrees. */
function colourOf(lightness: number, chroma: number, hue: number): Rgb {
  const a = chroma * Math.cos((hue * Math.PI) / 180);
  const b = chroma * Math.sin((hue * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const gamma = (x: number): number =>
    Math.round(
      255 * Math.min(Math.max(x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055, 0), 1),
    );
  return [
    gamma(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    gamma(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    gamma(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

const css = ([r, g, b]: Rgb): string => `rgb(${r} ${g} ${b})`;

/** From light to dark in uniform steps, so that it also works in grey; hues from sand to plum. */
function distanceColour(share: number): Rgb {
  return colourOf(
    0.93 - 0.6 * share,
    0.04 + 0.085 * Math.sin(Math.PI * Math.min(0.12 + 0.72 * share, 1)),
    95 - 110 * share,
  );
}

/** The coarsest level is the darkest, because it has the fewest vertices. */
function levelColour(level: number, levels: number): Rgb {
  const share = levels > 1 ? level / (levels - 1) : 0;
  return colourOf(0.4 + 0.48 * share, 0.1 - 0.062 * share, 262 - 72 * share);
}

/** Steps of the aspect ratio. Ratios below 1/3, the paper's bound, have another hue. */
const ASPECT: {below: number; text: string; colour: Rgb}[] = [
  {below: 0.2, text: "0.2", colour: colourOf(0.44, 0.16, 30)},
  {below: 1 / 3, text: "1/3", colour: colourOf(0.64, 0.18, 42)},
  {below: 0.5, text: "0.5", colour: colourOf(0.66, 0.075, 240)},
  {below: 0.65, text: "0.65", colour: colourOf(0.76, 0.055, 235)},
  {below: 0.8, text: "0.8", colour: colourOf(0.85, 0.038, 230)},
  {below: Infinity, text: "1", colour: colourOf(0.93, 0.02, 225)},
];

/**
 * Different hues and lightnesses that colour-blind people can distinguish, too. Consecutive colours
 * differ most.
 */
const CLASSES: Rgb[] = [
  colourOf(0.62, 0.085, 245),
  colourOf(0.79, 0.105, 75),
  colourOf(0.56, 0.085, 165),
  colourOf(0.68, 0.115, 30),
  colourOf(0.5, 0.1, 300),
  colourOf(0.83, 0.07, 205),
  colourOf(0.47, 0.07, 60),
  colourOf(0.75, 0.09, 345),
  colourOf(0.7, 0.1, 130),
  colourOf(0.42, 0.07, 260),
];

export const componentColour = (component: number): string =>
  css(CLASSES[component % CLASSES.length]);

function palette(of: (entry: number) => Rgb): Uint8Array {
  const out = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i) out.set([...of(i), 255], 4 * i);
  return out;
}

const NONE: Colours = {mode: "plain", values: null, palette: null, legend: null};

export interface Shape {
  ratios: () => Float32Array;
  components: () => Components;
}

function byAspect(shape: Shape): Colours {
  const ratios = shape.ratios();
  const values = new Uint8Array(3 * ratios.length);
  ratios.forEach((ratio, t) =>
    values.fill(
      ASPECT.findIndex(({below}) => ratio < below),
      3 * t,
      3 * t + 3,
    ),
  );
  const ends = ASPECT.map(({below}) => Math.min(below, 1));
  return {
    mode: "nearest",
    values,
    palette: palette((i) => ASPECT[Math.min(i, ASPECT.length - 1)].colour),
    legend: {
      title: "Aspect ratio, shortest edge / longest edge",
      steps: {
        colours: ASPECT.map(({colour}) => css(colour)),
        shares: ends.map((end, i) => end - (i > 0 ? ends[i - 1] : 0)),
        ticks: [{at: 0, text: "0"}, ...ASPECT.map(({text}, i) => ({at: ends[i], text}))],
      },
    },
  };
}

function byDistance(level: Level, unit: string): Colours {
  if (!level.distance) {
    return {
      ...NONE,
      legend: {title: "Distance error", note: "The file has no distance errors for this level."},
    };
  }
  const {steps, maximum} = level.distance;
  const values = Uint8Array.from(level.triangles, (v) => steps[v]);
  return {
    mode: "blend",
    values,
    palette: palette((i) => distanceColour(i / 255)),
    legend: {
      title: `Distance from the isosurface, ${unit}`,
      ramp: {
        colours: Array.from({length: 13}, (_, i) => css(distanceColour(i / 12))),
        ticks: [0, 0.5, 1].map((share) => number(share * maximum)),
      },
    },
  };
}

function byComponent(level: Level, shape: Shape): Colours {
  const found = shape.components();
  const shown = found.list.slice(0, 6);
  const rest = found.list.length - shown.length;
  return {
    mode: "nearest",
    values: Uint8Array.from(level.triangles, (v) => found.of[v] % CLASSES.length),
    palette: palette((i) => CLASSES[i % CLASSES.length]),
    legend: {
      title: plural(found.list.length, "component"),
      classes: shown.map(({triangles}, i) => ({
        colour: componentColour(i),
        name: plural(triangles, "triangle"),
      })),
      note: rest > 0 ? `and ${count(rest)} smaller ones` : undefined,
    },
  };
}

function byLevel(mesh: Mesh, level: Level): Colours {
  const levels = mesh.levels.length;
  const shown = mesh.levels.indexOf(level);
  return {
    mode: "nearest",
    values: Uint8Array.from(level.triangles, (v) => mesh.levelOf[v]),
    palette: palette((i) => levelColour(Math.min(i, levels - 1), levels)),
    legend: {
      title: "First level with the vertex",
      classes: mesh.levels.slice(0, shown + 1).map(({vertices}, k) => {
        const added = vertices - (k > 0 ? mesh.levels[k - 1].vertices : 0);
        return {
          colour: css(levelColour(k, levels)),
          name: `${levelName(mesh.levels[k].facts)}: ${plural(added, "vertex", "vertices")}`,
        };
      }),
    },
  };
}

export function colour(
  kind: Colouring,
  mesh: Mesh,
  level: Level,
  shape: Shape,
  unit: string,
): Colours {
  switch (kind) {
    case "aspect": return byAspect(shape);
    case "distance": return byDistance(level, unit);
    case "component": return byComponent(level, shape);
    case "level": return byLevel(mesh, level);
    case "plain": return NONE;
  }
}
