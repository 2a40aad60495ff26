// SPDX-License-Identifier: Apache-2.0
// The page of `isoatlas view`: slices, mesh, isovalue, and what is saved.
import {Vector3} from "three";

import type {Triple} from "../data";
import {count, element, number, readOnly} from "../dom";
import {toFile} from "../scene";
import {section} from "../tables";
import {Theme} from "../theme";
import {ComponentFilter, type Selection} from "./component_filter";
import {Display} from "./display";
import {Grid} from "./grid";
import {defaultRange, palette, type GreyRange, type Rgb} from "./grey";
import {IsovalueControl, type Change} from "./isovalue_control";
import {MeshFollower} from "./mesh_follower";
import {MeshOptions} from "./mesh_options";
import {MeshView} from "./mesh_view";
import {Region, type Ends} from "./region";
import {RegionFields} from "./region_fields";
import {Saving} from "./saving";
import {Refused, Server, type Message, type Option, type Volume} from "./server";
import {SliceStore} from "./slice_store";
import {SliceView, type Shared} from "./slice_view";

const TYPING_PAUSE = 350;  // ms
const TINT: Rgb = [79, 180, 255];

const HELP: [string, string][] = [
  ["Isovalue", "drag the handle, or arrow keys on it; Page keys for large steps; or type"],
  ["Other slice", "its slider, arrow and Page keys in the slice, or Shift and wheel"],
  ["Go to a point", "click it in a slice"],
  ["Zoom a slice", "wheel, pinch, + and −; double click or 0 resets"],
  ["Pan a slice", "drag, or Shift and arrows"],
  ["Window and level", "drag with the right button: right for contrast, down for darker"],
  ["Rotate the mesh", "drag, or arrow keys"],
  ["Pan, zoom the mesh", "right button or two fingers, wheel or pinch; 0 fits"],
  ["View from a side", "1 to 6"],
  ["Component", "click it; h hides it, i the others, a shows all"],
  ["Measure", "m, then click two points of the mesh"],
];

export class ViewPage {
  private readonly grid: Grid;
  private readonly follower: MeshFollower;
  private readonly isovalue: IsovalueControl;
  private readonly region: Region;
  private readonly regionFields: RegionFields;
  private readonly meshOptions: MeshOptions;
  private readonly filter: ComponentFilter;
  private readonly saving: Saving;
  private readonly display: Display;
  private readonly shared: Shared;
  private readonly slices: SliceView[];
  private readonly meshView: MeshView;
  private readonly theme = new Theme((colours) => {
    this.meshView.scene?.theme(colours);
    this.meshView.updateOutlines();
  });
  private readonly views = element("div", {class: "views"});
  private readonly ended = element("p", {class: "ended", role: "alert", id: "ended"});
  private readonly cross = element("output", {id: "cross-value"});
  private hasEnded = false;
  private typing = 0;

  constructor(
    private readonly server: Server,
    private readonly volume: Volume,
  ) {
    this.grid = new Grid(volume);
    this.region = new Region(volume.size);
    volume.roi?.forEach((ends, axis) => this.region.set(axis, ends as Ends));
    this.isovalue = new IsovalueControl(volume, (how) => this.isovalueChanged(how));
    this.follower = new MeshFollower(
      server,
      (shown) => {
        this.meshView.show(shown);
        this.filter.show(shown.made.header);
      },
      () => this.meshChanged(),
    );
    this.meshOptions = new MeshOptions(
      volume.unit,
      Math.max(...volume.size),
      volume.defaults,
      (mesh) => (mesh ? this.optionsChanged(true) : this.saving.updateCommand()),
    );
    this.filter = new ComponentFilter(
      volume.unit,
      Math.min(...volume.spacing),
      () => this.selection(),
      (options) => (options ? this.optionsChanged(true) : this.saving.updateCommand()),
    );
    this.saving = new Saving(
      server,
      volume.formats,
      () => [...this.options(), ...this.meshOptions.saved()],
      () => this.toCorrect(),
    );
    this.regionFields = new RegionFields(
      this.region,
      volume.size,
      (extent) => (extent ? this.regionChanged(true) : this.saving.updateCommand()),
      () => {
        this.shared.isRegionEdited = this.regionFields.edited;
        this.updateSlices();
      },
    );
    this.display = new Display({
      rangeTyped: (range) => this.setRange(range),
      rangeReset: () => this.setRange(defaultRange(volume.histogram)),
      slicesChanged: () => this.displayChanged(),
      meshChanged: () => this.meshStyleChanged(),
    });
    this.shared = this.makeShared();
    this.slices = [0, 1, 2].map((axis) => new SliceView(axis, this.shared));
    this.meshView = this.makeMeshView();
  }

