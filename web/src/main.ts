// SPDX-License-Identifier: Apache-2.0
// The page: the mesh, its controls, and the facts about it.
import "./style.css";

import {Vector3} from "three";

import type {Colouring, Legend} from "./colours";
import {choice, cutControl, levelSlider} from "./controls";
import {readMesh, readPage, type Mesh, type Result, type Triple} from "./data";
import {drawn, element, number, plural} from "./dom";
import {errorText, facts, origin, summary} from "./facts";
import {listen} from "./gestures";
import {Overlay} from "./overlay";
import {contextOf, LevelShape, Scene, toFile, type Style} from "./scene";

const AXES = ["x", "y", "z"] as const;
const HELP = [
  ["Rotate", "drag, or arrow keys"],
  ["Pan", "right button, two fingers, or Shift and drag or arrows"],
  ["Zoom", "wheel, pinch, or + and −"],
  ["Level", "[ and ]"],
  ["Along an axis", "x, y, z"],
  ["Worst triangle, whole mesh", "w, 0"],
];
const THEME = {
  clay: "--clay",
  inside: "--inside",
  paper: "--paper",
  paperInside: "--paper-inside",
  ink: "--edge",
  section: "--section",
};

/** A half-filled circle. */
function halfMoon(): SVGElement {
  return drawn(
    "svg",
    {viewBox: "0 0 20 20", width: 20, height: 20, "aria-hidden": "true", class: "icon"},
    drawn("circle", {cx: 10, cy: 10, r: 7.25}),
    drawn("path", {d: "M10 2.75a7.25 7.25 0 0 1 0 14.5z"}),
  );
}

class PageView {
  private readonly page = readPage();
  private readonly canvas = element("canvas", {
    id: "view",
    tabindex: "0",
    role: "application",
    "aria-roledescription": "3-D view",
    "aria-label": "Mesh",
    "aria-describedby": "help",
  });
  private readonly overlay = new Overlay();
  private readonly legend = element("div", {class: "legend", id: "legend"});
  private readonly status = element("p", {class: "status", id: "status", role: "status"});
  private readonly title = element("h1");
  private readonly subtitle = element("p", {class: "soft"});
  private readonly facts = element("div", {id: "facts"});
  private readonly madeBy = element("div");
  private readonly which = element("select", {id: "result", "aria-label": "Result"});
  private readonly theme = element(
    "button",
    {
      type: "button",
      id: "theme",
      "aria-pressed": "false",
      "aria-label": "Dark theme",
      title: "Light or dark",
    },
    halfMoon(),
  );
  private readonly level = levelSlider(() => this.update());
  private readonly style = choice<Style>(
    "style",
    "Shading",
    [
      {value: "smooth", text: "Smooth"},
      {value: "split", text: "Both"},
      {value: "lines", text: "Hidden line"},
    ],
    () => this.update(),
  );
  private readonly colouring = choice<Colouring>(
    "colouring",
    "Colour",
    [
      {value: "plain", text: "Plain"},
      {value: "aspect", text: "Aspect ratio"},
      {value: "distance", text: "Distance error"},
      {value: "component", text: "Component"},
      {value: "level", text: "Level of vertex"},
    ],
    () => this.update(),
  );
  private readonly cuts = AXES.map((axis, i) => cutControl(axis, axis === "y", () => this.cut(i)));
  private scene: Scene | null = null;
  private result!: Result;
  private mesh!: Mesh;
  private shapes: LevelShape[] = [];
  private colourLegend: Legend | null = null;

