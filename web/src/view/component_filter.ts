// SPDX-License-Identifier: Apache-2.0
// Which components of the isosurface are kept: the largest ones, those that are large enough, those
// near some points. Points are used, because the numbers of components change with the isovalue.
import {Vector3} from "three";

import {button, problemLine} from "../controls";
import type {Triple} from "../data";
import {count, element, number, plural, type Child} from "../dom";
import type {LevelShape} from "../level_shape";
import {toFile} from "../scene";
import type {MeshHeader, Option} from "./server";

/** A component that the user keeps or drops, at one of its vertices. */
interface Point {
  at: Triple;
  /** What it was when it was chosen, for the user. */
  text: string;
}

const LISTED = 8;

/** What the user wants of a mesh that is shown. */
export interface Selection {
  shape: LevelShape;
  centre: Triple;
  unit: string;
  isShown: (component: number) => boolean;
}

export class ComponentFilter {
  private keep: Point[] = [];
  private drop: Point[] = [];
  /** Options of the fields when all of them were valid the last time. */
  private typed: Option[] = [];
  private readonly largest = field("keep-largest", "Keep the N largest", "all");
  private readonly smallest = field("drop-smaller", "Drop smaller than", "none");
  private readonly sizeUnit: HTMLSelectElement;
  private readonly problem = problemLine("keep-problem");
  readonly onlyShown = button("keep-shown", "Keep only the shown ones", () => this.keepShown(), {
    title: "In the mesh that is saved, too",
  });
  readonly fields: HTMLElement;
  /** What the mesh does not contain. */
  readonly notes = element("div", {id: "left-out"});

  /**
   * @param unit of lengths; "" if the volume states none
   * @param spacing the smallest one of the volume
   * @param selection of the mesh that is shown; null: none, or not the final one
   * @param changed gets whether the options have changed; if not, a field became invalid
   */
  constructor(
    private readonly unit: string,
    private readonly spacing: number,
    private readonly selection: () => Selection | null,
    private readonly changed: (options: boolean) => void,
  ) {
    this.sizeUnit = element(
      "select",
      {id: "drop-smaller-unit", "aria-label": "Unit of the size"},
      element("option", {value: "vx"}, "voxels"),
      ...(unit ? [element("option", {value: ""}, `${unit}³`)] : []),
    );
    for (const input of [this.largest.input, this.smallest.input, this.sizeUnit])
      input.addEventListener("change", () => {
        this.readFields();
        this.changed(this.isValid);
      });
    this.fields = element(
      "div",
      {class: "pairs"},
      this.largest.label,
      this.largest.input,
      this.smallest.label,
      element("span", {class: "joined"}, this.smallest.input, this.sizeUnit),
      this.problem,
    );
  }

  /** Whether all fields can be used; if not, the options have their last valid values. */
  get isValid(): boolean {
    return this.problem.textContent === "";
  }

  /** Options of extract. */
  options(): Option[] {
    const out = [...this.typed];
    for (const {at} of this.keep) out.push(["keep-near", this.pointText(at)]);
    for (const {at} of this.drop) out.push(["drop-near", this.pointText(at)]);
    return out;
  }

