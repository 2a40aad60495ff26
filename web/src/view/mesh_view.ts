// SPDX-License-Identifier: Apache-2.0
// The mesh of the isosurface in 3-D, and what is known about it.
import {Vector3} from "three";

import type {Colouring} from "../colours";
import {ComponentChoice, ComponentList} from "../component_list";
import {button} from "../controls";
import type {Mesh, Triple} from "../data";
import {count, element, number, plural, type Child} from "../dom";
import {listen} from "../gestures";
import {corners} from "../icons";
import {Inspector} from "../inspector";
import {keyAction} from "../keys";
import {LevelShape} from "../level_shape";
import {orientationIn, type Side as ViewedSide} from "../orientation";
import {Overlay} from "../overlay";
import {contextOf, Scene, toFile, type Style} from "../scene";
import type {Outline} from "../outlines";
import type {Grid} from "./grid";
import type {MeshFollower, Shown} from "./mesh_follower";
import {longestEdge, nearestTriangle} from "./nearest_triangle";
import type {Region} from "./region";
import {progressText} from "./stages";

const LIST_AFTER = 150;  // ms without another mesh
const MOST_REMEMBERED = 50;
const ID = "mesh";

/** Components by one vertex of each. */
interface Remembered {
  points: Triple[];
  /** Whether these are the hidden components, or the shown ones. */
  hides: boolean;
}

export class MeshView {
  readonly canvas = element("canvas", {
    id: "view",
    tabindex: "0",
    role: "application",
    "aria-roledescription": "3-D view",
    "aria-label": "Mesh",
    "aria-describedby": "help",
  });
  readonly field: HTMLElement;
  readonly sides = element("div", {class: "sides"});
  readonly components = new ComponentChoice((hidden) => this.componentsChanged(hidden));
  readonly scene: Scene | null;
  private readonly overlay = new Overlay();
  private readonly inspector: Inspector | null = null;
  private readonly list = new ComponentList(this.components);
  /** The list of components. */
  readonly listed = element("div", {id: "component-list"});
  private readonly line = element("span", {id: "mesh-line", role: "status"});
  private readonly done = element("span", {id: "mesh-done", "aria-hidden": "true"});
  private readonly bar = element("progress", {id: "mesh-progress", max: "1"});
  private readonly stop = button("cancel-mesh", "Cancel", () => this.follower.cancel(), {
    class: "small",
  });
  private shown: Shown | null = null;
  private shape: LevelShape | null = null;
  /** Which components the user hides, in meshes of any isovalue. */
  private remembered: Remembered | null = null;
  /** The points of `remembered` that the shown mesh has no component at. */
  private unmatched: Triple[] = [];
  private listing = 0;
  private style: Style = "smooth";
  private colouring: Colouring = "plain";
  showsSlices = true;