  async start(): Promise<void> {
    this.build();
    // Before the canvas gets its size, because resizing waits for the graphics process.
    this.head(this.page.results[0]);
    this.startScene();
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.setTheme(dark.matches));
    this.setTheme(dark.matches);
    await this.open(0);
  }

  private build(): void {
    const {results} = this.page;
    this.which.append(
      ...results.map((result, i) => element("option", {value: `${i}`}, result.title)),
    );
    this.which.hidden = results.length < 2;
    this.which.addEventListener(
      "change",
      () => void this.open(Number(this.which.value)).catch(fail),
    );
    this.theme.addEventListener("click", () =>
      this.setTheme(document.documentElement.dataset.theme !== "dark"),
    );
    const worst = element("button", {type: "button", id: "worst"}, "Worst triangle");
    worst.addEventListener("click", () => this.showWorst());
    const reset = element("button", {type: "button", id: "reset"}, "Whole mesh");
    reset.addEventListener("click", () => this.reset());
    const help = element(
      "details",
      {class: "help"},
      element("summary", {}, "Mouse, touch, keyboard"),
      element(
        "dl",
        {id: "help"},
        ...HELP.flatMap(([what, how]) => [element("dt", {}, what), element("dd", {}, how)]),
      ),
    );
    document.body.append(
      element(
        "main",
        {},
        element(
          "section",
          {class: "stage", "aria-label": "Mesh"},
          element(
            "header",
            {},
            element("div", {class: "titles"}, this.title, this.subtitle),
            this.which,
            this.theme,
          ),
          element("div", {class: "picture"}, this.canvas, this.overlay.svg),
          this.legend,
          this.level.field,
        ),
        element(
          "div",
          {class: "panel"},
          element(
            "section",
            {class: "controls", "aria-label": "View"},
            this.style.field,
            this.colouring.field,
            element(
              "fieldset",
              {},
              element("legend", {}, "Cut"),
              ...this.cuts.map(({field}) => field),
            ),
            element("div", {class: "buttons"}, worst, reset),
            this.status,
            help,
          ),
          this.facts,
          this.madeBy,
          element("footer", {class: "soft"}, `isoatlas ${this.page.version}`),
        ),
      ),
    );
  }

  private startScene(): void {
    const context = contextOf(this.canvas);
    if (!context) {
      const words =
        "The mesh cannot be drawn: this browser has no WebGL 2, or it is disabled. " +
        "The tables contain all facts about the mesh.";
      this.canvas.replaceWith(element("p", {class: "missing", role: "alert"}, words));
      this.overlay.svg.remove();
      this.legend.remove();
      document.querySelector(".controls")!.remove();
      return;
    }
    this.scene = new Scene(this.canvas, context, () => {
      this.overlay.update(this.scene!.camera, this.canvas.clientWidth, this.canvas.clientHeight);
    });
    listen(this.canvas, this.scene.camera);
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("webglcontextlost", () =>
      this.setStatus(
        "The browser has lost access to the graphics card. " +
          "Wait until it is restored, or reload the page.",
      ),
    );
  }

  private async open(index: number): Promise<void> {
    const result = this.page.results[index];
    const mesh = await readMesh(result);
    this.result = result;
    this.mesh = mesh;
    this.shapes = mesh.levels.map((level) => new LevelShape(level));
    this.head(result);
    this.level.open(mesh.levels.length, mesh.levels.length - 1);
    this.colouring.enable(
      "distance",
      mesh.levels.some(({distance}) => distance !== null),
      "The file has no distance error per vertex.",
    );
    this.colouring.enable(
      "level",
      result.nested !== false,
      "The files do not contain the first level of a vertex.",
    );
    this.overlay.unit = this.lengthUnit();
    this.scene?.show(mesh, this.shapes);
    for (const cut of this.cuts) cut.reset();
    this.madeBy.replaceChildren(origin(result));
    this.update();
    // The page is ready when the first picture is sent to the screen.
    requestAnimationFrame(() => requestAnimationFrame(() => {
      document.documentElement.dataset.ready = `${index}`;
      performance.mark("ready");
    }));
  }

  private head(result: Result): void {
    document.title = `${result.title} – isoatlas`;
    this.title.textContent = result.title;
    this.subtitle.textContent = summary(result);
  }

  private get shown(): number {
    return Number(this.level.input.value);
  }

  /** Unit of positions. Errors are in the unit of the result for every space of the mesh. */
  private lengthUnit(): string {
    return this.result.parameters?.space === "voxel" ? "voxels" : this.result.unit;
  }

  private update(): void {
    const level = this.result.levels[this.shown];
    const error = errorText(level, this.result.unit);
    const last = this.result.levels.length - 1;
    this.level.setText(`${this.shown} of ${last} · ${plural(level.triangles, "triangle")}`, error);
    const genus = level.genus == null ? "" : `, genus ${level.genus}`;
    this.canvas.setAttribute(
      "aria-label",
      `Mesh of ${this.result.title}, level ${this.shown} of ${last}: ` +
        `${plural(level.vertices, "vertex", "vertices")}, ` +
        `${plural(level.triangles, "triangle")}, ` +
        `${plural(level.components, "component")}${genus}, ${error}`,
    );
    this.overlay.worst = null;
    this.overlay.split = this.style.value() === "split";
    this.setStatus("");
    if (this.scene) {
      this.colourLegend = this.scene.update(
        this.shown,
        this.style.value(),
        this.colouring.value(),
        this.result.unit,
      );
      this.updateLegend();
    }
    this.facts.replaceChildren(...facts(this.result, this.shown, this.shapes));
  }

  private cut(axis: number): void {
    const control = this.cuts[axis];
    if (!this.scene || !this.mesh) return;
    const share = control.share();
    this.scene.cut(axis, {share, keep: control.keepsAbove() ? "above" : "below"});
    const at = this.mesh.centre[axis] + (2 * share - 1) * this.mesh.half[axis];
    control.setText(
      this.scene.isCut(axis) ? `${control.keepsAbove() ? "≥" : "≤"} ${number(at, 4)}` : "off",
    );
    this.updateLegend();
  }

  private updateLegend(): void {
    const legend = this.colourLegend;
    const out: HTMLElement[] = [];
    if (legend?.title) out.push(element("p", {class: "legend-title"}, legend.title));
    if (legend?.ramp) {
      const bar = element("div", {class: "bar"});
      bar.style.background = `linear-gradient(to right, ${legend.ramp.colours.join(", ")})`;
      out.push(
        element(
          "div",
          {class: "ramp"},
          bar,
          element(
            "div",
            {class: "ends"},
            ...legend.ramp.ticks.map((text) => element("span", {}, text)),
          ),
        ),
      );
    }
    if (legend?.steps) {
      const {colours, shares, ticks} = legend.steps;
      const bar = element("div", {class: "bar"}, ...colours.map((colour, i) => {
        const step = element("span");
        step.style.background = colour;
        step.style.flexGrow = `${shares[i]}`;
        return step;
      }));
      const below = element("div", {class: "ticks"}, ...ticks.map(({at, text}) => {
        const tick = element("span", {}, text);
        tick.style.left = `${100 * at}%`;
        return tick;
      }));
      out.push(element("div", {class: "ramp"}, bar, below));
    }
    const classes = [...(legend?.classes ?? [])];
    if (this.scene && AXES.some((_, axis) => this.scene!.isCut(axis)))
      classes.push({colour: "var(--inside)", name: "inside"});
    if (classes.length > 0) {
      out.push(element("ul", {class: "classes"}, ...classes.map(({colour, name}) => {
        const swatch = element("span", {class: "swatch"});
        swatch.style.background = colour;
        return element("li", {}, swatch, name);
      })));
    }
    if (legend?.note) out.push(element("p", {}, legend.note));
    this.legend.replaceChildren(...out);
  }

  private showWorst(): void {
    const worst = this.shapes[this.shown].worst();
    if (!worst || !this.scene) return;
    this.overlay.worst = worst;
    this.scene.centre(worst, this.shown);
    const [x, y, z] = toFile(worst.centroid, this.mesh.centre).map((v) => number(v, 5));
    this.setStatus(
      `The worst triangle of level ${this.shown} has aspect ratio ${number(worst.ratio)}, ` +
        `at (${x}, ${y}, ${z}).`,
    );
  }

  private reset(): void {
    this.overlay.worst = null;
    this.setStatus("");
    for (const cut of this.cuts) cut.reset();
    this.scene?.camera.goHome();
  }

  private setStatus(text: string): void {
    this.status.textContent = text;
  }

  private setTheme(dark: boolean): void {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    this.theme.setAttribute("aria-pressed", `${dark}`);
    const style = getComputedStyle(document.documentElement);
    this.scene?.theme(
      Object.fromEntries(
        Object.entries(THEME).map(([name, property]) => [
          name,
          style.getPropertyValue(property).trim(),
        ]),
      ),
    );
  }

  private step(by: number): void {
    const {input} = this.level;
    const before = input.value;
    input.value = `${this.shown + by}`;
    if (input.value !== before) this.update();
  }

  private key(event: KeyboardEvent): void {
    if (!this.scene || event.ctrlKey || event.metaKey || event.altKey) return;
    const {camera} = this.scene;
    const arrow = (right: number, down: number) => (): void =>
      event.shiftKey ? camera.pan(30 * right, 30 * down) : camera.rotate(24 * right, 24 * down);
    const actions: Record<string, () => void> = {
      ArrowLeft: arrow(-1, 0),
      ArrowRight: arrow(1, 0),
      ArrowUp: arrow(0, -1),
      ArrowDown: arrow(0, 1),
      "+": () => camera.zoomAt(1.2),
      "=": () => camera.zoomAt(1.2),
      "-": () => camera.zoomAt(1 / 1.2),
      "0": () => this.reset(),
      Home: () => this.reset(),
      "[": () => this.step(-1),
      "]": () => this.step(1),
      w: () => this.showWorst(),
      x: () => camera.lookAlong(0),
      y: () => camera.lookAlong(1),
      z: () => camera.lookAlong(2),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  /** The shown state, read-only, for scripts and tests. */
  readonly api = Object.freeze(
    Object.defineProperties(
      {},
      Object.fromEntries(
        Object.entries({
          result: () => this.page.results.indexOf(this.result),
          level: () => this.shown,
          style: () => this.style.value(),
          colouring: () => this.colouring.value(),
          moving: () => this.scene?.camera.moving ?? false,
          frames: () => this.scene?.frames ?? 0,
          zoom: () => this.scene?.camera.pose.zoom ?? 1,
          centre: () => this.mesh.centre,
          components: () => this.shapes[this.shown].components().list,
          /** The worst triangle of the shown level. */
          worst: () => {
            const worst = this.shapes[this.shown].worst();
            return (
              worst && {
                triangle: worst.triangle,
                ratio: worst.ratio,
                centroid: toFile(worst.centroid, this.mesh.centre),
              }
            );
          },
          /** The position of a point of the file in the picture, in pixels from the upper left. */
          project: () => (point: Triple) =>
            this.scene?.camera.project(
              new Vector3(...(point.map((v, axis) => v - this.mesh.centre[axis]) as Triple)),
            ),
          /** The picture as a data URL. */
          picture: () => () => {
            this.scene?.render();
            return this.canvas.toDataURL();
          },
        }).map(([name, get]) => [name, {get, enumerable: true}]),
      ),
    ),
  );
}

function fail(reason: unknown): void {
  document.body.append(
    element(
      "p",
      {class: "missing bad", role: "alert"},
      `This page cannot be shown: ${reason instanceof Error ? reason.message : String(reason)}.`,
    ),
  );
}

try {
  const view = new PageView();
  Object.defineProperty(window, "isoatlas", {value: view.api});
  view.start().catch(fail);
} catch (reason) {
  fail(reason);
}