  private makeShared(): Shared {
    const {volume, grid, region} = this;
    const store = new SliceStore(
      this.server,
      volume.size,
      (slice) => {
        this.slices[slice.axis].arrived(slice);
        this.showCross();
      },
      (reason) => reason instanceof Refused || console.error(reason),
    );
    return {
      grid,
      store,
      position: volume.size.map((n) => Math.floor(n / 2)) as Triple,
      range: defaultRange(volume.histogram),
      colours: palette(TINT),
      rule: this.isovalue.rule,
      showsIsoline: true,
      showsCross: true,
      region,
      isRegionEdited: false,
      goTo: (position) => this.goTo(position),
      setRange: (range) => this.setRange(range),
      regionDragged: (settled) => {
        this.regionFields.show();
        this.regionChanged(settled);
      },
      enlarge: (id) => this.enlarge(id),
    };
  }

  private makeMeshView(): MeshView {
    return new MeshView(
      this.grid,
      this.follower,
      () => this.shared.position,
      this.region,
      {
        notes: () => [this.filter.notes],
        chosen: () => this.updateChoice(),
        focusHandle: () => this.isovalue.focus(),
      },
      (id) => this.enlarge(id),
    );
  }

  start(): void {
    this.build();
    this.theme.start();
    this.display.showRange(this.shared.range);
    this.goTo(this.shared.position);
    this.meshChanged();
    this.updateChoice();
    this.server.listen(() => {
      // Messages may have been lost before.
      this.follower.restart(this.shownOptions());
      document.documentElement.dataset.ready = "";
      this.saving.updateCommand();
    });
  }

  private build(): void {
    const {volume, slices, meshView} = this;
    document.title = `${volume.title} – isoatlas view`;
    this.ended.hidden = true;
    const [axial, coronal, sagittal] = [slices[2], slices[1], slices[0]].map(({field}) => field);
    this.views.append(axial, meshView.field, coronal, sagittal);
    const stage = element(
      "section",
      {class: "stage view-stage", "aria-label": "Volume"},
      element(
        "header",
        {},
        element(
          "div",
          {class: "titles"},
          element("h1", {}, volume.title),
          element("p", {class: "soft"}, this.summary()),
        ),
        this.theme.button,
      ),
      this.ended,
      this.views,
      this.isovalue.strip,
    );
    document.body.append(element("main", {}, stage, this.panel()));
  }

  private panel(): HTMLElement {
    const {volume, meshView} = this;
    const controls = (...children: HTMLElement[]): HTMLElement =>
      element("div", {class: "controls"}, ...children);
    const group = (legend: string, ...children: HTMLElement[]): HTMLElement =>
      element("fieldset", {}, element("legend", {}, legend), ...children);
    const needy = (part: HTMLElement): HTMLElement => {
      part.dataset.needsServer = "";
      return part;
    };
    const warnings = volume.warnings.map((text) => element("li", {}, text));
    return element(
      "div",
      {class: "panel"},
      ...(warnings.length > 0
        ? [section("Warnings", element("ul", {class: "plain", id: "warnings"}, ...warnings))]
        : []),
      section("Isovalue", this.isovalue.settings),
      element(
        "div",
        {class: "components-panel"},
        meshView.listed,
        element(
          "section",
          {"aria-label": "Choice of components", "data-needs-server": ""},
          controls(element("div", {class: "buttons"}, this.filter.onlyShown), this.filter.fields),
        ),
      ),
      needy(section("Region of interest", this.regionFields.section)),
      needy(section("Save", controls(...this.meshOptions.fields, ...this.saving.fields))),
      section("The same on the command line", ...this.saving.commandLine),
      section(
        "Display",
        controls(
          element(
            "p",
            {},
            element("span", {class: "soft"}, "At the cross lines: "),
            this.cross,
          ),
          ...this.display.ofSlices,
          ...this.display.ofMesh,
          group("View the mesh from", meshView.sides),
          ...(meshView.measure
            ? [element("div", {class: "buttons"}, meshView.measure)]
            : []),
          this.help(),
        ),
      ),
      element("footer", {class: "soft"}, `isoatlas ${volume.version}`),
    );
  }

