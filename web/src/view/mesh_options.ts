// SPDX-License-Identifier: Apache-2.0
// How the mesh is made: detail, bounds, levels, topology, caps. Each field is an option of
// `isoatlas extract`; an empty one is not in the command line.
import {choice, problemLine} from "../controls";
import {element} from "../dom";
import type {Option} from "./server";

interface Field {
  name: string;
  text: string;
  /** Units with what is appended to the number; the first one is the default. */
  units: {value: string; text: string}[];
  placeholder: string;
  /** Why a number cannot be; "" if it can. */
  problem: (value: number) => string;
}

/** The largest radius of the disks of the shown mesh: a share of the longest side, in voxels. */
const RADII_PER_SIDE = 64;
const LEAST_RADIUS = 3;

type Detail = "refined" | "coarse";
type Caps = "open" | "closed";
type Topology = "trilinear" | "faces";

const positive = (value: number): string => (value > 0 ? "" : "a number above 0");
const ratio = (value: number): string => (value > 1 ? "" : "a ratio above 1, like 1.5");
const vertices = (value: number): string =>
  Number.isInteger(value) && value >= 4 ? "" : "a whole number, 4 or more";

const FURTHER: Omit<Field, "units">[] = [
  {name: "mean-distance", text: "Mean distance, at most", placeholder: "", problem: positive},
  {name: "normal-angle", text: "Change of the normal, at most (degrees)", placeholder: "",
    problem: positive},
  {name: "area-curvature", text: "Area to projected area, at most", placeholder: "",
    problem: ratio},
  {name: "geodesic-ratio", text: "Geodesic to straight distance, at most", placeholder: "",
    problem: ratio},
  {name: "min-aspect", text: "Aspect ratio, at least (0 to 1)", placeholder: "",
    problem: (v) => (v > 0 && v < 1 ? "" : "a ratio between 0 and 1, like 0.333")},
  {name: "min-edge", text: "Edge length, at least", placeholder: "", problem: positive},
  {name: "max-edge", text: "Edge length, at most", placeholder: "", problem: positive},
  {name: "min-vertices", text: "Vertices, at least", placeholder: "", problem: vertices},
  {name: "max-vertices", text: "Vertices, at most", placeholder: "", problem: vertices},
];
const LENGTHS = ["mean-distance", "min-edge", "max-edge"];

class NumberField {
  readonly label: HTMLElement;
  readonly input: HTMLInputElement;
  readonly unit: HTMLSelectElement | null;
  readonly cell: HTMLElement;
  private last: Option[] = [];

  constructor(
    readonly of: Field,
    changed: () => void,
  ) {
    const {name, text, units, placeholder} = of;
    this.input = element("input", {
      id: name,
      type: "text",
      inputmode: "decimal",
      autocomplete: "off",
      placeholder,
    });
    this.label = element("label", {for: name}, text);
    this.unit =
      units.length > 0
        ? element(
            "select",
            {id: `${name}-unit`, "aria-label": `Unit of: ${text}`},
            ...units.map(({value, text}) => element("option", {value}, text)),
          )
        : null;
    this.cell = this.unit
      ? element("span", {class: "joined"}, this.input, this.unit)
      : this.input;
    this.input.addEventListener("input", changed);
    this.unit?.addEventListener("change", changed);
  }

  private get typed(): string {
    return this.input.value.trim();
  }

  /** "" if there is no problem. */
  problem(): string {
    const {typed} = this;
    const isNumber = /^(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(typed);
    const expected = typed === "" ? "" : isNumber ? this.of.problem(Number(typed)) : "a number";
    this.input.setAttribute("aria-invalid", `${expected !== ""}`);
    return expected && `${this.of.text}: expected ${expected}, got “${typed}”.`;
  }

  /** None if the field is empty; the last valid one if the field is invalid. */
  option(): Option[] {
    const {typed} = this;
    if (!this.problem())
      this.last = typed ? [[this.of.name, `${typed}${this.unit?.value ?? ""}`]] : [];
    return this.last;
  }
}

export class MeshOptions {
  private readonly detail = choice<Detail>(
    "detail",
    "Detail",
    [
      {value: "refined", text: "Refined"},
      {value: "coarse", text: "Coarse, as shown"},
    ],
    () => this.detailChanged(),
  );
  private readonly caps = choice<Caps>(
    "border",
    "Where the volume ends",
    [
      {value: "open", text: "Open"},
      {value: "closed", text: "Closed by caps"},
    ],
    () => this.changed(true),
  );
  private readonly topology = choice<Topology>(
    "topology",
    "Inside a grid cell",
    [
      {value: "trilinear", text: "Trilinear"},
      {value: "faces", text: "By faces"},
    ],
    () => this.changed(true),
  );
  private readonly radius: NumberField;
  private readonly distance: NumberField;
  private readonly levels: NumberField;
  private readonly further: NumberField[];
  private readonly problem = problemLine("bound-problem");
  private readonly refinedOnly: HTMLElement;
  readonly fields: HTMLElement[];

