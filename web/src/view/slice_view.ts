// SPDX-License-Identifier: Apache-2.0
// The slices across one axis: grey values, isoline, cross lines of the other slices, the region of
// interest.
import {button} from "../controls";
import type {Triple} from "../data";
import {element, number} from "../dom";
import {listen, type Drag, type Point} from "../gestures";
import {corners} from "../icons";
import {scaleLength} from "../overlay";
import {AXES, type Grid, type Plane} from "./grid";
import {paint, type GreyRange, type PixelGrid, type Rgb} from "./grey";
import {isoline, type InsideRule, type SampleRange, type Samples} from "./isoline";
import type {Region} from "./region";
import type {Slice, SliceStore} from "./slice_store";

/** What all slice views share. */
export interface Shared {
  grid: Grid;
  store: SliceStore;
  /** The sample at which the three slices intersect. */
  position: Triple;
  range: GreyRange;
  /** 512 colours, see palette(). */
  colours: Uint32Array;
  rule: InsideRule;
  showsIsoline: boolean;
  showsCross: boolean;
  region: Region;
  isRegionEdited: boolean;
  goTo: (position: Triple) => void;
  setRange: (range: GreyRange) => void;
  /** @param settled whether the pointer was released */
  regionDragged: (settled: boolean) => void;
  /** Shows a view larger, or all views again. */
  enlarge: (id: string) => void;
}

const NOT_FINITE: Rgb = [176, 58, 122];
const LINES = {
  isoline: "#4fb4ff",
  casing: "rgb(0 0 0 / 55%)",
  cross: "rgb(255 214 120 / 75%)",
  region: "#ffb454",
  text: "#dfe4e6",
  halo: "rgb(0 0 0 / 70%)",
};
const MOST_ZOOM = 200;
const PIXELATED = 8;  // samples of more CSS pixels are drawn as squares
const NEAR = {mouse: 7, pen: 10, touch: 22};  // CSS pixels from an edge that can be dragged

export class SliceView {
  readonly canvas: HTMLCanvasElement;
  readonly field: HTMLElement;
  private readonly slider: HTMLInputElement;
  // Not live: the slider, which has the focus, has the same text.
  private readonly name = element("output", {"aria-live": "off"});
  private readonly readout: HTMLOutputElement;
  private readonly plane: Plane;
  private readonly id: string;
  /** The sample at the centre of the picture, along right and down. */
  private centre: [number, number] = [0, 0];
  private zoom = 1;
  private slice: Slice | null = null;
  private image: ImageData | null = null;
  private isDrawPending = false;
  frames = 0;

  constructor(
    readonly axis: number,
    private readonly shared: Shared,
  ) {
    const {grid} = shared;
    this.plane = grid.plane(axis);
    const letter = AXES[axis];
    this.id = `slice-${letter}`;
    const last = grid.size[axis] - 1;
    this.slider = element("input", {
      type: "range",
      id: `${this.id}-index`,
      min: "0",
      max: `${last}`,
      step: "1",
      "aria-label": `Slice across ${letter}`,
    });
    this.slider.disabled = last === 0;
    this.slider.addEventListener("input", () => this.scrollTo(Number(this.slider.value)));
    this.canvas = element("canvas", {
      id: this.id,
      tabindex: "0",
      role: "application",
      "aria-roledescription": "slice",
      "aria-describedby": "help",
    });
    this.readout = element("output", {
      class: "under-pointer",
      id: `${this.id}-readout`,
      "aria-live": "off",
    });
    this.name.setAttribute("for", this.slider.id);
    const title = this.plane.name
      ? [`${this.plane.name} `, element("span", {class: "soft"}, `across ${letter}`)]
      : [`Across ${letter}`];
    this.field = element(
      "section",
      {class: "view slice", "data-view": this.id, "aria-label": `Slices across ${letter}`},
      element(
        "div",
        {class: "view-head"},
        element("h2", {}, ...title),
        this.name,
        button(`enlarge-${this.id}`, corners(), () => shared.enlarge(this.id), {
          class: "bare-icon",
          "aria-pressed": "false",
          "aria-label": `Enlarge the slices across ${letter}`,
          title: "Enlarge",
        }),
      ),
      element("div", {class: "picture"}, this.canvas, this.readout),
      element("div", {class: "view-foot"}, this.slider),
    );
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.resetView();
  }

