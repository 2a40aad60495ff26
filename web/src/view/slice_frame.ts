// SPDX-License-Identifier: Apache-2.0
// Where the samples of a slice are in its picture: zoom, pan, and the way from pixels to samples.
import type {Triple} from "../data";
import type {Point} from "../gestures";
import type {Grid, Plane} from "./grid";
import type {SampleRange} from "./isoline";

const LEAST_ZOOM = 0.5;
const MOST_ZOOM = 200;
const SHARE = 0.94;  // of the picture that the slice fills at zoom 1

export class SliceFrame {
  readonly plane: Plane;
  zoom = 1;
  /** The sample at the centre of the picture, along right and down. */
  private centre: [number, number] = [0, 0];

  constructor(
    private readonly grid: Grid,
    axis: number,
    private readonly canvas: HTMLCanvasElement,
  ) {
    this.plane = grid.plane(axis);
    this.reset();
  }

  /** Shows the whole slice. */
  reset(): void {
    const {size} = this.grid;
    const {right, down} = this.plane;
    this.centre = [(size[right.axis] - 1) / 2, (size[down.axis] - 1) / 2];
    this.zoom = 1;
  }

  /** Size in CSS pixels. */
  get extent(): {width: number; height: number} {
    return {width: this.canvas.clientWidth, height: this.canvas.clientHeight};
  }

  /** CSS pixels per unit of length. */
  get scale(): number {
    const {size, spacing} = this.grid;
    const {right, down} = this.plane;
    const {width, height} = this.extent;
    const long = (axis: number): number => size[axis] * spacing[axis];
    return this.zoom * SHARE * Math.min(width / long(right.axis), height / long(down.axis));
  }

  /** CSS pixels from one sample to the next, along right and down; negative: to the left or up. */
  get steps(): [number, number] {
    const {right, down} = this.plane;
    const {spacing} = this.grid;
    const {scale} = this;
    return [right.sign * spacing[right.axis] * scale, down.sign * spacing[down.axis] * scale];
  }

  /** From samples along right and down to CSS pixels. */
  project(u: number, v: number): Point {
    const [stepX, stepY] = this.steps;
    const {width, height} = this.extent;
    return {
      x: width / 2 + (u - this.centre[0]) * stepX,
      y: height / 2 + (v - this.centre[1]) * stepY,
    };
  }

  unproject({x, y}: Point): [number, number] {
    const [stepX, stepY] = this.steps;
    const {width, height} = this.extent;
    return [
      this.centre[0] + (x - width / 2) / stepX,
      this.centre[1] + (y - height / 2) / stepY,
    ];
  }

  /** The pixel of a sample of the volume. */
  pixelOf(sample: Triple): Point {
    return this.project(sample[this.plane.right.axis], sample[this.plane.down.axis]);
  }

  /** The nearest sample at a pixel, along right and down; null: beyond the samples. */
  sampleAt(at: Point): [number, number] | null {
    const {size} = this.grid;
    const {right, down} = this.plane;
    const [u, v] = this.unproject(at).map((x) => Math.round(x));
    return u < 0 || v < 0 || u >= size[right.axis] || v >= size[down.axis] ? null : [u, v];
  }

  /** The samples that are visible. */
  get visible(): SampleRange {
    const {width, height} = this.extent;
    const [u0, v0] = this.unproject({x: 0, y: 0});
    const [u1, v1] = this.unproject({x: width, y: height});
    return {
      left: Math.floor(Math.min(u0, u1)),
      right: Math.ceil(Math.max(u0, u1)),
      top: Math.floor(Math.min(v0, v1)),
      bottom: Math.ceil(Math.max(v0, v1)),
    };
  }

  /** Pans by a number of pixels; a sample stays at the centre. */
  pan(right: number, down: number): void {
    const {size} = this.grid;
    const [stepX, stepY] = this.steps;
    const [axisX, axisY] = [this.plane.right.axis, this.plane.down.axis];
    const within = (v: number, n: number): number => Math.min(Math.max(v, 0), n - 1);
    this.centre = [
      within(this.centre[0] - right / stepX, size[axisX]),
      within(this.centre[1] - down / stepY, size[axisY]),
    ];
  }

  /** Zooms; the sample at pixel (x, y) stays there. */
  zoomAt(factor: number, x: number, y: number): void {
    const [u, v] = this.unproject({x, y});
    this.zoom = Math.min(Math.max(this.zoom * factor, LEAST_ZOOM), MOST_ZOOM);
    const now = this.project(u, v);
    this.pan(x - now.x, y - now.y);
  }
}
