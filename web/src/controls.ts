// SPDX-License-Identifier: Apache-2.0
// Controls. They are native inputs of the browser, so that keyboards and screen readers work.
import {element} from "./dom";

export interface Option<T extends string> {
  value: T;
  text: string;
}

export interface Choice<T extends string> {
  field: HTMLFieldSetElement;
  value: () => T;
  set: (value: T) => void;
  /** @param why the reason that is shown if the value is not enabled */
  enable: (value: T, enabled: boolean, why: string) => void;
}

/** A choice of one of several visible options. */
export function choice<T extends string>(
  name: string,
  legend: string,
  options: Option<T>[],
  changed: () => void,
): Choice<T> {
  const inputs = new Map<T, HTMLInputElement>();
  const chips = options.map(({value, text}) => {
    const input = element("input", {type: "radio", name, value, id: `${name}-${value}`});
    input.addEventListener("change", changed);
    inputs.set(value, input);
    return element("span", {class: "chip"}, input, element("label", {for: input.id}, text));
  });
  inputs.get(options[0].value)!.checked = true;
  const note = element("p", {class: "soft note"});
  note.hidden = true;
  const reasons = new Map<T, string>();  // why options are disabled
  const field = element(
    "fieldset",
    {id: name},
    element("legend", {}, legend),
    element("div", {class: "chips"}, ...chips),
    note,
  );
  return {
    field,
    value: () => options.find(({value}) => inputs.get(value)!.checked)!.value,
    set: (value) => void (inputs.get(value)!.checked = true),
    enable: (value, enabled, why) => {
      inputs.get(value)!.disabled = !enabled;
      reasons.delete(value);
      if (!enabled) reasons.set(value, why);
      note.hidden = reasons.size === 0;
      note.textContent = [...reasons.values()].join(" ");
      if (!enabled && inputs.get(value)!.checked) inputs.get(options[0].value)!.checked = true;
    },
  };
}

export interface CutControl {
  field: HTMLElement;
  share: () => number;
  keepsAbove: () => boolean;
  /** Shows a text that describes the cut. */
  setText: (text: string) => void;
  reset: () => void;
}

/**
 * A slider through the bounding box along one axis, and a button to keep the other side.
 * @param keepsAbove whether the upper side is kept at first; the other side faces the viewer
 */
export function cutControl(axis: string, keepsAbove: boolean, changed: () => void): CutControl {
  const end = (): string => (above() ? "0" : "1");  // the position that keeps the whole mesh
  const input = element("input", {
    type: "range",
    id: `cut-${axis}`,
    min: "0",
    max: "1",
    step: "0.005",
  });
  const output = element("output", {for: input.id}, "off");
  const flip = element(
    "button",
    {
      type: "button",
      id: `flip-${axis}`,
      class: "flip",
      "aria-pressed": "false",
      "aria-label": `Keep the other side of ${axis}`,
      title: "Keep the other side",
    },
    "⇄",
  );
  const pressed = (): boolean => flip.getAttribute("aria-pressed") === "true";
  const above = (): boolean => pressed() !== keepsAbove;
  input.value = end();
  input.addEventListener("input", changed);
  flip.addEventListener("click", () => {
    const off = input.value === end();
    flip.setAttribute("aria-pressed", `${!pressed()}`);
    if (off) input.value = end();
    changed();
  });
  return {
    field: element(
      "div",
      {class: "cut"},
      element(
        "label",
        {for: input.id},
        element("span", {class: "visually-hidden"}, "Cut along "),
        axis,
      ),
      input,
      output,
      flip,
    ),
    share: () => Number(input.value),
    keepsAbove: above,
    setText: (text) => {
      output.value = text;
      input.setAttribute("aria-valuetext", text);
    },
    reset: () => {
      flip.setAttribute("aria-pressed", "false");
      input.value = end();
      changed();
    },
  };
}

export interface LevelSlider {
  field: HTMLElement;
  input: HTMLInputElement;
  open: (levels: number, at: number) => void;
  setText: (level: string, error: string) => void;
}

export function levelSlider(changed: () => void): LevelSlider {
  const input = element("input", {type: "range", id: "level", min: "0", step: "1"});
  const level = element("output", {for: "level", id: "level-text"});
  const error = element("output", {for: "level", id: "error"});
  const ticks = element("div", {class: "ticks", "aria-hidden": "true"});
  input.addEventListener("input", changed);
  return {
    field: element(
      "div",
      {class: "level"},
      element("label", {for: "level"}, "Level"),
      level,
      error,
      element("div", {class: "track"}, input, ticks),
    ),
    input,
    open: (levels, at) => {
      input.max = `${Math.max(levels - 1, 0)}`;
      input.value = `${at}`;
      input.disabled = levels < 2;
      ticks.replaceChildren(
        ...Array.from({length: levels}, (_, k) => {
          const tick = element(
            "span",
            {},
            levels <= 12 || k % Math.ceil(levels / 10) === 0 ? `${k}` : "",
          );
          tick.style.setProperty("--at", `${levels > 1 ? k / (levels - 1) : 0}`);
          return tick;
        }),
      );
    },
    setText: (levelText, errorText) => {
      level.value = levelText;
      error.value = errorText;
      input.setAttribute("aria-valuetext", `${levelText}, ${errorText}`);
    },
  };
}