  /**
   * @param follower makes the meshes
   * @param position the sample at which the slices intersect
   * @param host what is shown above the list of components; what follows when others are chosen;
   *        what has the focus after Cancel, which disappears
   */
  constructor(
    private readonly grid: Grid,
    private readonly follower: MeshFollower,
    private readonly position: () => Triple,
    private readonly region: Region,
    private readonly host: {notes: () => Child[]; chosen: () => void; focusHandle: () => void},
    enlarge: (id: string) => void,
  ) {
    const picture = element("div", {class: "picture"}, this.canvas, this.overlay.svg);
    this.field = element(
      "section",
      {class: "view", "data-view": ID, "aria-label": "Mesh"},
      element(
        "div",
        {class: "view-head"},
        element("h2", {}, "Mesh"),
        button("fit", "Fit", () => this.fit(), {class: "small", title: "Show the whole mesh (0)"}),
        button(`enlarge-${ID}`, corners(), () => enlarge(ID), {
          class: "bare-icon",
          "aria-pressed": "false",
          "aria-label": "Enlarge the mesh",
          title: "Enlarge",
        }),
      ),
      picture,
      element(
        "div",
        {class: "view-foot"},
        element("p", {}, this.line, this.done),
        this.bar,
        this.stop,
      ),
    );
    const orientation = orientationIn("lps", grid.anatomical);
    this.overlay.orientation = orientation;
    this.overlay.unit = grid.unit || "units";
    this.sides.append(...orientation.sides.map((side) => this.sideButton(side)));
    const context = contextOf(this.canvas);
    if (!context) {
      this.scene = null;
      this.canvas.replaceWith(
        element(
          "p",
          {class: "missing", role: "alert"},
          "The mesh cannot be drawn: this browser has no WebGL 2, or it is disabled. " +
            "The slices show the isoline, and the mesh can be saved.",
        ),
      );
      this.overlay.svg.remove();
      return;
    }
    this.scene = new Scene(this.canvas, context, () => this.drawOverlay());
    this.inspector = new Inspector(
      this.scene,
      this.overlay,
      this.components,
      () => ({
        mesh: this.mesh!,
        shape: this.shape!,
        unit: this.lengthUnit,
        errorUnit: this.lengthUnit,
        space: grid.anatomical ? "LPS" : "",
        facing: this.scene!.facing,
      }),
      () => this.drawOverlay(),
    );
    picture.append(this.inspector.card);
    this.listen();
  }

