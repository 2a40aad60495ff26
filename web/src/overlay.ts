// SPDX-License-Identifier: Apache-2.0
// The overlay of the picture: axes, a scale, measured points, a circle around the worst triangle.
import {Quaternion, Vector3} from "three";

import type {Camera} from "./camera";
import {drawn, number} from "./dom";
import type {Worst} from "./level_shape";
import type {Orientation} from "./orientation";

const px = (value: number): string => value.toFixed(1);

/** The longest round length of at most this number of pixels. @param scale pixels per length */
export function scaleLength(scale: number, pixels: number): number {
  const most = pixels / scale;
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].map((step) => step * power).find((step) => step <= most) ?? power;
}

export class Overlay {
  readonly svg = drawn("svg", {class: "overlay", "aria-hidden": "true"});
  worst: Worst | null = null;
  /** Measured points, relative to the centre of the mesh: none, one or two. */
  points: Vector3[] = [];
  /** The distance of two measured points, as text. */
  distance = "";
  /** Whether a cross marks the centre of the picture, where the keyboard measures. */
  crosshair = false;
  /** Whether a line is drawn between the smooth half and the line half of the picture. */
  split = false;
  unit = "";
  orientation: Orientation | null = null;
  private readonly divider = drawn("line", {class: "divider"});
  private readonly mark = drawn("g", {class: "mark"});
  private readonly ruler = drawn("g", {class: "ruler"});
  private readonly axes = drawn("g", {class: "axes"});
  private readonly bar = drawn("path", {class: "scale-line"});
  private readonly length = drawn("text", {class: "scale-text", "text-anchor": "end"});

  constructor() {
    this.svg.append(this.divider, this.mark, this.ruler, this.axes, this.bar, this.length);
  }

  update(camera: Camera, width: number, height: number): void {
    this.divider.setAttribute("visibility", this.split ? "visible" : "hidden");
    const ends = [["x1", width / 2], ["x2", width / 2], ["y1", 0], ["y2", height]] as const;
    for (const [name, value] of ends) this.divider.setAttribute(name, `${value}`);
    this.showWorst(camera);
    this.showRuler(camera, width, height);
    this.showAxes(camera, width, height);
    this.showScale(camera, width, height);
  }

  private showWorst(camera: Camera): void {
    this.mark.replaceChildren();
    if (!this.worst) return;
    const [x, y] = camera.project(this.worst.centroid);
    const points = this.worst.corners.map((corner) => camera.project(corner));
    const size = Math.max(...points.map(([px, py]) => Math.hypot(px - x, py - y)));
    this.mark.append(
      drawn("polygon", {
        points: points.map(([px, py]) => `${px.toFixed(1)},${py.toFixed(1)}`).join(" "),
      }),
    );
    this.mark.append(
      drawn("circle", {cx: x.toFixed(1), cy: y.toFixed(1), r: (size + 16).toFixed(1)}),
    );
  }

  private showRuler(camera: Camera, width: number, height: number): void {
    this.ruler.replaceChildren();
    if (this.crosshair) {
      const [x, y] = [width / 2, height / 2];
      this.ruler.append(drawn("path", {d: `M${x - 9},${y}h18M${x},${y - 9}v18`}));
    }
    const seen = this.points.map((point) => camera.project(point));
    if (seen.length === 2) {
      const [[ax, ay], [bx, by]] = seen;
      this.ruler.append(drawn("line", {x1: px(ax), y1: px(ay), x2: px(bx), y2: px(by)}));
      // Above the line, where it does not cover the points.
      const text = drawn(
        "text",
        {x: px((ax + bx) / 2), y: px((ay + by) / 2 - 8), "text-anchor": "middle"},
        this.distance,
      );
      this.ruler.append(text);
    }
    for (const [x, y] of seen) this.ruler.append(drawn("circle", {cx: px(x), cy: px(y), r: 4}));
  }

  private showAxes(camera: Camera, width: number, height: number): void {
    const back = new Quaternion().copy(camera.pose.rotation).invert();
    const [x, y, long] = [width - 46, height - 84, 24];
    const seen = (this.orientation?.ends ?? [])
      .map(({text, direction}) => ({
        text,
        at: new Vector3(...direction).applyQuaternion(back),
      }))
      .sort((a, b) => a.at.z - b.at.z);
    // Of two ends of an axis that are nearly at the same pixel, only the nearer one is named.
    const isCovered = ({z}: Vector3): boolean => z < -0.94 && !!this.orientation?.anatomical;
    this.axes.replaceChildren(
      ...seen
        .filter(({at}) => !isCovered(at))
        .flatMap(({text, at}) => [
          drawn("line", {
            x1: x,
            y1: y,
            x2: px(x + long * at.x),
            y2: px(y - long * at.y),
            opacity: at.z < -0.1 ? 0.65 : 1,
          }),
          drawn(
            "text",
            {
              x: px(x + (long + 9) * at.x),
              y: px(y - (long + 9) * at.y + 4),
              "text-anchor": "middle",
            },
            text,
          ),
        ]),
    );
  }

  private showScale(camera: Camera, width: number, height: number): void {
    const length = scaleLength(camera.scale, Math.min(140, width / 3));
    const [right, y, pixels] = [width - 16, height - 14, length * camera.scale];
    this.bar.setAttribute(
      "d",
      `M${(right - pixels).toFixed(1)},${y - 4}v4h${pixels.toFixed(1)}v-4`,
    );
    this.length.setAttribute("x", `${right}`);
    this.length.setAttribute("y", `${y - 8}`);
    this.length.textContent = `${number(length)} ${this.unit}`;
  }
}
