// SPDX-License-Identifier: Apache-2.0
// The overlay of the picture: axes, a scale, and a circle around the worst triangle.
import {Quaternion, Vector3} from "three";

import type {Camera} from "./camera";
import {drawn, number} from "./dom";
import type {Worst} from "./scene";

const AXES = ["x", "y", "z"].map((name, i) => ({
  name,
  direction: new Vector3().setComponent(i, 1),
}));

export class Overlay {
  readonly svg = drawn("svg", {class: "overlay", "aria-hidden": "true"});
  worst: Worst | null = null;
  /** Whether a line is drawn between the smooth half and the line half of the picture. */
  split = false;
  unit = "";
  private readonly divider = drawn("line", {class: "divider"});
  private readonly mark = drawn("g", {class: "mark"});
  private readonly axes = drawn("g", {class: "axes"});
  private readonly bar = drawn("path", {class: "scale-line"});
  private readonly length = drawn("text", {class: "scale-text", "text-anchor": "end"});

  constructor() {
    this.svg.append(this.divider, this.mark, this.axes, this.bar, this.length);
  }

  update(camera: Camera, width: number, height: number): void {
    this.divider.setAttribute("visibility", this.split ? "visible" : "hidden");
    const ends = [["x1", width / 2], ["x2", width / 2], ["y1", 0], ["y2", height]] as const;
    for (const [name, value] of ends) this.divider.setAttribute(name, `${value}`);
    this.showWorst(camera);
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

  private showAxes(camera: Camera, width: number, height: number): void {
    const back = new Quaternion().copy(camera.pose.rotation).invert();
    const [x, y, long] = [width - 46, height - 64, 24];
    const seen = AXES.map(({name, direction}) => ({
      name,
      at: direction.clone().applyQuaternion(back),
    })).sort((a, b) => a.at.z - b.at.z);
    this.axes.replaceChildren(
      ...seen.flatMap(({name, at}) => {
        const fade = at.z < -0.1 ? 0.65 : 1;
        return [
          drawn("line", {
            x1: x,
            y1: y,
            x2: (x + long * at.x).toFixed(1),
            y2: (y - long * at.y).toFixed(1),
            opacity: fade,
          }),
          drawn(
            "text",
            {
              x: (x + (long + 9) * at.x).toFixed(1),
              y: (y - (long + 9) * at.y + 4).toFixed(1),
              "text-anchor": "middle",
            },
            name,
          ),
        ];
      }),
    );
  }

  private showScale(camera: Camera, width: number, height: number): void {
    const most = Math.min(140, width / 3) / camera.scale;
    const power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map((step) => step * power).find((step) => step <= most) ?? power;
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