  private listen(): void {
    const {scene, inspector, canvas} = this;
    if (!scene || !inspector) return;
    listen(canvas, scene.camera, {
      clicked: (at) => this.shape && inspector.clicked(at),
      pointedAt: (at) => this.shape && inspector.pointedAt(at),
    });
    canvas.addEventListener("dblclick", () => this.fit());
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const action = keyAction(event, scene.camera, {
        reset: () => this.fit(),
        lookFromSide: (side) => (this.sides.children[side] as HTMLElement).click(),
        clickCentre: () =>
          this.shape && inspector.clicked({x: canvas.clientWidth / 2, y: canvas.clientHeight / 2}),
        toggleMeasuring: () => this.shape && inspector.setMeasuring(!inspector.isMeasuring),
        end: () => {
          inspector.reset();
          this.components.select(null);
        },
        hideSelected: () => inspector.hideSelected(),
        isolateSelected: () => inspector.isolateSelected(),
        showAll: () => this.components.set([]),
      });
      if (!action) return;
      event.preventDefault();
      action();
    });
    for (const event of ["focus", "blur", "keydown", "pointerdown"])
      canvas.addEventListener(event, () => this.drawOverlay());
    canvas.addEventListener("webglcontextlost", () =>
      inspector.setStatus(
        "The browser has lost access to the graphics card. " +
          "Wait until it is restored, or reload the page.",
      ),
    );
  }

  /** Turns measuring on and off. */
  get measure(): HTMLElement | null {
    return this.inspector?.measure ?? null;
  }

  get measured(): unknown {
    return this.inspector?.measured;
  }

  get mesh(): Mesh | null {
    return this.shown?.made.mesh ?? null;
  }

  /** The shown mesh, and the properties of its triangles; null: none yet. */
  get current(): {shown: Shown; shape: LevelShape} | null {
    return this.shown && this.shape ? {shown: this.shown, shape: this.shape} : null;
  }

  private get lengthUnit(): string {
    return this.grid.unit || "units";
  }

  private sideButton({name, end, from, up}: ViewedSide): HTMLElement {
    const text = element("span", {}, `${name} `, element("span", {class: "end"}, end));
    return button(`view-${name.toLowerCase()}`, text, () =>
      this.scene?.camera.lookFrom(new Vector3(...from), new Vector3(...up)),
    );
  }

  fit(): void {
    this.scene?.camera.goHome();
  }

  setStyle(style: Style, colouring: Colouring): void {
    [this.style, this.colouring] = [style, colouring];
    this.overlay.split = style === "split";
    if (this.mesh) this.scene?.update(0, style, colouring, this.lengthUnit);
  }

  /** Shows a mesh. The camera moves only for the first one. */
  show(shown: Shown): void {
    const isFirst = !this.shown;
    this.shown = shown;
    this.shape = new LevelShape(shown.made.mesh.levels[0]);
    this.components.hidden.clear();
    this.components.selected = null;
    this.inspector?.reset();
    this.scene?.show(shown.made.mesh, [this.shape], !isFirst);
    for (const component of this.hiddenNumbers()) this.components.hidden.add(component);
    // A preview can lack components that the mesh of the whole volume has.
    if (shown.final) {
      this.unmatched = [];
      this.remembered = this.rememberHidden();
    }
    this.scene?.showComponents(this.components.isShown);
    this.scene?.update(0, this.style, this.colouring, this.lengthUnit);
    this.updateOutlines();
    const {vertices, triangles, facts} = shown.made.header;
    this.canvas.setAttribute(
      "aria-label",
      `Mesh: ${plural(vertices, "vertex", "vertices")}, ${plural(triangles, "triangle")}, ` +
        plural(facts.components, "component"),
    );
    // The list takes longer than the picture. Until then, it is of the last mesh.
    this.listed.setAttribute("aria-busy", "true");
    clearTimeout(this.listing);
    this.listing = window.setTimeout(() => this.updateList(), LIST_AFTER);
  }

  private updateList(): void {
    if (!this.shape) return;
    const focused = this.listed.querySelector<HTMLElement>(":focus");
    this.listed.replaceChildren(
      this.list.open(this.shape, this.lengthUnit, this.scene?.facing ?? 1, this.host.notes()),
    );
    // Its part of the list is new, or was moved to the new list.
    if (focused) {
      const same = focused.isConnected ? focused : document.getElementById(focused.id);
      same?.focus({preventScroll: true});
    }
    this.listed.setAttribute("aria-busy", "false");
  }

  private componentsChanged(hidden: boolean): void {
    if (hidden) {
      const before = this.remembered;
      this.remembered = this.rememberHidden();
      if (before?.hides === this.remembered?.hides)
        this.remembered?.points.push(...this.unmatched);
    }
    this.scene?.showComponents(this.components.isShown);
    this.list.refresh();
    this.inspector?.refresh();
    this.host.chosen();
  }

  /** Vertices of the hidden components, or of the shown ones if these are fewer. */
  private rememberHidden(): Remembered | null {
    const {shape, components, mesh} = this;
    if (!shape || !mesh || components.hidden.size === 0) return null;
    const all = shape.components().list.length;
    const hides = 2 * components.hidden.size <= all;
    const {of} = shape.components();
    const {positions, triangles} = shape.level;
    const points = new Map<number, Triple>();
    for (const v of triangles) {
      const component = of[v];
      if (points.has(component) || components.isShown(component) === hides) continue;
      points.set(component, toFile(new Vector3().fromArray(positions, 3 * v), mesh.centre));
      if (points.size > MOST_REMEMBERED) return null;
    }
    return {points: [...points.values()], hides};
  }

  /** The components to hide in the shown mesh. */
  private hiddenNumbers(): number[] {
    const {shape, mesh, remembered} = this;
    this.unmatched = [];
    if (!remembered || !shape || !mesh) return [];
    const {list} = shape.components();
    const edge = longestEdge(shape.level);
    // Large triangles are farther from the isosurface.
    const near = Math.max(4 * Math.max(...this.grid.spacing), edge / 4);
    const found = new Set<number>();
    for (const point of remembered.points) {
      const at = point.map((v, axis) => v - mesh.centre[axis]) as Triple;
      const triangle = nearestTriangle(shape.level, edge, at, near);
      if (triangle !== null) found.add(shape.componentOf(triangle));
      else this.unmatched.push(point);
    }
    if (found.size === 0) return [];
    const isHidden = (component: number): boolean => found.has(component) === remembered.hides;
    return list.map((_, component) => component).filter(isHidden);
  }

  /** Shows what is shown, or why it is not, and the progress. */
  update(): void {
    const {follower} = this;
    const running = follower.isRunning;
    const line = this.lineText();
    if (this.line.textContent !== line) this.line.textContent = line;
    this.line.classList.toggle("bad", follower.problem !== "");
    if (!running && document.activeElement === this.stop) this.host.focusHandle();
    this.stop.hidden = !running;
    this.bar.hidden = !running;
    // Not in the line, which screen readers read when it changes.
    this.done.textContent =
      running && follower.fraction !== null ? ` ${Math.floor(100 * follower.fraction)} %` : "";
    if (follower.fraction === null) this.bar.removeAttribute("value");
    else this.bar.value = follower.fraction;
    this.bar.setAttribute("aria-label", "Progress of the mesh");
  }

  private lineText(): string {
    const {follower, shown} = this;
    if (follower.problem)
      return `${sentence(follower.problem)}${shown ? " The last mesh is still shown." : ""}`;
    if (follower.isRunning && !(shown && !shown.final && this.isOfRunning))
      return progressText("The mesh is being made", follower.stage);
    if (!shown) return follower.wasCancelled ? "Cancelled. There is no mesh yet." : "";
    const {header} = shown.made;
    if (shown.final) {
      return follower.wasCancelled
        ? "Cancelled. The previous mesh is still shown."
        : `Coarse mesh: ${meshText(shown)}.`;
    }
    const n = header.reduction;
    const preview = `Preview: every ${n} × ${n} × ${n} samples as one`;
    if (!follower.isRunning) return `${preview}. The mesh of the whole volume was cancelled.`;
    return `${preview}; the mesh of the whole volume is being made …`;
  }

  /** Whether the shown mesh is of the request that is running. */
  private get isOfRunning(): boolean {
    return this.follower.runningRequest === this.shown?.request;
  }

  /** Draws the positions of the slices and the region. */
  updateOutlines(): void {
    const {mesh, grid, region, scene} = this;
    if (!mesh || !scene) return;
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string): string => style.getPropertyValue(name).trim();
    const toScene = (sample: Triple): Vector3 =>
      new Vector3(...grid.world(sample)).sub(new Vector3(...mesh.centre));
    const rectangle = (axis: number, index: number): Vector3[] => {
      const [u, v] = [0, 1, 2].filter((other) => other !== axis);
      return [[0, 0], [1, 0], [1, 1], [0, 1]].map(([a, b]) => {
        const sample: Triple = [index, index, index];
        sample[u] = region.ends[u][a];
        sample[v] = region.ends[v][b];
        return toScene(sample);
      });
    };
    const outlines: Outline[] = [];
    if (this.showsSlices) {
      this.position().forEach((index, axis) =>
        outlines.push({points: rectangle(axis, index), colour: colour("--edge-of-field")}),
      );
    }
    if (!region.isWhole) {
      for (const axis of [0, 2])
        for (const index of region.ends[axis])
          outlines.push({points: rectangle(axis, index), colour: colour("--warn")});
    }
    scene.setOutlines(outlines);
  }

  private drawOverlay(): void {
    if (!this.scene) return;
    this.overlay.crosshair = this.canvas.matches(":focus-visible");
    this.overlay.update(this.scene.camera, this.canvas.clientWidth, this.canvas.clientHeight);
  }
}

/** The first letter large, with a full stop. */
export function sentence(text: string): string {
  const trimmed = text.trim().replace(/\.$/, "");
  return `${trimmed.charAt(0).toUpperCase()}${trimmed.slice(1)}.`;
}

function meshText({made: {header}}: Shown): string {
  const {facts, triangles, seconds, kept, dropped} = header;
  const {certificate: c, genus} = facts;
  const parts = [
    plural(triangles, "triangle"),
    plural(facts.components, "component") + (dropped > 0 ? ` of ${count(kept + dropped)}` : ""),
    ...(genus == null ? [] : [`genus ${count(genus)}`]),
    ...(c ? [c.passed ? "certified" : "not certified"] : []),
    `${number(seconds, 2)} s`,
  ];
  return parts.join(", ");
}
