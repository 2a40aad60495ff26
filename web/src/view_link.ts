// SPDX-License-Identifier: Apache-2.0
// The view as the part of an address after "#", to pass it on or to come back to it.
import {Quaternion, Vector3} from "three";

import type {Pose} from "./camera";

export interface LinkedView {
  result: number;
  level: number;
  style: string;
  colouring: string;
  pose: Pose;
  /** Per axis: the removed share of the box, and whether the other side is removed. */
  cuts: {removed: number; flipped: boolean}[];
  filled: boolean;
  /** Numbers of the hidden components. */
  hidden: number[];
}

/** More digits than the picture's floats have, so that the same pixels are drawn. */
const short = (v: number): string => `${Number(v.toPrecision(10))}`;

export function viewText({pose, ...view}: LinkedView): string {
  const {target, rotation, zoom} = pose;
  return new URLSearchParams({
    result: `${view.result + 1}`,
    level: `${view.level + 1}`,
    shading: view.style,
    colour: view.colouring,
    target: target.toArray().map(short).join(" "),
    rotation: rotation.toArray().map(short).join(" "),
    zoom: short(zoom),
    cut: view.cuts.map(({removed, flipped}) => `${short(removed)}${flipped ? "f" : ""}`).join(" "),
    ...(view.filled ? {} : {fill: "0"}),
    ...(view.hidden.length > 0 ? {hidden: rangesText(view.hidden)} : {}),
  })
    .toString()
    .replaceAll("+", "_");
}

/** Sorted numbers as ranges, counted from 1: "2-5 9". */
function rangesText(numbers: number[]): string {
  const ranges: [number, number][] = [];
  for (const n of [...numbers].sort((a, b) => a - b)) {
    const last = ranges[ranges.length - 1];
    if (last?.[1] === n - 1) last[1] = n;
    else ranges.push([n, n]);
  }
  return ranges.map(([a, b]) => (a === b ? `${a + 1}` : `${a + 1}-${b + 1}`)).join(" ");
}

/** @param count numbers beyond are left out */
function rangesOf(text: string, count: number): number[] {
  return text.split(" ").flatMap((range) => {
    const [first, last = first] = range.split("-").map(Number);
    if (!(first >= 1) || !(last >= first)) return [];
    const length = Math.min(last, count) - first + 1;
    return Array.from({length: Math.max(length, 0)}, (_, i) => first - 1 + i);
  });
}

function numbers(text: string | null, count: number): number[] | null {
  const found = (text ?? "").split(" ").map(Number);
  return text !== null && found.length === count && found.every(Number.isFinite) ? found : null;
}

const MOST_COMPONENTS = 1e6;

/** @returns null if the text is not that of a view */
export function viewOf(text: string): LinkedView | null {
  const given = new URLSearchParams(text.replace(/^#/, "").replaceAll("_", "+"));
  const target = numbers(given.get("target"), 3);
  const rotation = numbers(given.get("rotation"), 4);
  const zoom = Number(given.get("zoom"));
  if (!target || !rotation || !(zoom > 0)) return null;
  const length = Math.hypot(...rotation);
  if (!(length > 0)) return null;
  const cuts = (given.get("cut") ?? "").split(" ").map((one) => ({
    removed: Math.min(Math.max(parseFloat(one) || 0, 0), 1),
    flipped: one.endsWith("f"),
  }));
  return {
    result: (Number(given.get("result")) || 1) - 1,
    level: (Number(given.get("level")) || 1) - 1,
    style: given.get("shading") ?? "",
    colouring: given.get("colour") ?? "",
    pose: {
      target: new Vector3(...target),
      rotation: new Quaternion(...rotation.map((v) => v / length)),
      zoom: Math.min(Math.max(zoom, 0.01), 1e5),
    },
    cuts: [0, 1, 2].map((axis) => cuts[axis] ?? {removed: 0, flipped: false}),
    filled: given.get("fill") !== "0",
    hidden: rangesOf(given.get("hidden") ?? "", MOST_COMPONENTS),
  };
}
