// SPDX-License-Identifier: Apache-2.0
// The legend below the picture.
import type {Legend} from "./colours";
import {element} from "./dom";

function ramp({colours, ticks}: NonNullable<Legend["ramp"]>): HTMLElement {
  const bar = element("div", {class: "bar"});
  bar.style.background = `linear-gradient(to right, ${colours.join(", ")})`;
  const ends = element("div", {class: "ends"}, ...ticks.map((text) => element("span", {}, text)));
  return element("div", {class: "ramp"}, bar, ends);
}

function steps({colours, shares, ticks}: NonNullable<Legend["steps"]>): HTMLElement {
  const bar = element("div", {class: "bar"}, ...colours.map((colour, i) => {
    const step = element("span");
    step.style.background = colour;
    step.style.flexGrow = `${shares[i]}`;
    return step;
  }));
  const below = element("div", {class: "ticks"}, ...ticks.map(({at, text}) => {
    const tick = element("span", {}, text);
    tick.style.left = `${100 * at}%`;
    return tick;
  }));
  return element("div", {class: "ramp"}, bar, below);
}

export function swatch(colour: string): HTMLElement {
  const out = element("span", {class: "swatch"});
  out.style.background = colour;
  return out;
}

/** @param more classes that the colouring does not have, such as that of cuts */
export function legendOf(
  legend: Legend | null,
  more: {colour: string; name: string}[],
): HTMLElement[] {
  const out: HTMLElement[] = [];
  if (legend?.title) out.push(element("p", {class: "legend-title"}, legend.title));
  if (legend?.ramp) out.push(ramp(legend.ramp));
  if (legend?.steps) out.push(steps(legend.steps));
  const classes = [...(legend?.classes ?? []), ...more];
  if (classes.length > 0) {
    out.push(
      element(
        "ul",
        {class: "classes"},
        ...classes.map(({colour, name}) => element("li", {}, swatch(colour), name)),
      ),
    );
  }
  if (legend?.note) out.push(element("p", {}, legend.note));
  return out;
}