  private help(): HTMLElement {
    const words = HELP.flatMap(([what, how]) => [element("dt", {}, what), element("dd", {}, how)]);
    return element(
      "details",
      {class: "help"},
      element("summary", {}, "Mouse, touch, keyboard"),
      element("dl", {id: "help"}, ...words),
    );
  }

  private summary(): string {
    const {size, sample_type: type, spacing, minimum, maximum, not_finite: strange} = this.volume;
    const parts = [
      `${size.join(" × ")} ${type}`,
      `spacing ${spacing.map((s) => number(s, 4)).join(" × ")}${this.grid.unitText}`,
      `values ${number(minimum, 6)} to ${number(maximum, 6)}`,
    ];
    if (strange > 0) parts.push(`${count(strange)} NaN or infinite`);
    return parts.join(" · ").replaceAll("-", "−");
  }

  /** Options of the shown mesh. */
  private shownOptions(): Option[] {
    return [...this.options(), ...this.meshOptions.shown()];
  }

  /** Options of the shown and of the saved mesh. */
  private options(): Option[] {
    const out: Option[] = [["iso", `${this.isovalue.value}`]];
    if (this.isovalue.inside === "below") out.push(["inside", "below"]);
    if (this.isovalue.nan) out.push(["nan", this.isovalue.nan]);
    if (!this.region.isWhole) out.push(["roi", this.region.text]);
    out.push(...this.filter.options(), ...this.meshOptions.shared());
    return out;
  }

  /** What has fields that cannot be used, for the user; "" if all fields can be used. */
  private toCorrect(): string {
    const parts: [string, {isValid: boolean}][] = [
      ["the isovalue", this.isovalue],
      ["the choice of components", this.filter],
      ["the region of interest", this.regionFields],
      ["the bounds of the mesh", this.meshOptions],
    ];
    const invalid = parts.filter(([, part]) => !part.isValid).map(([name]) => name);
    return new Intl.ListFormat("en").format(invalid);
  }

  private isovalueChanged(how: Change): void {
    this.saving.updateCommand();
    if (how === "refused") return;
    this.shared.rule = this.isovalue.rule;
    this.updateSlices();
    // The first digits of a number are another isovalue, whose mesh is not needed.
    clearTimeout(this.typing);
    if (how === "typed")
      this.typing = window.setTimeout(() => this.optionsChanged(false), TYPING_PAUSE);
    else this.optionsChanged(how === "settled");
  }

  private regionChanged(settled: boolean): void {
    this.updateSlices();
    this.meshView.updateOutlines();
    this.optionsChanged(settled);
  }

  private optionsChanged(settled: boolean): void {
    this.follower.follow(this.shownOptions(), settled);
    this.saving.updateCommand();
  }

  private meshChanged(): void {
    this.meshView.update();
    this.updateChoice();
  }

  private updateChoice(): void {
    const {hidden} = this.meshView.components;
    const all = this.meshView.current?.shown.made.header.facts.components ?? 0;
    this.filter.onlyShown.disabled =
      this.hasEnded || hidden.size === 0 || hidden.size >= all || !this.follower.isUpToDate;
  }

  private selection(): Selection | null {
    const {current} = this.meshView;
    if (!current || !this.follower.isUpToDate) return null;
    return {
      shape: current.shape,
      centre: current.shown.made.mesh.centre,
      unit: this.volume.unit,
      isShown: this.meshView.components.isShown,
    };
  }

  private goTo(position: Triple): void {
    this.shared.position = position;
    this.updateSlices();
    this.meshView.updateOutlines();
    this.showCross();
  }

  private showCross(): void {
    const {position, store} = this.shared;
    const slice = store.get(2, position[2]);
    const at = `(${position.join(", ")})`;
    if (!slice) {
      this.cross.value = `sample ${at}`;
      return;
    }
    const value = slice.samples[position[0] + this.volume.size[0] * position[1]];
    const world = this.grid.world(position).map((v) => number(v, 5)).join(", ");
    this.cross.value =
      `sample ${at}, value ${Number.isFinite(value) ? number(value, 6) : value}, ` +
      `(${world})${this.grid.unitText}`;
  }

  private updateSlices(): void {
    for (const slice of this.slices) slice.update();
  }

  private setRange(range: GreyRange): void {
    if (!(range.high > range.low) || !Number.isFinite(range.high - range.low)) return;
    this.shared.range = range;
    this.display.showRange(range);
    this.updateSlices();
  }

