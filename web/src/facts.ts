// SPDX-License-Identifier: Apache-2.0
// The facts about a result next to the mesh: tables, the certificate, the command and parameters.
import {componentColour} from "./colours";
import type {Constraint, Kind, LevelFacts, RankedComponents, Result, Sampling} from "./data";
import {count, element, number, percent, plural, type Child} from "./dom";
import {histogram} from "./histogram";
import type {LevelShape} from "./scene";

const MAX_COMPONENTS = 20;

/** The largest two-sided distance between surface and mesh of a level; null: unknown. */
export function errorOf(level: LevelFacts): number | null {
  const metric = level.metrics?.["max-distance"];
  const known = [
    metric ? (metric.maximum ?? Infinity) : null,
    level.measured?.maximum ?? null,
  ].filter((error) => error !== null);
  return known.length > 0 ? Math.max(...known) : null;
}

export function errorText(level: LevelFacts, unit: string): string {
  const error = errorOf(level);
  if (error === null) return "error not measured";
  return error === Infinity ? "infinite error" : `error ${number(error)} ${unit}`;
}

function table(
  attributes: Record<string, string>,
  caption: string,
  head: string[],
  rows: HTMLTableRowElement[],
): HTMLElement {
  const out = element("table", attributes);
  if (caption) out.append(element("caption", {}, caption));
  out.append(
    element(
      "thead",
      {},
      element("tr", {}, ...head.map((text) => element("th", {scope: "col"}, text))),
    ),
    element("tbody", {}, ...rows),
  );
  return element("div", {class: "table"}, out);
}

function row(
  attributes: Record<string, string>,
  first: Child | Child[],
  ...rest: Child[]
): HTMLTableRowElement {
  return element(
    "tr",
    attributes,
    element("th", {scope: "row"}, ...(Array.isArray(first) ? first : [first])),
    ...rest.map((cell) => element("td", {}, cell)),
  );
}

const check = (good: boolean): HTMLElement =>
  element(
    "span",
    {class: good ? "good" : "bad", role: "img", "aria-label": good ? "yes" : "no"},
    good ? "✓" : "✗",
  );

export function section(title: string, ...children: Child[]): HTMLElement {
  return element("section", {"aria-label": title}, element("h2", {}, title), ...children);
}

function levelTable(result: Result, shown: number, shapes: LevelShape[]): HTMLElement {
  const rows = result.levels.map((level, k) => {
    const aspect = shapes[k].aspect();
    const error = errorOf(level);
    return row(
      k === shown ? {"aria-current": "true"} : {},
      `${level.level}`,
      count(level.vertices),
      count(level.triangles),
      error === null ? "–" : error === Infinity ? "∞" : number(error),
      number(aspect.minimum),
      percent(aspect.share_below_third),
    );
  });
  return table(
    {id: "levels"},
    "",
    ["Level", "Vertices", "Triangles", `Error, ${result.unit}`, "Min. aspect", "Below 1/3"],
    rows,
  );
}

const UNITS: Record<string, string> = {degrees: "°", ratio: "", count: ""};

function constraintLine(constraint: Constraint, unit: string): HTMLElement {
  const {quantity, bound, reached, satisfied, reason} = constraint;
  const written =
    constraint.unit === "world" ? ` ${unit}` : (UNITS[constraint.unit] ?? ` ${constraint.unit}`);
  const sign = quantity.startsWith("min-") ? "≥" : "≤";
  const is = reached === null ? "∞" : number(reached);
  const line = element(
    "li",
    {},
    check(satisfied),
    ` ${quantity} ${sign} ${number(bound)}${written}: ${is}${written}`,
  );
  if (!satisfied && reason) line.append(element("span", {class: "soft"}, ` – ${reason}`));
  return line;
}

function constraintList(level: LevelFacts, unit: string): Child[] {
  const constraints = level.constraints ?? [];
  if (constraints.length === 0) return [];
  return [
    element(
      "p",
      {class: "soft lead"},
      `Constraints of level ${level.level}, with the values reached:`,
    ),
    element(
      "ul",
      {class: "plain", id: "constraints"},
      ...constraints.map((c) => constraintLine(c, unit)),
    ),
  ];
}

/** The proved bound of the error, or else the density of its samples. */
function sampling(level: LevelFacts, unit: string): Child[] {
  if (errorOf(level) === null) return [];
  const {distance_at_most: atMost} = level;
  if (atMost !== null && atMost !== undefined) {
    return [
      element(
        "p",
        {class: "soft lead", id: "sampling"},
        `Proved: no point of the mesh is farther than ${number(atMost)} ${unit} from the ` +
          "isosurface, and no point of the isosurface is farther from the mesh.",
      ),
    ];
  }
  const points = ({samples, samples_per_voxel_face: density}: Sampling): string =>
    `${count(samples)} points (${number(density)} per voxel face)`;
  const {mesh_to_surface: mesh, surface_to_mesh: surface} = level.measured ?? {};
  const where =
    mesh && surface
      ? `${points(mesh)} of the mesh and ${points(surface)} of the isosurface`
      : "about 2 points per voxel face of the isosurface, and on every triangle";
  return [
    element(
      "p",
      {class: "soft lead", id: "sampling"},
      `Errors are sampled, at ${where}; between samples they may be larger.`,
    ),
  ];
}

