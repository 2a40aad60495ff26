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
  /** Has no effect if the value is unknown or not enabled. */
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
    set: (value) => {
      const input = inputs.get(value);
      if (input && !input.disabled) input.checked = true;
    },
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

export function button(
  id: string,
  text: string | Node,
  pressed: () => void,
  attributes: Record<string, string> = {},
): HTMLButtonElement {
  const out = element("button", {type: "button", id, ...attributes}, text);
  out.addEventListener("click", pressed);
  return out;
}

/** A line that states what is wrong in a field; hidden while it is empty. */
export const problemLine = (id: string): HTMLElement =>
  element("p", {class: "bad problem", role: "alert", id});

export interface Checkbox {
  field: HTMLElement;
  input: HTMLInputElement;
}

export function checkbox(id: string, text: string, changed: () => void): Checkbox {
  const input = element("input", {type: "checkbox", id});
  input.addEventListener("change", changed);
  return {
    field: element("label", {class: "checkbox", for: id}, input, element("span", {}, text)),
    input,
  };
}

export interface CutControl {
  field: HTMLElement;
  /** The position of the cut in the box, 0 to 1. */
  share: () => number;
  keepsAbove: () => boolean;
  /** The share of the box that is removed, and whether it is removed from the other side. */
  state: () => {removed: number; flipped: boolean};
  /** Shows a text that describes the cut. */
  setText: (text: string) => void;
  set: (state: {removed: number; flipped: boolean}) => void;
  reset: () => void;
}

/**
 * A slider for how much of the bounding box is removed along one axis, from nothing at its start to
 * everything at its end, and a button to remove the other side.
 * @param keepsAbove whether the upper side is kept at first; the other side faces the viewer
 */
export function cutControl(axis: string, keepsAbove: boolean, changed: () => void): CutControl {
  const input = element("input", {
    type: "range",
    id: `cut-${axis}`,
    min: "0",
    max: "1",
    step: "0.005",
    value: "0",
  });
  const output = element("output", {for: input.id}, "off");
  const flip = button(`flip-${axis}`, "⇄", () => {
    // The cut keeps its position.
    if (removed() > 0) input.value = `${1 - removed()}`;
    setFlipped(!flipped());
    changed();
  }, {
    class: "flip",
    "aria-pressed": "false",
    "aria-label": `Keep the other side of ${axis}`,
    title: "Keep the other side",
  });
  const removed = (): number => Number(input.value);
  const flipped = (): boolean => flip.getAttribute("aria-pressed") === "true";
  const setFlipped = (to: boolean): void => flip.setAttribute("aria-pressed", `${to}`);
  const above = (): boolean => flipped() !== keepsAbove;
  const set: CutControl["set"] = (state) => {
    setFlipped(state.flipped);
    input.value = `${state.removed}`;
    changed();
  };
  input.addEventListener("input", changed);
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
    share: () => (above() ? removed() : 1 - removed()),
    keepsAbove: above,
    state: () => ({removed: removed(), flipped: flipped()}),
    setText: (text) => {
      output.value = text;
      input.setAttribute("aria-valuetext", text);
    },
    set,
    reset: () => set({removed: 0, flipped: false}),
  };
}

export interface LevelSlider {
  field: HTMLElement;
  input: HTMLInputElement;
  /** @param names per level, its number as shown */
  open: (names: string[], at: number) => void;
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
    open: (names, at) => {
      const levels = names.length;
      input.max = `${Math.max(levels - 1, 0)}`;
      input.value = `${at}`;
      input.disabled = levels < 2;
      ticks.replaceChildren(
        ...names.map((name, k) => {
          const tick = element(
            "span",
            {},
            levels <= 12 || k % Math.ceil(levels / 10) === 0 ? name : "",
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