  private displayChanged(): void {
    this.shared.colours = palette(this.display.tint.input.checked ? TINT : null);
    this.shared.showsIsoline = this.display.isoline.input.checked;
    this.shared.showsCross = this.display.cross.input.checked;
    this.updateSlices();
  }

  private meshStyleChanged(): void {
    this.meshView.setStyle(this.display.style.value(), this.display.colouring.value());
    this.meshView.showsSlices = this.display.outlines.input.checked;
    this.meshView.updateOutlines();
  }

  private enlarge(id: string): void {
    const large = this.views.dataset.large === id ? "" : id;
    this.views.dataset.large = large;
    for (const view of this.views.children) {
      const isLarge = (view as HTMLElement).dataset.view === large;
      view.classList.toggle("large", isLarge);
      view
        .querySelector(".view-head [aria-pressed]")
        ?.setAttribute("aria-pressed", `${isLarge}`);
    }
  }

  heard(message: Message): void {
    this.follower.heard(message);
    this.saving.heard(message);
  }

  /**
   * No messages arrive any more: slices that are here, and the mesh, can still be viewed.
   * @param why in sentences
   */
  end(why: string): void {
    this.hasEnded = true;
    this.follower.stop();
    this.saving.stopAll(why);
    this.ended.textContent =
      `${why} The last mesh and the slices that were shown stay here; nothing new can be made or ` +
      "saved.";
    this.ended.hidden = false;
    const needy = document.querySelectorAll<HTMLInputElement>(
      "[data-needs-server] :is(input, select, button)",
    );
    for (const control of needy) control.disabled = true;
    document.documentElement.dataset.ended = "";
  }

  /** The shown state, read-only, for scripts and tests. */
  readonly api = readOnly({
    isovalue: () => this.isovalue.value,
    inside: () => this.isovalue.inside,
    /** Options of the shown mesh, or of the one that is being made. */
    options: () => this.shownOptions(),
    position: () => this.shared.position,
    range: () => this.shared.range,
    region: () => this.region.ends,
    /** Whether the mesh is the final one of the options. */
    upToDate: () => this.follower.isUpToDate,
    running: () => this.follower.isRunning,
    problem: () => this.follower.problem,
    mesh: () => {
      const shown = this.follower.current;
      if (!shown) return null;
      const {header} = shown.made;
      const {vertices, triangles, reduction, kept, dropped, seconds} = header;
      return {request: shown.request, final: shown.final, options: shown.options, vertices,
        triangles, reduction, kept, dropped, seconds, components: header.facts.components};
    },
    /** The positions of the vertices in the coordinates of the file, 3 each. */
    positions: () => {
      const mesh = this.meshView.mesh;
      return mesh && Array.from(mesh.levels[0].positions, (v, i) => v + mesh.centre[i % 3]);
    },
    /** Per request, times in ms until the first and the final mesh were shown. */
    timings: () => this.follower.timings,
    components: () => this.meshView.current?.shape.components().list,
    measures: () => this.meshView.current?.shape.measures(),
    hidden: () => [...this.meshView.components.hidden],
    /** The command line of the options; null while it is requested. */
    command: () => this.saving.commandText,
    saving: () => this.saving.isRunning,
    moving: () => this.meshView.scene?.camera.moving ?? false,
    frames: () => this.meshView.scene?.frames ?? 0,
    sliceFrames: () => this.slices.map(({frames}) => frames),
    centre: () => this.meshView.mesh?.centre,
    /** The pixel of a point of the mesh's file in the mesh view. */
    project: () => (point: Triple) =>
      this.meshView.scene?.camera.project(
        new Vector3(...point).sub(new Vector3(...this.meshView.mesh!.centre)),
      ),
    /** What is at a pixel of the mesh view. */
    pick: () => (x: number, y: number) => {
      const picked = this.meshView.scene?.pick(x, y);
      return picked
        ? {
            point: toFile(picked.point, this.meshView.mesh!.centre),
            component: picked.component,
          }
        : null;
    },
    measured: () => this.meshView.measured,
    /** The pixel of a sample in the view of slices across an axis. */
    pixelOf: () => (axis: number, sample: Triple) => this.slices[axis].pixelOf(sample),
    /** The mesh view as a data URL. */
    picture: () => () => {
      this.meshView.scene?.render();
      return this.meshView.canvas.toDataURL();
    },
    /** A slice view as a data URL. */
    slicePicture: () => (axis: number) => {
      this.slices[axis].render();
      return this.slices[axis].canvas.toDataURL();
    },
  });
}