const loops = (n: number): string => plural(n, "loop");

function kindsOf(level: LevelFacts, shape: LevelShape): Kind[] {
  if (level.kinds) return level.kinds;
  const kinds = new Map<string, Kind>();
  for (const {genus, boundaryLoops} of shape.components().list) {
    const name = `${genus} ${boundaryLoops}`;
    const kind = kinds.get(name) ?? {genus, boundary_loops: boundaryLoops, count: 0};
    ++kind.count;
    kinds.set(name, kind);
  }
  return [...kinds.values()];
}

/** The kinds of components compared with those of the isosurface, then the largest components. */
function topology(result: Result, level: LevelFacts, shape: LevelShape): Child[] {
  if (level.manifold === false) {
    return [
      element(
        "p",
        {id: "not-manifold"},
        element("strong", {class: "bad"}, "Not an oriented manifold"),
        ": genus and boundary loops are not defined. ",
        element("code", {}, "isoatlas check"),
        " counts the faults.",
      ),
    ];
  }
  const {reference} = result;
  const same =
    (a: Kind) =>
    (b: Kind): boolean =>
      a.genus === b.genus && a.boundary_loops === b.boundary_loops;
  const here = kindsOf(level, shape);
  const kinds = [
    ...here,
    ...(reference?.kinds ?? [])
      .filter((kind) => !here.some(same(kind)))
      .map((kind) => ({...kind, count: 0})),
  ];
  const rows = kinds.map((kind) => {
    const wanted = reference?.kinds.find(same(kind))?.count ?? 0;
    return row(
      {},
      `genus ${kind.genus}, ${loops(kind.boundary_loops)}`,
      count(kind.count),
      ...(reference ? [count(wanted), check(wanted === kind.count)] : []),
    );
  });
  const out: Child[] = [
    table(
      {id: "kinds"},
      "",
      reference
        ? ["Components of", `Level ${level.level}`, "Isosurface", "Same"]
        : ["Components of", `Level ${level.level}`],
      rows,
    ),
  ];
  if (!reference) {
    out.push(
      element("p", {class: "soft"}, "The file does not contain the topology of the isosurface."),
    );
  }
  const {list} = shape.components();
  const each = list.slice(0, MAX_COMPONENTS).map((component, i) => {
    const swatch = element("span", {class: "swatch"});
    swatch.style.background = componentColour(i);
    return row(
      {},
      [swatch, `${i + 1}`],
      count(component.triangles),
      number(component.genus),
      `${component.boundaryLoops}`,
    );
  });
  out.push(table({id: "components"}, "", ["Component", "Triangles", "Genus", "Loops"], each));
  const rest = list.slice(MAX_COMPONENTS);
  if (rest.length > 0) {
    const most = rest[0].triangles;
    out.push(
      element(
        "p",
        {class: "soft", id: "rest"},
        `and ${count(rest.length)} more, of at most ${plural(most, "triangle")} each.`,
      ),
    );
  }
  if (result.dropped) {
    const sized = (of: RankedComponents): string =>
      (of.parts < of.components ? `${plural(of.parts, "part")} in ` : "") +
      plural(of.components, "component") +
      (of.parts > 1 ? ", the largest" : "") +
      ` of ${number(of.largest)} cubic ${result.unit}`;
    if (result.kept)
      out.push(element("p", {class: "soft", id: "kept"}, `Kept: ${sized(result.kept)}.`));
    out.push(element("p", {class: "soft", id: "dropped"}, `Dropped: ${sized(result.dropped)}.`));
  }
  return out;
}

