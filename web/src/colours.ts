// What colours say. Each colouring gives one colour per corner of the triangles, and a legend.
import {Color} from "three";

import type {Level, Mesh} from "./data";
import {aspectRatios, components} from "./shape";

export type Colouring = "plain" | "aspect" | "distance" | "component" | "level";

export interface Legend {
  title: string;
  /** Of a scale: its ends and the colours between. */
  scale?: {from: string; to: string; colours: string[]};
  /** Of classes: colours with names. */
  classes?: {colour: string; name: string}[];
}

export interface Colours {
  /** 3 per corner, 9 per triangle. */
  corners: Float32Array;
  legend: Legend;
}

/** Dark to light, even in lightness, and told apart by those who see few colours (after cividis). */
const SCALE = ["#1b2d5c", "#3f4f74", "#666970", "#8d8770", "#b9a863", "#f0d548"];
/** Told apart on light and dark ground (after Okabe and Ito). */
const CLASSES = ["#4c78a8", "#e49444", "#55a868", "#c44e52", "#8172b3", "#937860", "#64b5cd", "#ccb974"];
const PLAIN = "#d9b98a";

function onScale(share: number): Color {
  const at = Math.min(Math.max(share, 0), 1) * (SCALE.length - 1);
  const low = Math.min(Math.floor(at), SCALE.length - 2);
  return new Color(SCALE[low]).lerp(new Color(SCALE[low + 1]), at - low);
}

export function lengthText(value: number, unit: string): string {
  return `${value === 0 ? "0" : Number(value.toPrecision(3))} ${unit}`;
}

export function colour(kind: Colouring, mesh: Mesh, level: Level, unit: string): Colours {
  const {triangles} = level;
  const corners = new Float32Array(3 * triangles.length);
  const fill = (of: (corner: number) => Color): void => {
    for (let i = 0; i < triangles.length; ++i) {
      const c = of(i);
      corners[3 * i] = c.r;
      corners[3 * i + 1] = c.g;
      corners[3 * i + 2] = c.b;
    }
  };
  const steps = Array.from({length: 256}, (_, i) => onScale(i / 255));
  const classes = CLASSES.map((text) => new Color(text));
  if (kind === "aspect") {
    const ratio = aspectRatios(level.positions, triangles);
    fill((i) => steps[Math.round(255 * Math.min(ratio[Math.floor(i / 3)], 1))]);
    return {corners, legend: {title: "Aspect ratio: shortest over longest edge", scale: {from: "0", to: "1", colours: SCALE}}};
  }
  if (kind === "distance" && level.distance) {
    const distance = level.distance;
    const largest = distance.reduce((a, b) => Math.max(a, b), 0) || 1;
    fill((i) => steps[Math.round((255 * distance[triangles[i]]) / largest)]);
    return {
      corners,
      legend: {title: "Largest distance from the isosurface, of each vertex' cell", scale: {from: "0", to: lengthText(largest, unit), colours: SCALE}},
    };
  }
  if (kind === "component") {
    const found = components(level.facts.vertices, triangles);
    fill((i) => classes[found.of[triangles[i]] % classes.length]);
    const named = found.sizes.slice(0, 5).map((n, i) => ({colour: CLASSES[i], name: `${n.toLocaleString("en")} vertices`}));
    const rest = found.sizes.length - named.length;
    const title = `${found.sizes.length.toLocaleString("en")} component${found.sizes.length === 1 ? "" : "s"}${rest > 0 ? ", the largest:" : ""}`;
    return {corners, legend: {title, classes: named}};
  }
  if (kind === "level") {
    const count = mesh.levels.length;
    const of = Array.from({length: count}, (_, k) => onScale(count > 1 ? 1 - k / (count - 1) : 1));
    fill((i) => of[mesh.levelOf[triangles[i]]]);
    return {corners, legend: {title: "Level that brought the vertex", classes: of.map((c, k) => ({colour: `#${c.getHexString()}`, name: `${k}`}))}};
  }
  const plain = new Color(PLAIN);
  fill(() => plain);
  return {corners, legend: {title: ""}};
}
