// SPDX-License-Identifier: Apache-2.0
// The slices across one axis: grey values, isoline, cross lines of the other slices, the region of
// interest.
import {button} from "../controls";
import type {Triple} from "../data";
import {element, number} from "../dom";
import {listen, type Drag, type Point} from "../gestures";
import {corners} from "../icons";
import {AXES, type Grid} from "./grid";
import {paint, type GreyRange, type PixelGrid, type Rgb} from "./grey";
import {isoline, type InsideRule, type Samples} from "./isoline";
import type {Region} from "./region";
import {SliceFrame} from "./slice_frame";
import {drawCross, drawEnds, drawIsoline, drawRegion, drawScale} from "./slice_lines";
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
const PIXELATED = 8;  // samples of more CSS pixels are drawn as squares
const NEAR = {mouse: 7, pen: 10, touch: 22};  // CSS pixels from an edge that can be dragged

export class SliceView {
  readonly canvas: HTMLCanvasElement;
  readonly field: HTMLElement;
  private readonly slider: HTMLInputElement;
  // Not live: the slider, which has the focus, has the same text.
  private readonly name = element("output", {"aria-live": "off"});
  private readonly readout: HTMLOutputElement;
  private readonly frame: SliceFrame;
  private readonly id: string;
  private slice: Slice | null = null;
  private image: ImageData | null = null;
  private pointer: Point | null = null;  // where it points to while no button is pressed
  private isDrawPending = false;
  frames = 0;

  constructor(
    readonly axis: number,
    private readonly shared: Shared,
  ) {
    const {grid} = shared;
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
    this.frame = new SliceFrame(grid, axis, this.canvas);
    this.readout = element("output", {
      class: "under-pointer",
      id: `${this.id}-readout`,
      "aria-live": "off",
    });
    this.name.setAttribute("for", this.slider.id);
    const {name} = this.frame.plane;
    const title = name
      ? [`${name} `, element("span", {class: "soft"}, `across ${letter}`)]
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
    new ResizeObserver(() => this.viewChanged()).observe(this.canvas);
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
    // After a drag, the pointer does not move, but no button is pressed any more.
    canvas.addEventListener("pointerup", ({pointerType, offsetX, offsetY}) => {
      if (pointerType !== "touch") this.pointedAt({x: offsetX, y: offsetY});
    });
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
    const {width, height} = this.frame.extent;
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
    this.viewChanged();
  }

  /** A slice that was fetched. */
  arrived(slice: Slice): void {
    if (slice.axis !== this.axis) return;
    // While the user scrolls, a slice that is already passed is better than none.
    this.slice = slice;
    this.update();
  }

  resetView(): void {
    this.frame.reset();
    this.viewChanged();
  }

  /** The pixel of a sample of the volume. */
  pixelOf(sample: Triple): Point {
    return this.frame.pixelOf(sample);
  }

  /** The nearest sample of the volume at a pixel; null: beyond the samples. */
  private sampleAt(at: Point): Triple | null {
    const found = this.frame.sampleAt(at);
    if (!found) return null;
    const {right, down} = this.frame.plane;
    const sample: Triple = [...this.shared.position];
    [sample[right.axis], sample[down.axis]] = found;
    return sample;
  }

  private valueAt(sample: Triple): number | null {
    if (!this.slice || this.slice.index !== this.index) return null;
    const {strides, samples} = this.slice;
    return samples[strides.reduce((sum, stride, axis) => sum + stride * sample[axis], 0)];
  }

  private pan(right: number, down: number): void {
    this.frame.pan(right, down);
    this.viewChanged();
  }

  private zoomAt(factor: number, x: number, y: number): void {
    this.frame.zoomAt(factor, x, y);
    this.viewChanged();
  }

  /** The picture has changed, and what is under the pointer. */
  private viewChanged(): void {
    this.draw();
    this.showPointedAt();
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
    this.pointer = at;
    this.showPointedAt();
  }

  private showPointedAt(): void {
    const at = this.pointer;
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
    const {right, down} = this.frame.plane;
    const [u, v] = [ends[right.axis], ends[down.axis]];
    const a = this.frame.project(u[0] - 0.5, v[0] - 0.5);
    const b = this.frame.project(u[1] + 0.5, v[1] + 0.5);
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
        const [u, v] = this.frame.unproject(to);
        for (const {way, end} of edges) {
          const half = end === 0 ? 0.5 : -0.5;
          region.drag(this.frame.plane[way].axis, end, (way === "right" ? u : v) + half);
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
    const {right, down} = this.frame.plane;
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
    const {frame, slice, canvas} = this;
    const {width, height} = frame.extent;
    const ratio = Math.min(devicePixelRatio, 2);
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (wide === 0 || high === 0) return;
    if (canvas.width !== wide || canvas.height !== high)
      [canvas.width, canvas.height] = [wide, high];
    const context = canvas.getContext("2d")!;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, wide, high);
    // One finger scrolls the page, unless it has something to move here.
    const {grid, region, position, rule, showsIsoline, showsCross, isRegionEdited} = this.shared;
    canvas.style.touchAction = frame.zoom > 1 || isRegionEdited ? "none" : "pan-y";
    if (slice) {
      this.paintSamples(context, slice, ratio);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      if (showsIsoline)
        drawIsoline(context, frame, isoline(this.samplesOf(slice), rule, frame.visible));
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (!region.isWhole || isRegionEdited)
      drawRegion(context, frame, region, grid, this.index, isRegionEdited);
    if (showsCross) drawCross(context, frame, position);
    drawEnds(context, frame);
    drawScale(context, frame, grid.unitText);
    ++this.frames;
  }

  private paintSamples(context: CanvasRenderingContext2D, slice: Slice, ratio: number): void {
    const {width, height} = context.canvas;
    if (this.image?.width !== width || this.image.height !== height)
      this.image = context.createImageData(width, height);
    const [stepX, stepY] = this.frame.steps.map((step) => step * ratio);
    const [u, v] = this.frame.unproject({x: 0.5 / ratio, y: 0.5 / ratio});
    const pixels: PixelGrid = {
      startX: u,
      stepX: 1 / stepX,
      startY: v,
      stepY: 1 / stepY,
    };
    const {range, rule, colours} = this.shared;
    const smooth = Math.min(...this.frame.steps.map(Math.abs)) < PIXELATED;
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
}
