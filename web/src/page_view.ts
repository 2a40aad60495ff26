// SPDX-License-Identifier: Apache-2.0
// The page: the mesh, its controls, and the facts about it.
import {Vector3} from "three";

import type {Colouring, Legend} from "./colours";
import {ComponentChoice, ComponentList, keptAndDropped} from "./component_list";
import {button, checkbox, choice, cutControl, levelSlider} from "./controls";
import {readMesh, readPage, type Mesh, type Result, type Triple} from "./data";
import {element, number, plural, readOnly} from "./dom";
import {saveMesh, savePicture, type Saved} from "./exports";
import {facts, summary} from "./facts";
import {listen} from "./gestures";
import {corners} from "./icons";
import {Inspector, type Shown} from "./inspector";
import {HELP, keyAction} from "./keys";
import {legendOf} from "./legend";
import {LevelShape} from "./level_shape";
import {madeBy} from "./made_by";
import type {MeshFormat} from "./mesh_files";
import {orientationOf, type Orientation, type Side} from "./orientation";
import {Overlay} from "./overlay";
import {contextOf, Scene, STYLES, toFile, type Style} from "./scene";
import {Theme} from "./theme";
import {viewOf, viewText, type LinkedView} from "./view_link";
import {errorText, levelName} from "./words";

const AXES = ["x", "y", "z"] as const;
const COLOURINGS: {value: Colouring; text: string}[] = [
  {value: "plain", text: "Plain"},
  {value: "aspect", text: "Aspect ratio"},
  {value: "distance", text: "Distance error"},
  {value: "component", text: "Component"},
  {value: "level", text: "Level of vertex"},
];
const FORMATS: {value: MeshFormat; text: string}[] = [
  {value: "glb", text: ".glb"},
  {value: "ply", text: ".ply"},
  {value: "stl", text: ".stl"},
];
export function fail(reason: unknown): void {
  document.body.append(
    element(
      "p",
      {class: "missing bad", role: "alert"},
      `This page cannot be shown: ${reason instanceof Error ? reason.message : String(reason)}.`,
    ),
  );
}

export class PageView {
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
  private readonly picture = element("div", {class: "picture"}, this.canvas, this.overlay.svg);
  private readonly legend = element("div", {class: "legend", id: "legend"});
  private readonly title = element("h1");
  private readonly subtitle = element("p", {class: "soft"});
  private readonly facts = element("div", {id: "facts"});
  private readonly madeBy = element("div");
  private readonly which = element("select", {id: "result", "aria-label": "Result"});
  private readonly theme = new Theme((colours) => this.scene?.theme(colours));
  private readonly fullScreen = button("full-screen", corners(), () => this.toggleFullScreen(), {
    class: "bare-icon",
    "aria-pressed": "false",
    "aria-label": "Full screen",
    title: "Full screen (f)",
  });
  private readonly stage = element("section", {class: "stage", "aria-label": "Mesh"});
  private readonly level = levelSlider(() => this.update());
  private readonly style = choice<Style>("style", "Shading", STYLES, () => this.update());
  private readonly colouring = choice<Colouring>("colouring", "Colour", COLOURINGS, () =>
    this.update(),
  );
  private readonly cuts = AXES.map((axis, i) => cutControl(axis, axis === "y", () => this.cut(i)));
  private readonly filled = checkbox("fill-cuts", "Fill the cut", () => this.fillCuts());
  private readonly sides = element("div", {class: "sides"});
  private readonly format = element(
    "select",
    {id: "format", "aria-label": "Format of the mesh"},
    ...FORMATS.map(({value, text}) => element("option", {value}, text)),
  );
  private readonly components = new ComponentChoice(() => this.componentsChanged());
  private readonly componentList = new ComponentList(this.components);
  private scene: Scene | null = null;
  private inspector: Inspector | null = null;
  private result!: Result;
  private mesh!: Mesh;
  private orientation!: Orientation;
  private shapes: LevelShape[] = [];
  private colourLegend: Legend | null = null;

