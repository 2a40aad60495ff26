// SPDX-License-Identifier: Apache-2.0
// The list of components with their sizes: shows, hides and isolates them.
import {componentColour} from "./colours";
import {button} from "./controls";
import type {RankedComponents, Result} from "./data";
import {count, element, number, plural, type Child} from "./dom";
import {swatch} from "./legend";
import type {LevelShape} from "./level_shape";
import type {Measures} from "./measures";
import {explained, row, section, table} from "./tables";

const FIRST_ROWS = 10;
const MORE_ROWS = 100;

/** Which components are hidden, and which one is selected. Numbers are the same in all levels. */
export class ComponentChoice {
  readonly hidden = new Set<number>();
  selected: number | null = null;

  /** @param changed gets whether others are hidden; if not, another one is selected */
  constructor(private readonly changed: (hidden: boolean) => void) {}

  readonly isShown = (component: number): boolean => !this.hidden.has(component);

  select(component: number | null): void {
    this.selected = component;
    this.changed(false);
  }

  show(component: number, shown: boolean): void {
    if (shown) this.hidden.delete(component);
    else this.hidden.add(component);
    this.changed(true);
  }

  /** Hides all other components. @param all the number of components */
  isolate(component: number, all: number): void {
    this.set(Array.from({length: all}, (_, i) => i).filter((i) => i !== component));
  }

  set(hidden: number[]): void {
    this.hidden.clear();
    for (const component of hidden) this.hidden.add(component);
    this.changed(true);
  }

  reset(): void {
    this.selected = null;
    this.set([]);
  }
}

/** Measures of a component as text. @param facing 1, or -1 if outer surfaces face inward */
export function measuresText(
  {low, high, area, volume}: Measures,
  closed: boolean,
  facing: number,
  unit: string,
): {area: string; volume: string; extent: string; cavity: boolean} {
  return {
    area: number(area),
    volume: closed ? number(Math.abs(volume)) : "–",
    extent: `${high.map((v, axis) => number(v - low[axis])).join(" × ")} ${unit}`,
    cavity: closed && volume * facing < 0,
  };
}

interface Row {
  shown: HTMLInputElement;
  lines: HTMLElement[];
}

export class ComponentList {
  private readonly rows = new Map<number, Row>();
  private readonly all = button("show-all", "Show all", () => this.choice.set([]));
  private listed = FIRST_ROWS;

  constructor(private readonly choice: ComponentChoice) {}

  /**
   * @param unit of the positions
   * @param facing 1, or -1 if outer surfaces face inward
   * @param notes what is shown above the list
   */
  open(shape: LevelShape, unit: string, facing: number, notes: Child[] = []): HTMLElement {
    this.rows.clear();
    const {list} = shape.components();
    const body = list.slice(0, this.listed).flatMap((_, i) => this.row(i, shape, unit, facing));
    const listed = table(
      {id: "components"},
      "",
      ["Component", "Triangles", `Area, ${unit}²`, `Volume, ${unit}³`, ""],
      body,
    );
    const out = section("Components", ...notes, listed);
    const rest = list.length - this.listed;
    if (rest > 0) {
      const most = list[this.listed].triangles;
      out.append(
        element(
          "p",
          {class: "soft", id: "rest"},
          `and ${count(rest)} more, of at most ${plural(most, "triangle")} each. `,
        ),
      );
    }
    const buttons = element("div", {class: "buttons"}, this.all);
    if (rest > 0) {
      buttons.append(
        button("list-more", `List ${count(Math.min(rest, MORE_ROWS))} more`, () => {
          this.listed += MORE_ROWS;
          out.replaceWith(this.open(shape, unit, facing, notes));
          this.rows.get(this.listed - MORE_ROWS)?.shown.focus();
        }),
      );
    }
    out.append(
      buttons,
      explained([
        ["Genus", "number of handles: 0 for a ball, 1 for a ring, 2 for the figure 8"],
        ["Loop", "an opening, where the side of the volume cuts the surface"],
        ["Volume", "what a closed component encloses; an open one encloses none"],
      ]),
    );
    this.refresh();
    return out;
  }

  private row(i: number, shape: LevelShape, unit: string, facing: number): HTMLTableRowElement[] {
    const {list} = shape.components();
    const {triangles, genus, boundaryLoops} = list[i];
    const isManifold = shape.level.facts.manifold !== false;
    const text = measuresText(shape.measures()[i], shape.encloses(i), facing, unit);
    const shown = element("input", {
      type: "checkbox",
      id: `shown-${i + 1}`,
      "aria-label": `Show component ${i + 1}`,
    });
    shown.addEventListener("change", () => this.choice.show(i, shown.checked));
    const only = button(`only-${i + 1}`, "Only", () => this.choice.isolate(i, list.length), {
      "aria-label": `Show only component ${i + 1}`,
      class: "small",
    });
    const label = element(
      "label",
      {class: "component"},
      shown,
      swatch(componentColour(i)),
      `${i + 1}`,
    );
    const first = row({"data-component": `${i + 1}`}, label, count(triangles), text.area,
      text.volume, only);
    const more = element("tr", {class: "more"});
    const kind = [
      text.extent,
      isManifold ? `genus ${number(genus)}` : "not a manifold",
      isManifold && boundaryLoops > 0 ? `open: ${plural(boundaryLoops, "loop")}` : "",
      text.cavity ? "cavity" : "",
    ];
    more.append(element("td", {colspan: "5", class: "soft"}, kind.filter(Boolean).join(" · ")));
    this.rows.set(i, {shown, lines: [first, more]});
    return [first, more];
  }

  /** Shows which components are hidden and selected. */
  refresh(): void {
    for (const [i, {shown, lines}] of this.rows) {
      shown.checked = this.choice.isShown(i);
      for (const line of lines) line.classList.toggle("selected", i === this.choice.selected);
    }
    this.all.disabled = this.choice.hidden.size === 0;
  }
}

/** What was kept and left out of the isosurface. */
export function keptAndDropped(result: Result): Child[] {
  const {kept, dropped, parameters, unit} = result;
  if (!dropped) return [];
  const sized = (of: RankedComponents, kind: string): string =>
    (of.parts < of.components ? `${plural(of.parts, "part")} in ` : "") +
    plural(of.components, `${kind}component`) +
    (of.components > 1 ? ", the largest" : "") +
    ` of ${number(of.largest)} ${unit}³`;
  const keep = parameters?.keep_components;
  const option =
    typeof keep === "number" && keep > 0
      ? `--keep-components ${keep}`
      : typeof parameters?.min_component_size === "number" && parameters.min_component_size > 0
        ? `--min-component-size ${parameters.min_component_size}`
        : "";
  const out: Child[] = [
    element(
      "p",
      {id: "dropped"},
      `Left out: ${sized(dropped, "smaller ")}${option ? ` (${option})` : ""}.`,
    ),
  ];
  if (kept) out.unshift(element("p", {class: "soft", id: "kept"}, `Kept: ${sized(kept, "")}.`));
  return out;
}
