// SPDX-License-Identifier: Apache-2.0
// Histogram of the aspect ratios of a level above the axis, and of marching cubes below it, as in
// the paper's figure 12.
import type {AspectRatio, Result} from "./data";
import {count, drawn, element, percent, plural} from "./dom";
import {levelName} from "./words";

function shares(bins: number[]): number[] {
  const all = bins.reduce((a, b) => a + b, 0) || 1;
  return bins.map((n) => n / all);
}

/** Bars in a box of 100 by 100, which is stretched. Texts are HTML and not stretched. */
function bars(of: number[], top: number, down: boolean): SVGElement {
  const svg = drawn("svg", {
    viewBox: "0 0 100 100",
    preserveAspectRatio: "none",
    "aria-hidden": "true",
  });
  const width = 100 / of.length;
  of.forEach((share, bin) => {
    const height = (100 * share) / top;
    // The bin that contains 1/3 has the good colour; the caption states the exact share below 1/3.
    const name = (bin + 1) / of.length <= 1 / 3 ? "poor" : "good";
    svg.append(
      drawn("rect", {
        class: name,
        x: bin * width + 0.35,
        width: width - 0.7,
        y: down ? 0 : 100 - height,
        height,
      }),
    );
  });
  return svg;
}

export function histogram(result: Result, level: number, aspect: AspectRatio): HTMLElement {
  const ours = shares(aspect.histogram);
  const cubes = result.marching_cubes;
  const theirs = cubes ? shares(cubes.histogram) : null;
  const top = Math.max(...ours, ...(theirs ?? []), 0.01) * 1.12;
  const own = percent(aspect.share_below_third);
  const theirOwn = cubes ? `; with marching cubes ${percent(cubes.share_below_third)}` : "";
  const named = `Level ${levelName(result.levels[level])}`;
  const words = `${own} of the triangles of ${named.toLowerCase()} are below 1/3${theirOwn}.`;

  const half = (bins: number[], down: boolean): HTMLElement =>
    element("div", {class: "half"}, bars(bins, top, down));
  const name = (of: string, triangles: number): HTMLElement =>
    element(
      "p",
      {},
      element("strong", {}, of),
      element("span", {class: "soft"}, ` ${plural(triangles, "triangle")}`),
    );
  const chart = element("div", {
    class: "chart",
    role: "img",
    "aria-label": `Histogram of aspect ratios. ${words}`,
  });
  chart.append(half(ours, false));
  const ticks = [0, 1 / 3, 0.5, 1].map((at) => {
    const tick = element("span", {}, at === 1 / 3 ? "1/3" : `${at}`);
    tick.style.left = `${100 * at}%`;
    return tick;
  });
  chart.append(element("div", {class: "ticks"}, ...ticks));
  if (theirs) chart.append(half(theirs, true));
  const third = element("span", {class: "third"});
  third.style.left = `${100 / 3}%`;
  chart.append(third);

  const rows = ours.map((_, bin) => {
    const [from, to] = [bin / ours.length, (bin + 1) / ours.length].map((x) => x.toFixed(2));
    const cells = [aspect.histogram[bin], ...(cubes ? [cubes.histogram[bin] ?? 0] : [])];
    return element(
      "tr",
      {},
      element("th", {scope: "row"}, `${from} to ${to}`),
      ...cells.map((n) => element("td", {}, count(n))),
    );
  });
  const heads = ["Aspect ratio", named, ...(cubes ? ["Marching cubes"] : [])];
  const numbers = element(
    "details",
    {class: "numbers"},
    element("summary", {}, "As numbers"),
    element(
      "table",
      {id: "histogram-numbers"},
      element(
        "thead",
        {},
        element("tr", {}, ...heads.map((text) => element("th", {scope: "col"}, text))),
      ),
      element("tbody", {}, ...rows),
    ),
  );
  const out = element(
    "figure",
    {class: "histogram"},
    name(named, result.levels[level].triangles),
    chart,
  );
  if (cubes) out.append(name("Marching cubes", cubes.triangles));
  out.append(element("figcaption", {}, words));
  if (cubes && result.dropped) {
    out.append(
      element(
        "p",
        {class: "soft", id: "same-components"},
        "Of marching cubes, only the kept components are counted, as in the levels.",
      ),
    );
  }
  if (!cubes) {
    out.append(
      element(
        "p",
        {class: "soft"},
        "No comparison with marching cubes: the volume was not available.",
      ),
    );
  }
  out.append(numbers);
  return out;
}