  async start(): Promise<void> {
    this.build();
    // Before the canvas gets its size, because resizing waits for the graphics process.
    this.head(this.page.results[0]);
    this.startScene();
    this.theme.start();
    addEventListener("hashchange", () => void this.follow(location.hash).catch(fail));
    const linked = viewOf(location.hash);
    await this.open(this.page.results[linked?.result ?? 0] ? (linked?.result ?? 0) : 0);
    if (linked) this.show(linked);
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
    this.filled.input.checked = true;
    this.fullScreen.hidden = !document.fullscreenEnabled;
    this.stage.addEventListener("fullscreenchange", () =>
      this.fullScreen.setAttribute("aria-pressed", `${document.fullscreenElement !== null}`),
    );
    this.stage.append(
      element(
        "header",
        {},
        element("div", {class: "titles"}, this.title, this.subtitle),
        this.which,
        this.theme.button,
        this.fullScreen,
      ),
      this.picture,
      this.legend,
      this.level.field,
    );
    document.body.append(
      element(
        "main",
        {},
        this.stage,
        element(
          "div",
          {class: "panel"},
          element("section", {class: "controls", "aria-label": "View"}, ...this.controls()),
          this.facts,
          this.madeBy,
          element("footer", {class: "soft"}, `isoatlas ${this.page.version}`),
        ),
      ),
    );
  }