  private listen(): void {
    const {canvas} = this;
    listen(
      canvas,
      {
        rotate: (right, down) => this.pan(right, down),
        pan: (right, down) => this.pan(right, down),
        zoomAt: (factor, x, y) => this.zoomAt(factor, x, y),
      },
      {
        clicked: (at) => this.clicked(at),
        pointedAt: (at) => this.pointedAt(at),
        grabbed: (at, event) => this.grabbed(at, event),
        wheeled: (event) => this.wheeled(event),
      },
    );
    canvas.addEventListener("dblclick", () => this.resetView());
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const action = this.keyAction(event);
      if (!action) return;
      event.preventDefault();
      action();
    });
  }

  private keyAction({key, shiftKey}: KeyboardEvent): (() => void) | undefined {
    const {width, height} = this.extent;
    const by = (slices: number) => () => this.scrollTo(this.index + slices);
    const pan = (right: number, down: number) => () => this.pan(-30 * right, -30 * down);
    const arrows: Record<string, () => void> = shiftKey
      ? {
          ArrowLeft: pan(-1, 0),
          ArrowRight: pan(1, 0),
          ArrowUp: pan(0, -1),
          ArrowDown: pan(0, 1),
        }
      : {ArrowLeft: by(-1), ArrowRight: by(1), ArrowUp: by(1), ArrowDown: by(-1)};
    const actions: Record<string, () => void> = {
      ...arrows,
      PageUp: by(10),
      PageDown: by(-10),
      Home: by(-Infinity),
      End: by(Infinity),
      "+": () => this.zoomAt(1.25, width / 2, height / 2),
      "=": () => this.zoomAt(1.25, width / 2, height / 2),
      "-": () => this.zoomAt(1 / 1.25, width / 2, height / 2),
      "0": () => this.resetView(),
      Enter: () => this.clicked({x: width / 2, y: height / 2}),
    };
    return actions[key];
  }

  get index(): number {
    return this.shared.position[this.axis];
  }

  private scrollTo(index: number): void {
    const last = this.shared.grid.size[this.axis] - 1;
    const position: Triple = [...this.shared.position];
    position[this.axis] = Math.min(Math.max(index, 0), last);
    this.shared.goTo(position);
  }

  /** Shows what has changed: the position, the isovalue, the range, the region. */
  update(): void {
    const {grid, store} = this.shared;
    const letter = AXES[this.axis];
    const last = grid.size[this.axis] - 1;
    const found = store.get(this.axis, this.index);
    if (found) this.slice = found;
    else store.want(this.axis, this.index);
    this.canvas.setAttribute("aria-busy", `${!found}`);
    const text = `${letter} = ${this.index} of 0 to ${last}`;
    this.slider.value = `${this.index}`;
    this.slider.setAttribute("aria-valuetext", text);
    this.name.value = text;
    this.canvas.setAttribute(
      "aria-label",
      `Slice ${this.index} across ${letter}, of 0 to ${last}`,
    );
    this.draw();
  }

  /** A slice that was fetched. */
  arrived(slice: Slice): void {
    if (slice.axis !== this.axis) return;
    // While the user scrolls, a slice that is already passed is better than none.
    this.slice = slice;
    this.update();
  }

  resetView(): void {
    const {size} = this.shared.grid;
    const {right, down} = this.plane;
    this.centre = [(size[right.axis] - 1) / 2, (size[down.axis] - 1) / 2];
    this.zoom = 1;
    this.draw();
  }

  private get extent(): {width: number; height: number} {
    return {width: this.canvas.clientWidth, height: this.canvas.clientHeight};
  }

  /** CSS pixels per unit of length. */
  private get scale(): number {
    const {size, spacing} = this.shared.grid;
    const {right, down} = this.plane;
    const {width, height} = this.extent;
    const long = (axis: number): number => size[axis] * spacing[axis];
    return this.zoom * 0.94 * Math.min(width / long(right.axis), height / long(down.axis));
  }

  /** CSS pixels from one sample to the next, along right and down; negative: to the left or up. */
  private get steps(): [number, number] {
    const {right, down} = this.plane;
    const {spacing} = this.shared.grid;
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

  private unproject({x, y}: Point): [number, number] {
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

  /** The nearest sample of the volume at a pixel; null: beyond the samples. */
  private sampleAt(at: Point): Triple | null {
    const {size} = this.shared.grid;
    const {right, down} = this.plane;
    const [u, v] = this.unproject(at).map((x) => Math.round(x));
    if (u < 0 || v < 0 || u >= size[right.axis] || v >= size[down.axis]) return null;
    const sample: Triple = [...this.shared.position];
    sample[right.axis] = u;
    sample[down.axis] = v;
    return sample;
  }

  private valueAt(sample: Triple): number | null {
    if (!this.slice || this.slice.index !== this.index) return null;
    const {strides, samples} = this.slice;
    return samples[strides.reduce((sum, stride, axis) => sum + stride * sample[axis], 0)];
  }

  private pan(right: number, down: number): void {
    const {size} = this.shared.grid;
    const [stepX, stepY] = this.steps;
    const [axisX, axisY] = [this.plane.right.axis, this.plane.down.axis];
    const within = (v: number, n: number): number => Math.min(Math.max(v, 0), n - 1);
    this.centre = [
      within(this.centre[0] - right / stepX, size[axisX]),
      within(this.centre[1] - down / stepY, size[axisY]),
    ];
    this.draw();
  }

  private zoomAt(factor: number, x: number, y: number): void {
    const [u, v] = this.unproject({x, y});
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.5), MOST_ZOOM);
    const now = this.project(u, v);
    this.pan(x - now.x, y - now.y);
  }

  private wheeled(event: WheelEvent): boolean {
    if (!event.shiftKey) return false;
    // With Shift, browsers report the wheel as horizontal.
    const lines = event.deltaY || event.deltaX;
    this.scrollTo(this.index - Math.sign(lines));
    return true;
  }

  private clicked(at: Point): void {
    const sample = this.sampleAt(at);
    if (!sample) return;
    this.shared.goTo(sample);
    this.pointedAt(at);
  }

  private pointedAt(at: Point | null): void {
    const sample = at && this.sampleAt(at);
    this.readout.value = sample ? this.describe(sample) : "";
    if (!at) return;
    const near = this.edgesNear(at, NEAR.mouse);
    const [x, y] = [near.some(({way}) => way === "right"), near.some(({way}) => way === "down")];
    this.canvas.style.cursor =
      x && y ? "move" : x ? "ew-resize" : y ? "ns-resize" : "crosshair";
  }

  private describe(sample: Triple): string {
    const {grid} = this.shared;
    const value = this.valueAt(sample);
    const place = grid.world(sample).map((v) => number(v, 5)).join(", ");
    return (
      `(${sample.join(", ")}) ` +
      `${value === null ? "" : `value ${Number.isFinite(value) ? number(value, 6) : value} · `}` +
      `(${place})${grid.unitText}${grid.anatomical ? " LPS" : ""}`
    );
  }

  /** The edges of the region that can be dragged from a pixel. */
  private edgesNear({x, y}: Point, most: number): {way: "right" | "down"; end: 0 | 1}[] {
    if (!this.shared.isRegionEdited) return [];
    const {ends} = this.shared.region;
    const {right, down} = this.plane;
    const [u, v] = [ends[right.axis], ends[down.axis]];
    const a = this.project(u[0] - 0.5, v[0] - 0.5);
    const b = this.project(u[1] + 0.5, v[1] + 0.5);
    const isBeside = (p: number, from: number, to: number): boolean =>
      p > Math.min(from, to) - most && p < Math.max(from, to) + most;
    const out: {way: "right" | "down"; end: 0 | 1}[] = [];
    const add = (way: "right" | "down", first: number, last: number): void => {
      const nearest = Math.min(first, last);
      if (nearest < most) out.push({way, end: first <= last ? 0 : 1});
    };
    if (isBeside(y, a.y, b.y)) add("right", Math.abs(x - a.x), Math.abs(x - b.x));
    if (isBeside(x, a.x, b.x)) add("down", Math.abs(y - a.y), Math.abs(y - b.y));
    return out;
  }

  private grabbed(at: Point, event: PointerEvent): Drag | null {
    if (event.button === 2) return this.windowing(at);
    if (event.button !== 0 || event.shiftKey || event.ctrlKey) return null;
    const edges = this.edgesNear(at, NEAR[event.pointerType as keyof typeof NEAR] ?? NEAR.mouse);
    if (edges.length === 0) return null;
    const {region} = this.shared;
    return {
      move: (to) => {
        const [u, v] = this.unproject(to);
        for (const {way, end} of edges) {
          const half = end === 0 ? 0.5 : -0.5;
          region.drag(this.plane[way].axis, end, (way === "right" ? u : v) + half);
        }
        this.shared.regionDragged(false);
      },
      end: () => this.shared.regionDragged(true),
    };
  }

  /** Right: more contrast; down: darker. */
  private windowing(start: Point): Drag {
    const {low, high} = this.shared.range;
    return {
      move: ({x, y}) => {
        const width = (high - low) * Math.exp((start.x - x) / 150);
        const level = (low + high) / 2 + ((y - start.y) * (high - low)) / 200;
        this.shared.setRange({low: level - width / 2, high: level + width / 2});
      },
      end: () => undefined,
    };
  }

  draw(): void {
    if (this.isDrawPending) return;
    this.isDrawPending = true;
    requestAnimationFrame(() => {
      this.isDrawPending = false;
      this.render();
    });
  }

  private samplesOf({samples, strides}: Slice): Samples {
    const {size} = this.shared.grid;
    const {right, down} = this.plane;
    return {
      samples,
      width: size[right.axis],
      height: size[down.axis],
      right: strides[right.axis],
      down: strides[down.axis],
    };
  }

  /** Draws now. The picture can be read from the canvas afterwards. */
  render(): void {
    const {width, height} = this.extent;
    const ratio = Math.min(devicePixelRatio, 2);
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (wide === 0 || high === 0) return;
    const {canvas} = this;
    if (canvas.width !== wide || canvas.height !== high)
      [canvas.width, canvas.height] = [wide, high];
    const context = canvas.getContext("2d")!;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, wide, high);
    // One finger scrolls the page, unless it has something to move here.
    canvas.style.touchAction = this.zoom > 1 || this.shared.isRegionEdited ? "none" : "pan-y";
    const {slice} = this;
    if (slice) {
      this.paintSamples(context, slice, ratio);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      if (this.shared.showsIsoline) this.drawIsoline(context, slice);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawRegion(context);
    if (this.shared.showsCross) this.drawCross(context);
    this.drawEnds(context);
    this.drawScale(context);
    ++this.frames;
  }

  private paintSamples(context: CanvasRenderingContext2D, slice: Slice, ratio: number): void {
    const {width, height} = context.canvas;
    if (this.image?.width !== width || this.image.height !== height)
      this.image = context.createImageData(width, height);
    const [stepX, stepY] = this.steps.map((step) => step * ratio);
    const pixels: PixelGrid = {
      startX: this.centre[0] + (0.5 - width / 2) / stepX,
      stepX: 1 / stepX,
      startY: this.centre[1] + (0.5 - height / 2) / stepY,
      stepY: 1 / stepY,
    };
    const {range, rule, colours} = this.shared;
    const smooth = Math.min(...this.steps.map(Math.abs)) < PIXELATED;
    const into = new Uint32Array(this.image.data.buffer);
    paint(into, width, height, pixels, this.samplesOf(slice), {
      range,
      rule,
      colours,
      notFinite: NOT_FINITE,
      smooth,
    });
    context.putImageData(this.image, 0, 0);
  }

  /** The samples that are visible. */
  private get visible(): SampleRange {
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

  private drawIsoline(context: CanvasRenderingContext2D, slice: Slice): void {
    const segments = isoline(this.samplesOf(slice), this.shared.rule, this.visible);
    const [stepX, stepY] = this.steps;
    const {x, y} = this.project(0, 0);
    context.beginPath();
    for (let i = 0; i < segments.length; i += 4) {
      context.moveTo(x + segments[i] * stepX, y + segments[i + 1] * stepY);
      context.lineTo(x + segments[i + 2] * stepX, y + segments[i + 3] * stepY);
    }
    context.lineCap = "round";
    // A dark casing, so that the line is visible on white, too.
    context.strokeStyle = LINES.casing;
    context.lineWidth = 3;
    context.stroke();
    context.strokeStyle = LINES.isoline;
    context.lineWidth = 1.5;
    context.stroke();
  }

  private drawRegion(context: CanvasRenderingContext2D): void {
    const {region, isRegionEdited, grid} = this.shared;
    if (region.isWhole && !isRegionEdited) return;
    const {right, down} = this.plane;
    const box = (u: readonly number[], v: readonly number[]): [number, number, number, number] => {
      const a = this.project(u[0] - 0.5, v[0] - 0.5);
      const b = this.project(u[1] + 0.5, v[1] + 0.5);
      return [Math.min(a.x, b.x), Math.min(a.y, b.y), Math.abs(b.x - a.x), Math.abs(b.y - a.y)];
    };
    const inner = box(region.ends[right.axis], region.ends[down.axis]);
    const [first, last] = region.ends[this.axis];
    const isOutside = this.index < first || this.index > last;
    context.beginPath();
    context.rect(...box([0, grid.size[right.axis] - 1], [0, grid.size[down.axis] - 1]));
    if (!isOutside) context.rect(...inner);
    context.fillStyle = "rgb(0 0 0 / 50%)";
    context.fill("evenodd");
    context.lineWidth = 1.5;
    context.strokeStyle = LINES.region;
    context.setLineDash(isOutside ? [4, 4] : []);
    context.strokeRect(...inner);
    context.setLineDash([]);
    if (!isRegionEdited) return;
    const [x, y, wide, high] = inner;
    context.fillStyle = LINES.region;
    for (const atX of [0, 0.5, 1])
      for (const atY of [0, 0.5, 1])
        if (atX !== 0.5 || atY !== 0.5)
          context.fillRect(x + atX * wide - 4, y + atY * high - 4, 8, 8);
  }

  private drawCross(context: CanvasRenderingContext2D): void {
    const {x, y} = this.pixelOf(this.shared.position);
    const {width, height} = this.extent;
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
    context.strokeStyle = LINES.cross;
    context.stroke();
  }

  private text(
    context: CanvasRenderingContext2D,
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
    context.strokeStyle = LINES.halo;
    context.strokeText(text, x, y);
    context.fillStyle = LINES.text;
    context.fillText(text, x, y);
  }

  private drawEnds(context: CanvasRenderingContext2D): void {
    const {width, height} = this.extent;
    const {left, right, top, bottom} = this.plane.ends;
    this.text(context, left, 7, height / 2, "left");
    this.text(context, right, width - 7, height / 2, "right");
    this.text(context, top, width / 2, 12, "center");
    this.text(context, bottom, width / 2, height - 12, "center");
  }

  private drawScale(context: CanvasRenderingContext2D): void {
    const {width, height} = this.extent;
    const length = scaleLength(this.scale, Math.min(100, width / 4));
    const pixels = length * this.scale;
    const [right, y] = [width - 10, height - 10];
    for (const [line, colour] of [[4, LINES.halo], [1.5, LINES.text]] as const) {
      context.beginPath();
      context.moveTo(right - pixels, y - 4);
      context.lineTo(right - pixels, y);
      context.lineTo(right, y);
      context.lineTo(right, y - 4);
      context.lineWidth = line;
      context.strokeStyle = colour;
      context.stroke();
    }
    this.text(context, `${number(length)}${this.shared.grid.unitText}`, right, y - 13, "right");
  }
}
