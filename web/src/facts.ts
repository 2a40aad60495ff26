// What is known of a result, as tables and a drawing beside the mesh.
import type {Kind, LevelFacts, Result} from "./data";

type Child = Node | string;

export function element(tag: string, attributes: Record<string, string> = {}, ...children: Child[]): HTMLElement {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, value);
  out.append(...children);
  return out;
}

const count = (n: number): string => n.toLocaleString("en");
const ratio = (n: number): string => Number(n.toPrecision(3)).toString();
const percent = (share: number): string => (share === 0 ? "0 %" : `${Number((100 * share).toPrecision(2))} %`);

function table(caption: string, head: string[], rows: Child[][]): HTMLElement {
  const header = element("tr", {}, ...head.map((text) => element("th", {scope: "col"}, text)));
  const body = rows.map(([first, ...rest]) => element("tr", {}, element("th", {scope: "row"}, first), ...rest.map((cell) => element("td", {}, cell))));
  return element("div", {class: "table"}, element("table", {}, element("caption", {}, caption), element("thead", {}, header), element("tbody", {}, ...body)));
}

/** The largest distance between surface and mesh of a level. */
export function error(level: LevelFacts, unit: string): string {
  const known = level.metrics?.["max-distance"]?.maximum;
  return known == null ? "not measured" : `${Number(known.toPrecision(3))} ${unit}`;
}

function levelTable(result: Result): HTMLElement {
  return table(
    "Levels",
    ["Level", "Vertices", "Triangles", "Largest error", "Aspect ratio, least", "Below 1/3"],
    result.levels.map((l) => [
      `${l.level}`,
      count(l.vertices),
      count(l.triangles),
      error(l, result.unit),
      ratio(l.quality.aspect_ratio.minimum),
      percent(l.quality.aspect_ratio.share_below_third),
    ]),
  );
}

function topologyTable(result: Result, level: LevelFacts): HTMLElement {
  const name = ({genus, boundary_loops}: Kind): string => `genus ${genus}, ${boundary_loops} boundary loop${boundary_loops === 1 ? "" : "s"}`;
  const reference = new Map((result.reference?.kinds ?? []).map((kind) => [name(kind), kind.count]));
  const rows = level.kinds.map((kind) => [name(kind), count(kind.count), reference.size > 0 ? count(reference.get(name(kind)) ?? 0) : "-"]);
  const reference_count = result.reference ? count(result.reference.components) : "-";
  const all = [`all: genus ${level.genus}, ${level.boundary_loops} loops, Euler characteristic ${level.euler_characteristic}`, count(level.components), reference_count];
  return table(`Topology of level ${level.level}, component by component`, ["Components with", "in the mesh", "in the isosurface"], [...rows, all]);
}

function certificate(level: LevelFacts): HTMLElement {
  const c = level.certificate;
  if (!c) return element("p", {}, "The file has no certificate.");
  const intersections =
    level.self_intersections == null ? "Whether triangles meet was not asked." : level.self_intersections === 0 ? "No two triangles meet." : `${count(level.self_intersections)} pairs of triangles meet.`;
  return element(
    "p",
    {},
    element("strong", {class: c.passed ? "good" : "bad"}, c.passed ? "Certificate passed. " : "Certificate FAILED. "),
    `${count(c.cells_checked)} cells are disks, ${count(c.arcs_checked)} pairs meet in one arc, ${count(c.triples_checked)} triples in one point. ${intersections}`,
  );
}

const SVG = "http://www.w3.org/2000/svg";

function drawn(tag: string, attributes: Record<string, string | number>, text = ""): SVGElement {
  const out = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, `${value}`);
  out.textContent = text;
  return out;
}

/** Shares of triangles per bin of aspect ratio, the mesh's as bars and marching cubes' as a line (the paper's figure 12). */
function histogram(result: Result, level: LevelFacts): HTMLElement {
  const [width, height, left, bottom] = [420, 180, 34, 34];
  const shares = (bins: number[]): number[] => {
    const all = bins.reduce((a, b) => a + b, 0) || 1;
    return bins.map((n) => n / all);
  };
  const ours = shares(level.quality.aspect_ratio.histogram);
  const theirs = result.marching_cubes ? shares(result.marching_cubes.histogram) : null;
  const top = Math.max(...ours, ...(theirs ?? [])) * 1.08;
  const x = (bin: number): number => left + (bin / ours.length) * (width - left - 6);
  const y = (share: number): number => height - bottom - (share / top) * (height - bottom - 8);
  const below = percent(level.quality.aspect_ratio.share_below_third);
  const words = theirs
    ? `Aspect ratios: ${below} of this level's triangles are below 1/3, of marching cubes' ${percent(result.marching_cubes!.share_below_third)}.`
    : `Aspect ratios: ${below} of this level's triangles are below 1/3.`;
  const svg = drawn("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": words, class: "histogram"});
  ours.forEach((share, bin) => svg.append(drawn("rect", {class: "ours", x: x(bin) + 1, y: y(share), width: x(1) - x(0) - 2, height: y(0) - y(share)})));
  if (theirs) {
    const path = theirs.map((share, bin) => `${bin === 0 ? "M" : "L"}${x(bin)},${y(share)}H${x(bin + 1)}`).join("");
    svg.append(drawn("path", {class: "theirs", d: path}));
  }
  svg.append(drawn("line", {class: "third", x1: x(ours.length / 3), x2: x(ours.length / 3), y1: 8, y2: y(0)}), drawn("line", {class: "axis", x1: left, x2: width - 6, y1: y(0), y2: y(0)}));
  for (const at of [0, 1 / 3, 0.5, 1]) {
    svg.append(drawn("text", {x: x(at * ours.length), y: height - bottom + 15, "text-anchor": "middle"}, at === 1 / 3 ? "1/3" : `${at}`));
  }
  svg.append(drawn("text", {x: left - 6, y: y(top / 1.08) + 8, "text-anchor": "end"}, percent(top / 1.08)), drawn("text", {x: (left + width) / 2, y: height - 4, "text-anchor": "middle"}, "shortest edge / longest edge"));
  const key = element("p", {class: "key"}, element("span", {class: "swatch ours"}), "this level");
  if (theirs) key.append(element("span", {class: "swatch theirs"}), `marching cubes, ${count(result.marching_cubes!.triangles)} triangles`);
  const out = element("figure", {}, element("figcaption", {}, words));
  out.append(svg, key);
  return out;
}

function parameters(result: Result): HTMLElement {
  const out = element("details", {}, element("summary", {}, "Parameters"));
  const rows: Child[][] = [];
  for (const part of [result.input, result.surface, result.parameters]) {
    for (const [key, value] of Object.entries(part ?? {})) rows.push([key.replaceAll("_", " "), typeof value === "string" ? value : JSON.stringify(value)]);
  }
  out.append(rows.length > 0 ? table("Parameters", ["Name", "Value"], rows) : element("p", {}, "The file does not say."));
  return out;
}

export function facts(result: Result, shown: number): HTMLElement[] {
  const level = result.levels[shown];
  const made = result.command
    ? element("div", {class: "command"}, element("h2", {}, "Made by"), element("pre", {tabindex: "0"}, element("code", {}, result.command)))
    : element("p", {}, "The file does not say which command made it.");
  return [certificate(level), levelTable(result), histogram(result, level), topologyTable(result, level), made, parameters(result)];
}