  /**
   * @param unit of lengths; "" if the volume states none
   * @param side number of samples along the longest side of the volume
   * @param defaults values of options that are not given
   * @param changed gets whether the shown mesh depends on it, too
   */
  constructor(
    unit: string,
    side: number,
    defaults: Record<string, string>,
    private readonly changed: (mesh: boolean) => void,
  ) {
    const lengths = [
      {value: "vx", text: "voxels"},
      ...(unit ? [{value: "", text: unit}] : [{value: "", text: "units"}]),
    ];
    const bound = (of: Field): NumberField => new NumberField(of, () => this.boundChanged());
    this.radius = new NumberField(
      {
        name: "max-radius",
        text: "Size of the shown triangles, at most",
        units: lengths,
        placeholder: `${Math.max(LEAST_RADIUS, Math.round(side / RADII_PER_SIDE))}`,
        problem: positive,
      },
      () => {
        this.boundChanged();
        if (!this.radius.problem()) this.changed(true);
      },
    );
    this.distance = bound({
      name: "max-distance",
      text: "Distance, at most",
      units: lengths,
      placeholder: (defaults["max-distance"] ?? "0.5vx").replace(/vx$/, ""),
      problem: positive,
    });
    this.levels = bound({
      name: "levels",
      text: "Levels of detail",
      units: [],
      placeholder: "1",
      problem: (v) =>
        Number.isInteger(v) && v >= 1 && v <= 16 ? "" : "a whole number from 1 to 16",
    });
    this.further = FURTHER.map((of) =>
      bound({...of, units: LENGTHS.includes(of.name) ? lengths : []}),
    );
    const pairs = (fields: NumberField[]): HTMLElement =>
      element("div", {class: "pairs"}, ...fields.flatMap(({label, cell}) => [label, cell]));
    this.refinedOnly = element(
      "div",
      {class: "controls"},
      pairs([this.distance, this.levels]),
      element(
        "details",
        {id: "further-bounds"},
        element("summary", {}, "Further bounds"),
        pairs(this.further),
      ),
    );
    this.fields = [
      this.detail.field,
      this.refinedOnly,
      pairs([this.radius]),
      this.problem,
      this.caps.field,
      this.topology.field,
    ];
  }

  /** Options that the shown mesh depends on, too. */
  shared(): Option[] {
    const out: Option[] = [];
    if (this.topology.value() !== "trilinear") out.push(["topology", this.topology.value()]);
    if (this.caps.value() !== "open") out.push(["border", this.caps.value()]);
    return out;
  }

  /**
   * Options of the shown mesh only. Without a largest radius, a head would be a few triangles: the
   * coarsest mesh with its topology.
   */
  shown(): Option[] {
    const typed = this.radius.option();
    return typed.length > 0 ? typed : [["max-radius", `${this.radius.of.placeholder}vx`]];
  }

  /** Options of the saved mesh only. */
  saved(): Option[] {
    if (this.detail.value() === "coarse") return [["coarse", ""], ...this.shown()];
    return [this.distance, this.levels, ...this.further].flatMap((field) => field.option());
  }

  /** Whether all fields can be used. */
  get isValid(): boolean {
    return this.problem.textContent === "";
  }

  private detailChanged(): void {
    this.refinedOnly.hidden = this.detail.value() === "coarse";
    this.boundChanged();
  }

  private boundChanged(): void {
    const fields = this.refinedOnly.hidden ? [] : [this.distance, this.levels, ...this.further];
    this.problem.textContent = [...fields, this.radius]
      .map((field) => field.problem())
      .filter(Boolean)
      .join(" ");
    this.changed(false);
  }
}