  /** In hundredths of the smallest spacing: other components are farther away. */
  private pointText(at: Triple): string {
    const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(this.spacing)), 0), 20);
    return at.map((v) => `${Number(v.toFixed(decimals))}`).join(",");
  }

  /** Lists what the mesh does not contain. */
  show(header: MeshHeader): void {
    const focused = this.notes.querySelector(":focus");
    const isByKey = focused?.matches(":focus-visible");
    const buttons = (): Element[] =>
      [...this.notes.querySelectorAll(focused?.id === "take-all" ? "#take-all" : "li button")];
    const at = focused ? buttons().indexOf(focused) : -1;
    this.notes.replaceChildren(...this.leftOut(header));
    if (!focused) return;
    // The focus stays in the list: at the next button, which has the place of one that is gone.
    const next = buttons()[at] ?? buttons().at(-1);
    if (next) (next as HTMLElement).focus({preventScroll: true});
    else if (isByKey) this.largest.input.focus({preventScroll: true});
  }

  private readFields(): void {
    const {largest, smallest} = this;
    const problems = [
      largest.input.value.trim() === "" || isCount(largest.input.value)
        ? ""
        : `Expected a whole number of components, 1 or more, got “${largest.input.value}”.`,
      smallest.input.value.trim() === "" || isSize(smallest.input.value)
        ? ""
        : `Expected a volume above 0 like 10 or 2.5, got “${smallest.input.value}”.`,
    ];
    [largest, smallest].forEach(({input}, i) =>
      input.setAttribute("aria-invalid", `${problems[i] !== ""}`),
    );
    this.problem.textContent = problems.filter(Boolean).join(" ");
    if (this.isValid) this.typed = this.fieldOptions();
  }

  /** Options of valid fields. */
  private fieldOptions(): Option[] {
    const out: Option[] = [];
    const [largest, smallest] = [this.largest, this.smallest].map(({input}) => input.value.trim());
    if (largest) out.push(["keep-components", largest]);
    if (smallest) out.push(["min-component-size", `${smallest}${this.sizeUnit.value}`]);
    return out;
  }

  private keepShown(): void {
    const selection = this.selection();
    if (!selection) return;
    const {shape, isShown} = selection;
    const all = shape.components().list.map((_, i) => i);
    const [kept, hidden] = [all.filter(isShown), all.filter((i) => !isShown(i))];
    if (hidden.length === 0 || kept.length === 0) return;
    const isFiltered = this.options().length > 0;
    if (!isFiltered && areLargest(shape, kept, hidden)) {
      this.clear(`${kept.length}`);
    } else if (kept.length <= hidden.length) {
      // All other conditions hold for these components already.
      this.clear();
      this.keep = kept.map((i) => pointOf(selection, i));
    } else {
      this.drop = [...this.drop, ...hidden.map((i) => pointOf(selection, i))];
    }
    // Before this button is disabled. A touch should not open the keyboard of the screen.
    if (this.onlyShown.matches(":focus-visible")) this.largest.input.focus({preventScroll: true});
    this.changed(true);
  }

  /** Removes all conditions. @param largest how many components to keep instead; "": all */
  private clear(largest = ""): void {
    this.keep = [];
    this.drop = [];
    this.largest.input.value = largest;
    this.smallest.input.value = "";
    this.readFields();
  }

  private leftOut({dropped, dropped_components: listed, kept}: MeshHeader): Child[] {
    const out: Child[] = [];
    if (dropped > 0) {
      const first = listed[0] ? `, the largest of ${this.sizeText(listed[0].size)}` : "";
      out.push(
        element(
          "p",
          {id: "dropped"},
          `Left out: ${plural(dropped, "component")} of ${count(kept + dropped)}${first}.`,
        ),
      );
    }
    if (this.drop.length > 0) out.push(this.droppedPoints());
    else if (this.keep.length > 0 && listed.length > 0) out.push(this.returnable(listed));
    if (this.options().length > 0) {
      const all = button("take-all", "Use all components again", () => {
        this.clear();
        this.changed(true);
      });
      out.push(element("div", {class: "buttons"}, all));
    }
    return out;
  }

  /** Dropped components, each with a button to use it again, which may be pressed twice. */
  private droppedPoints(): HTMLElement {
    const rows = this.drop.slice(0, 50).map((point) =>
      this.row(point.text, () => {
        this.drop = this.drop.filter((other) => other !== point);
        this.changed(true);
      }),
    );
    return element("ul", {class: "returnable"}, ...rows);
  }

  /** The largest components that are not near the kept points. */
  private returnable(listed: MeshHeader["dropped_components"]): HTMLElement {
    const rows = listed.slice(0, LISTED).map(({size, position}) =>
      this.row(`${this.sizeText(size)} at ${place(position)}`, () => {
        if (!this.keep.some(({at}) => at === position)) this.keep.push({at: position, text: ""});
        this.changed(true);
      }),
    );
    return element("ul", {class: "returnable"}, ...rows);
  }

  private sizeText(size: number): string {
    return `volume ${number(size)}${this.unit ? ` ${this.unit}³` : ""}`;
  }

  private row(text: string, back: () => void): HTMLElement {
    const again = element("button", {type: "button", class: "small"}, "Use again");
    again.setAttribute("aria-label", `Use again the component of ${text}`);
    again.addEventListener("click", back);
    return element("li", {}, element("span", {}, text), again);
  }
}

const isCount = (text: string): boolean => /^\s*[1-9]\d*\s*$/.test(text);
const isSize = (text: string): boolean =>
  /^\s*(\d+\.?\d*|\.\d+)(e[+-]?\d+)?\s*$/i.test(text) && Number(text) > 0;

function field(
  id: string,
  text: string,
  placeholder: string,
): {label: HTMLElement; input: HTMLInputElement} {
  const input = element("input", {
    id,
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    placeholder,
  });
  return {label: element("label", {for: id}, text), input};
}

const place = (at: Triple): string => `(${at.map((v) => number(v, 4)).join(", ")})`;

/**
 * Whether the kept components are the largest ones by the volume that they enclose. Similar sizes
 * are not compared, because those of the coarse mesh are not exact; nor are open components, whose
 * size depends on how the volume boundary closes them.
 */
function areLargest(shape: LevelShape, kept: number[], hidden: number[]): boolean {
  const measures = shape.measures();
  if (![...kept, ...hidden].every((i) => shape.encloses(i))) return false;
  const size = (i: number): number => Math.abs(measures[i].volume);
  return Math.min(...kept.map(size)) > 1.1 * Math.max(...hidden.map(size));
}

/** A component at its first vertex, which is on the isosurface. */
function pointOf({shape, centre, unit}: Selection, component: number): Point {
  const {positions, triangles} = shape.level;
  const {of, list} = shape.components();
  const vertex = triangles[triangles.findIndex((v) => of[v] === component)];
  const at = toFile(new Vector3().fromArray(positions, 3 * vertex), centre);
  const {area} = shape.measures()[component];
  return {
    at,
    text:
      `${plural(list[component].triangles, "triangle")}, area ${number(area)}` +
      `${unit ? ` ${unit}²` : ""}, at ${place(at)}`,
  };
}
