// SPDX-License-Identifier: Apache-2.0
// What is drawn over the grey values of a slice: isoline, region of interest, cross lines, names of
// directions, a scale.
import type {Triple} from "../data";
import {number} from "../dom";
import {scaleLength} from "../overlay";
import type {Grid} from "./grid";
import type {Region} from "./region";
import type {SliceFrame} from "./slice_frame";

type Context = CanvasRenderingContext2D;

const COLOURS = {
  isoline: "#4fb4ff",
  casing: "rgb(0 0 0 / 55%)",
  cross: "rgb(255 214 120 / 75%)",
  region: "#ffb454",
  dimmed: "rgb(0 0 0 / 50%)",
  text: "#dfe4e6",
  halo: "rgb(0 0 0 / 70%)",
};

/** @param segments 4 numbers each, in samples along right and down */
export function drawIsoline(context: Context, frame: SliceFrame, segments: Float32Array): void {
  const [stepX, stepY] = frame.steps;
  const {x, y} = frame.project(0, 0);
  context.beginPath();
  for (let i = 0; i < segments.length; i += 4) {
    context.moveTo(x + segments[i] * stepX, y + segments[i + 1] * stepY);
    context.lineTo(x + segments[i + 2] * stepX, y + segments[i + 3] * stepY);
  }
  context.lineCap = "round";
  // A dark casing, so that the line is visible on white, too.
  context.strokeStyle = COLOURS.casing;
  context.lineWidth = 3;
  context.stroke();
  context.strokeStyle = COLOURS.isoline;
  context.lineWidth = 1.5;
  context.stroke();
}

/**
 * Dims what is outside the region.
 * @param index the slice; dashed if it is outside
 * @param isEdited whether its edges can be dragged
 */
export function drawRegion(
  context: Context,
  frame: SliceFrame,
  region: Region,
  {size}: Grid,
  index: number,
  isEdited: boolean,
): void {
  const {axis, right, down} = frame.plane;
  const box = (u: readonly number[], v: readonly number[]): [number, number, number, number] => {
    const a = frame.project(u[0] - 0.5, v[0] - 0.5);
    const b = frame.project(u[1] + 0.5, v[1] + 0.5);
    return [Math.min(a.x, b.x), Math.min(a.y, b.y), Math.abs(b.x - a.x), Math.abs(b.y - a.y)];
  };
  const inner = box(region.ends[right.axis], region.ends[down.axis]);
  const [first, last] = region.ends[axis];
  const isOutside = index < first || index > last;
  context.beginPath();
  context.rect(...box([0, size[right.axis] - 1], [0, size[down.axis] - 1]));
  if (!isOutside) context.rect(...inner);
  context.fillStyle = COLOURS.dimmed;
  context.fill("evenodd");
  context.lineWidth = 1.5;
  context.strokeStyle = COLOURS.region;
  context.setLineDash(isOutside ? [4, 4] : []);
  context.strokeRect(...inner);
  context.setLineDash([]);
  if (!isEdited) return;
  const [x, y, wide, high] = inner;
  context.fillStyle = COLOURS.region;
  for (const atX of [0, 0.5, 1])
    for (const atY of [0, 0.5, 1])
      if (atX !== 0.5 || atY !== 0.5)
        context.fillRect(x + atX * wide - 4, y + atY * high - 4, 8, 8);
}

/** The other two slices, with a gap where they intersect. */
export function drawCross(context: Context, frame: SliceFrame, position: Triple): void {
  const {x, y} = frame.pixelOf(position);
  const {width, height} = frame.extent;
  const gap = 9;
  context.beginPath();
  for (const [ax, ay, bx, by] of [
    [0, y, x - gap, y],
    [x + gap, y, width, y],
    [x, 0, x, y - gap],
    [x, y + gap, x, height],
  ]) {
    context.moveTo(ax, ay);
    context.lineTo(bx, by);
  }
  context.lineWidth = 1;
  context.lineCap = "butt";
  context.strokeStyle = COLOURS.cross;
  context.stroke();
}

export function drawEnds(context: Context, frame: SliceFrame): void {
  const {width, height} = frame.extent;
  const {left, right, top, bottom} = frame.plane.ends;
  drawText(context, left, 7, height / 2, "left");
  drawText(context, right, width - 7, height / 2, "right");
  drawText(context, top, width / 2, 12, "center");
  drawText(context, bottom, width / 2, height - 12, "center");
}

export function drawScale(context: Context, frame: SliceFrame, unit: string): void {
  const {width, height} = frame.extent;
  const length = scaleLength(frame.scale, Math.min(100, width / 4));
  const pixels = length * frame.scale;
  const [right, y] = [width - 10, height - 10];
  for (const [line, colour] of [[4, COLOURS.halo], [1.5, COLOURS.text]] as const) {
    context.beginPath();
    context.moveTo(right - pixels, y - 4);
    context.lineTo(right - pixels, y);
    context.lineTo(right, y);
    context.lineTo(right, y - 4);
    context.lineWidth = line;
    context.strokeStyle = colour;
    context.stroke();
  }
  drawText(context, `${number(length)}${unit}`, right, y - 13, "right");
}

function drawText(
  context: Context,
  text: string,
  x: number,
  y: number,
  align: CanvasTextAlign,
): void {
  context.textAlign = align;
  context.textBaseline = "middle";
  context.font = `600 12px ${getComputedStyle(document.body).fontFamily}`;
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = COLOURS.halo;
  context.strokeText(text, x, y);
  context.fillStyle = COLOURS.text;
  context.fillText(text, x, y);
}