function certificate(level: LevelFacts): Child[] {
  const {certificate: c, self_intersections: pairs, inverted_components: misplaced} = level;
  const lines: HTMLElement[] = [];
  const line = (good: boolean | null, text: string): void =>
    void lines.push(element("li", {}, good === null ? "– " : check(good), ` ${text}`));
  if (c) {
    line(
      c.passed,
      plural(c.cells_checked, "Voronoi cell is a disk", "Voronoi cells are disks") +
        ", each with a triangle",
    );
    line(c.passed, `${count(c.arcs_checked)} pairs of adjacent cells share one arc each`);
    line(c.passed, `${count(c.triples_checked)} triples of cells share one point each`);
  }
  // The nesting of components is compared only if self-intersections were tested.
  if (misplaced === 0) {
    line(
      true,
      pairs == null
        ? "closed components have the orientation of the isosurface"
        : "closed components have the orientation and nesting of the isosurface",
    );
  } else if (misplaced != null) {
    line(
      false,
      `${plural(misplaced, "component")} inverted, ` +
        "or inside another component than on the isosurface",
    );
  }
  if (pairs === 0)
    line(true, "no self-intersections: triangles touch only in shared vertices and edges");
  else if (pairs != null) line(false, `${plural(pairs, "pair")} of triangles intersect`);
  else line(null, "self-intersections were not tested");
  const verdict = c
    ? element(
        "p",
        {class: "verdict"},
        element("strong", {class: c.passed ? "good" : "bad"}, c.passed ? "Passed" : "Failed"),
        ` on level ${level.level}: the mesh is a manifold with the topology of the isosurface.`,
      )
    : element("p", {class: "verdict"}, "The file has no certificate.");
  if (c && !c.passed) verdict.lastChild!.textContent = ` on level ${level.level}.`;
  return [verdict, element("ul", {class: "plain"}, ...lines)];
}

function value(of: unknown): string {
  if (of === null || of === undefined) return "–";
  if (typeof of === "string") return of;
  if (typeof of === "number") return number(of, 7);
  if (typeof of === "boolean") return of ? "yes" : "no";
  if (Array.isArray(of)) {
    if (of.length === 0) return "–";
    return of.every((x) => typeof x === "number")
      ? of
          .map((x) => number(x, 7))
          .join(" × ")
          .replaceAll(" × ", of.every((x) => Number.isInteger(x) && x > 0) ? " × " : ", ")
      : of.map(value).join("; ");
  }
  const {quantity, bound} = of as Record<string, unknown>;
  if (typeof quantity === "string") return `${quantity} ${value(bound)}`;
  return Object.entries(of).map(([key, inner]) => `${key} ${value(inner)}`).join(", ");
}

function copying(text: string, holder: HTMLElement): HTMLElement {
  const button = element("button", {type: "button", id: "copy"}, "Copy");
  button.addEventListener("click", () => {
    const done = (): void => void (button.textContent = "Copied");
    const select = (): void => {
      getSelection()?.selectAllChildren(holder);
      button.textContent = "Selected";
    };
    // A page opened as a file may not write to the clipboard.
    if (navigator.clipboard) navigator.clipboard.writeText(text).then(done, select);
    else select();
  });
  return button;
}

function made(result: Result): Child[] {
  const out: Child[] = [];
  if (result.command) {
    const code = element("code", {}, result.command);
    out.push(
      element("pre", {tabindex: "0", "aria-label": "Command", id: "command"}, code),
      copying(result.command, code),
    );
  } else {
    out.push(element("p", {class: "soft"}, "The file does not contain the command."));
  }
  const groups: HTMLElement[] = [];
  for (const [name, part] of [
    ["Input", result.input],
    ["Surface", result.surface],
    ["Parameters", result.parameters],
  ] as const) {
    const entries = Object.entries(part ?? {});
    if (entries.length > 0) {
      groups.push(
        table(
          {},
          name,
          ["Name", "Value"],
          entries.map(([key, of]) => row({}, key.replaceAll("_", " "), value(of))),
        ),
      );
    }
  }
  if (groups.length > 0) {
    out.push(
      element("details", {id: "parameters"}, element("summary", {}, "Parameters"), ...groups),
    );
  } else {
    out.push(element("p", {class: "soft"}, "The file does not contain the parameters."));
  }
  return out;
}

/** All sections that depend on the shown level. */
export function facts(result: Result, shown: number, shapes: LevelShape[]): HTMLElement[] {
  const level = result.levels[shown];
  return [
    section(
      "Levels",
      levelTable(result, shown, shapes),
      ...sampling(level, result.unit),
      ...constraintList(level, result.unit),
    ),
    section("Aspect ratios", histogram(result, shown, shapes[shown].aspect())),
    section("Topology", ...topology(result, level, shapes[shown])),
    section("Certificate", ...certificate(level)),
  ];
}

export function origin(result: Result): HTMLElement {
  return section("Made by", ...made(result));
}

/** One line below the title. */
export function summary(result: Result): string {
  const {input, surface, levels} = result;
  const last = levels[levels.length - 1];
  const parts: string[] = [];
  if (Array.isArray(input?.size)) parts.push(`${input.size.join(" × ")} samples`);
  if (typeof surface?.isovalue === "number") parts.push(`isovalue ${number(surface.isovalue, 6)}`);
  parts.push(
    plural(last.components, "component") +
      (result.dropped ? ` of ${count(last.components + result.dropped.components)}` : ""),
  );
  if (last.genus != null) parts.push(`genus ${count(last.genus)}`);
  return parts.join(" · ");
}
