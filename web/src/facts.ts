// SPDX-License-Identifier: Apache-2.0
// The facts about a result next to the mesh: levels, topology, the certificate.
import type {Constraint, Kind, LevelFacts, Result, Sampling} from "./data";
import {count, element, number, percent, plural, type Child} from "./dom";
import {histogram} from "./histogram";
import type {LevelShape} from "./level_shape";
import {check, explained, row, section, table} from "./tables";
import {errorOf, levelName, plainReason} from "./words";

function levelTable(result: Result, shown: number, shapes: LevelShape[]): HTMLElement {
  const rows = result.levels.map((level, k) => {
    const aspect = shapes[k].aspect();
    const error = errorOf(level);
    return row(
      k === shown ? {"aria-current": "true"} : {},
      levelName(level),
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

/** A default bound that is not reached is no failure, because the command does not request it. */
function constraintLine(constraint: Constraint, unit: string): HTMLElement {
  const {quantity, bound, reached, satisfied, reason} = constraint;
  const isDefault = constraint.default === true;
  const written =
    constraint.unit === "world" ? ` ${unit}` : (UNITS[constraint.unit] ?? ` ${constraint.unit}`);
  const sign = quantity.startsWith("min-") ? "≥" : "≤";
  const is = reached === null ? "∞" : number(reached);
  const line = element(
    "li",
    {},
    satisfied || !isDefault ? check(satisfied) : "–",
    ` ${quantity} ${sign} ${number(bound)}${written}: ${is}${written}`,
  );
  if (!satisfied && isDefault) line.append(" (not reached)");
  if (!satisfied && reason) {
    const words = ` – ${plainReason(reason)}`.split(/(--[\w-]+ \d+)/);
    line.append(
      element(
        "span",
        {class: "soft"},
        ...words.map((text, i) => (i % 2 ? element("span", {class: "option"}, text) : text)),
      ),
    );
  }
  return line;
}

/** Bounds that the command requests, then those that apply by default. */
function constraintLists(level: LevelFacts, unit: string): Child[] {
  const constraints = level.constraints ?? [];
  const lists: [string, string, Constraint[]][] = [
    [
      "requested",
      `Requested of level ${levelName(level)}, with the values reached:`,
      constraints.filter((c) => c.default !== true),
    ],
    [
      "defaults",
      "Default bounds, which the command does not request:",
      constraints.filter((c) => c.default === true),
    ],
  ];
  return lists
    .filter(([, , list]) => list.length > 0)
    .flatMap(([id, title, list]) => [
      element("p", {class: "soft lead"}, title),
      element("ul", {class: "plain", id}, ...list.map((c) => constraintLine(c, unit))),
    ]);
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

/** The kinds of components compared with those of the isosurface. */
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
        ? [
            "Components of",
            `Level ${levelName(level)}`,
            result.dropped ? "Isosurface, kept" : "Isosurface",
            "Same",
          ]
        : ["Components of", `Level ${levelName(level)}`],
      rows,
    ),
  ];
  if (!reference) {
    out.push(
      element("p", {class: "soft"}, "The file does not contain the topology of the isosurface."),
    );
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
        ` on level ${levelName(level)}: ` +
          "the mesh is a manifold with the topology of the isosurface.",
      )
    : element("p", {class: "verdict"}, "The file has no certificate.");
  if (c && !c.passed) verdict.lastChild!.textContent = ` on level ${levelName(level)}.`;
  return [
    verdict,
    element("ul", {class: "plain"}, ...lines),
    explained([
      ["Voronoi cell", "the part of the isosurface that is nearest to one vertex of the mesh"],
      ["Disk", "a piece of surface without holes and handles"],
      [
        "Why it matters",
        "if all cells are disks, two share at most one arc, and three at most one point, the " +
          "mesh has the same components, handles and openings as the isosurface",
      ],
    ]),
  ];
}

/** All sections that depend on the shown level. @param components the list of components */
export function facts(
  result: Result,
  shown: number,
  shapes: LevelShape[],
  components: HTMLElement,
): HTMLElement[] {
  const level = result.levels[shown];
  return [
    section(
      "Levels",
      levelTable(result, shown, shapes),
      ...levelNote(result),
      ...sampling(level, result.unit),
      ...constraintLists(level, result.unit),
    ),
    components,
    section("Aspect ratios", histogram(result, shown, shapes[shown].aspect())),
    section("Topology", ...topology(result, level, shapes[shown])),
    section("Certificate", ...certificate(level)),
  ];
}

/** What the table does not show: levels that are not in the page. */
function levelNote({levels}: Result): Child[] {
  const missing = levels[levels.length - 1].level + 1 - levels.length;
  if (missing <= 0) return [];
  return [
    element(
      "p",
      {class: "soft lead", id: "missing-levels"},
      `${plural(missing, "coarser level is", "coarser levels are")} not in the files of this page.`,
    ),
  ];
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