  private controls(): HTMLElement[] {
    const group = (legend: string, ...children: HTMLElement[]): HTMLElement =>
      element("fieldset", {}, element("legend", {}, legend), ...children);
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
    return [
      this.style.field,
      this.colouring.field,
      group("View from", this.sides),
      group("Cut", ...this.cuts.map(({field}) => field), this.filled.field),
      element(
        "div",
        {class: "buttons", id: "tools"},
        button("worst", "Worst triangle", () => this.showWorst()),
        button("reset", "Whole mesh", () => this.reset()),
      ),
      group(
        "Save",
        element(
          "div",
          {class: "buttons"},
          button("save-picture", "Picture", () => this.savePicture(), {title: "As PNG (p)"}),
          element(
            "span",
            {class: "joined"},
            button("save-mesh", "Mesh as", () => this.saveMesh(), {
              title: "The components shown, at this level",
            }),
            this.format,
          ),
          button("copy-view", "Link to this view", () => this.linkView()),
        ),
      ),
      help,
    ];
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
      this.fullScreen.remove();
      return;
    }
    this.scene = new Scene(this.canvas, context, () => this.drawOverlay());
    this.inspector = new Inspector(
      this.scene,
      this.overlay,
      this.components,
      () => this.inspected(),
      () => this.drawOverlay(),
    );
    this.picture.append(this.inspector.card);
    document.getElementById("tools")!.prepend(this.inspector.measure);
    listen(this.canvas, this.scene.camera, this.inspector);
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    // The cross shows where the keyboard points.
    for (const event of ["focus", "blur", "keydown", "pointerdown"])
      this.canvas.addEventListener(event, () => this.drawOverlay());
    this.canvas.addEventListener("webglcontextlost", () =>
      this.setStatus(
        "The browser has lost access to the graphics card. " +
          "Wait until it is restored, or reload the page.",
      ),
    );
  }

  private drawOverlay(): void {
    this.overlay.crosshair = this.canvas.matches(":focus-visible");
    this.overlay.update(this.scene!.camera, this.canvas.clientWidth, this.canvas.clientHeight);
  }

  private async open(index: number): Promise<void> {
    const result = this.page.results[index];
    const mesh = await readMesh(result);
    this.result = result;
    this.mesh = mesh;
    const finest = new LevelShape(mesh.levels[mesh.levels.length - 1]);
    this.shapes = mesh.levels.map((level) =>
      level === finest.level ? finest : new LevelShape(level, finest),
    );
    this.orientation = orientationOf(result);
    this.which.value = `${index}`;
    this.head(result);
    this.level.open(result.levels.map(levelName), mesh.levels.length - 1);
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
    this.overlay.orientation = this.orientation;
    this.sides.replaceChildren(...this.orientation.sides.map((side) => this.sideButton(side)));
    this.scene?.show(mesh, this.shapes);
    this.components.hidden.clear();
    this.components.selected = null;
    this.scene?.showComponents(this.components.isShown);
    this.inspector?.reset();
    for (const cut of this.cuts) cut.reset();
    this.madeBy.replaceChildren(madeBy(result));
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

  private sideButton({name, end, from, up}: Side): HTMLElement {
    const id = `view-${name.toLowerCase()}`;
    const text = element("span", {}, `${name} `, element("span", {class: "end"}, end));
    return button(id, text, () =>
      this.scene?.camera.lookFrom(new Vector3(...from), new Vector3(...up)),
    );
  }

  private get shown(): number {
    return Number(this.level.input.value);
  }

  private get shape(): LevelShape {
    return this.shapes[this.shown];
  }

  /** Unit of positions. Errors are in the unit of the result for every space of the mesh. */
  private lengthUnit(): string {
    return this.result.parameters?.space === "voxel" ? "voxels" : this.result.unit;
  }

  private inspected(): Shown {
    const space = this.result.parameters?.space;
    return {
      mesh: this.mesh,
      shape: this.shape,
      unit: this.lengthUnit(),
      errorUnit: this.result.unit,
      space: this.orientation.anatomical && typeof space === "string" ? space.toUpperCase() : "",
      facing: this.scene?.facing ?? 1,
    };
  }

  private update(): void {
    const level = this.result.levels[this.shown];
    const error = errorText(level, this.result.unit);
    const last = levelName(this.result.levels[this.result.levels.length - 1]);
    const position = `${levelName(level)} of ${last}`;
    this.level.setText(`${position} · ${plural(level.triangles, "triangle")}`, error);
    const genus = level.genus == null ? "" : `, genus ${level.genus}`;
    this.canvas.setAttribute(
      "aria-label",
      `Mesh of ${this.result.title}, level ${position}: ` +
        `${plural(level.vertices, "vertex", "vertices")}, ` +
        `${plural(level.triangles, "triangle")}, ` +
        `${plural(level.components, "component")}${genus}, ${error}`,
    );
    this.overlay.worst = null;
    this.overlay.split = this.style.value() === "split";
    if (!this.inspector?.isMeasuring) this.setStatus("");
    this.inspector?.refresh();
    if (this.scene) {
      this.colourLegend = this.scene.update(
        this.shown,
        this.style.value(),
        this.colouring.value(),
        this.result.unit,
      );
      this.filled.input.disabled = !this.scene.canFillCuts();
      this.updateLegend();
    }
    const components = this.componentList.open(
      this.shape,
      this.lengthUnit(),
      this.scene?.facing ?? 1,
      keptAndDropped(this.result),
    );
    this.facts.replaceChildren(...facts(this.result, this.shown, this.shapes, components));
  }

  private componentsChanged(): void {
    this.scene?.showComponents(this.components.isShown);
    this.componentList.refresh();
    this.inspector?.refresh();
    this.updateLegend();
  }

  private cut(axis: number): void {
    const control = this.cuts[axis];
    if (!this.scene || !this.mesh) return;
    const share = control.share();
    this.scene.cut(axis, {share, keep: control.keepsAbove() ? "above" : "below"});
    const at = this.mesh.centre[axis] + (2 * share - 1) * this.mesh.half[axis];
    const sign = control.keepsAbove() ? "≥" : "≤";
    control.setText(
      this.scene.isCut(axis) ? `${sign} ${number(at, 4)} ${this.lengthUnit()}` : "off",
    );
    this.updateLegend();
  }

  private fillCuts(): void {
    this.scene?.fillCuts(this.filled.input.checked);
    this.updateLegend();
  }

  private updateLegend(): void {
    const more: {colour: string; name: string}[] = [];
    if (this.scene && AXES.some((_, axis) => this.scene!.isCut(axis))) {
      if (this.scene.areCutsFilled) more.push({colour: "var(--cap)", name: "cut"});
      else more.push({colour: "var(--inside)", name: "inside"});
    }
    this.legend.replaceChildren(...legendOf(this.colourLegend, more));
  }

  private showWorst(): void {
    const worst = this.shape.worst();
    if (!worst || !this.scene) return;
    const component = this.shape.componentOf(worst.triangle);
    if (!this.components.isShown(component)) this.components.show(component, true);
    this.overlay.worst = worst;
    this.scene.centre(worst, this.shown);
    const [x, y, z] = toFile(worst.centroid, this.mesh.centre).map((v) => number(v, 5));
    this.setStatus(
      `The worst triangle of level ${levelName(this.result.levels[this.shown])} has aspect ratio ` +
        `${number(worst.ratio)}, at (${x}, ${y}, ${z}).`,
    );
  }

  private reset(): void {
    this.overlay.worst = null;
    this.inspector?.reset();
    for (const cut of this.cuts) cut.reset();
    this.components.reset();
    this.scene?.camera.goHome();
  }

  private setStatus(text: string): void {
    this.inspector?.setStatus(text);
  }

  private toggleFullScreen(): void {
    const done = document.fullscreenElement
      ? document.exitFullscreen()
      : this.stage.requestFullscreen();
    done.catch(() => this.setStatus("The browser does not allow full screen here."));
  }

  private saved(): Saved {
    const {result, mesh, shape, components, page} = this;
    return {result, mesh, shape, choice: components, version: page.version};
  }

  private savePicture(): void {
    if (!this.scene) return;
    const {backgroundColor} = getComputedStyle(this.stage);
    savePicture(this.saved(), this.scene, this.overlay, this.canvas, backgroundColor).catch(
      (reason) => this.setStatus(`The picture was not saved: ${String(reason)}.`),
    );
  }

  private saveMesh(): void {
    this.setStatus(saveMesh(this.format.value as MeshFormat, this.saved()));
  }

  private linkView(): void {
    const text = viewText({
      result: this.page.results.indexOf(this.result),
      level: this.shown,
      style: this.style.value(),
      colouring: this.colouring.value(),
      pose: this.scene!.camera.pose,
      cuts: this.cuts.map((cut) => cut.state()),
      filled: this.filled.input.checked,
      hidden: [...this.components.hidden],
    });
    history.replaceState(null, "", `#${text}`);
    const stated = "The address of this page now contains the view";
    const done = (): void => this.setStatus(`${stated}, and is in the clipboard.`);
    const failed = (): void => this.setStatus(`${stated}: copy it from the address bar.`);
    if (navigator.clipboard) navigator.clipboard.writeText(location.href).then(done, failed);
    else failed();
  }

  private async follow(hash: string): Promise<void> {
    const view = viewOf(hash);
    if (!view) return;
    const result = this.page.results[view.result];
    if (result && result !== this.result) await this.open(view.result);
    this.show(view);
  }

  /** Shows a linked view. What this page does not have is left as it is. */
  private show(view: LinkedView): void {
    if (view.level < this.mesh.levels.length) this.level.input.value = `${view.level}`;
    this.style.set(view.style as Style);
    this.colouring.set(view.colouring as Colouring);
    this.filled.input.checked = view.filled;
    this.fillCuts();
    view.cuts.forEach((cut, axis) => this.cuts[axis].set(cut));
    this.update();
    const all = this.shape.components().list.length;
    this.components.set(view.hidden.filter((component) => component < all));
    this.scene?.camera.set(view.pose);
  }

  private step(by: number): void {
    const {input} = this.level;
    const before = input.value;
    input.value = `${this.shown + by}`;
    if (input.value !== before) this.update();
  }

  private key(event: KeyboardEvent): void {
    const {scene, inspector, canvas} = this;
    if (!scene || !inspector || event.ctrlKey || event.metaKey || event.altKey) return;
    const action = keyAction(event, scene.camera, {
      reset: () => this.reset(),
      step: (levels) => this.step(levels),
      showWorst: () => this.showWorst(),
      lookFromSide: (side) => (this.sides.children[side] as HTMLElement).click(),
      clickCentre: () =>
        inspector.clicked({x: canvas.clientWidth / 2, y: canvas.clientHeight / 2}),
      toggleMeasuring: () => inspector.setMeasuring(!inspector.isMeasuring),
      end: () => this.end(),
      hideSelected: () => inspector.hideSelected(),
      isolateSelected: () => inspector.isolateSelected(),
      showAll: () => this.components.set([]),
      toggleFullScreen: () => this.toggleFullScreen(),
      savePicture: () => this.savePicture(),
    });
    if (!action) return;
    event.preventDefault();
    action();
  }

  /** Ends measuring and the selection. */
  private end(): void {
    this.inspector?.reset();
    this.components.select(null);
  }

  /** The shown state, read-only, for scripts and tests. */
  readonly api = readOnly({
    result: () => this.page.results.indexOf(this.result),
    /** Index of the shown level; 0 is the coarsest. */
    level: () => this.shown,
    style: () => this.style.value(),
    colouring: () => this.colouring.value(),
    moving: () => this.scene?.camera.moving ?? false,
    frames: () => this.scene?.frames ?? 0,
    zoom: () => this.scene?.camera.pose.zoom ?? 1,
    /** Rotation of the camera as a quaternion x, y, z, w. */
    rotation: () => this.scene?.camera.pose.rotation.toArray(),
    centre: () => this.mesh.centre,
    components: () => this.shape.components().list,
    /** Per component its bounding box relative to the centre, area and volume. */
    measures: () => this.shape.measures(),
    /** Indices of the hidden components, and of the selected one. */
    hidden: () => [...this.components.hidden],
    selected: () => this.components.selected,
    /** Measured points in the coordinates of the file, and their distance. */
    measured: () => this.inspector?.measured,
    /** The worst triangle of the shown level. */
    worst: () => {
      const worst = this.shape.worst();
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
    /** What is at a pixel: its position in the file, the component; null: nothing. */
    pick: () => (x: number, y: number) => {
      const picked = this.scene?.pick(x, y);
      return picked
        ? {
            point: toFile(picked.point, this.mesh.centre),
            triangle: picked.triangle,
            component: picked.component,
          }
        : null;
    },
    /** The picture as a data URL. */
    picture: () => () => {
      this.scene?.render();
      return this.canvas.toDataURL();
    },
  });
}
