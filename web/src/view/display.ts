// SPDX-License-Identifier: Apache-2.0
// How slices and mesh are drawn.
import type {Colouring} from "../colours";
import {button, checkbox, choice, problemLine, type Checkbox, type Choice} from "../controls";
import {element, number} from "../dom";
import {STYLES, type Style} from "../scene";
import type {GreyRange} from "./grey";

const COLOURINGS: {value: Colouring; text: string}[] = [
  {value: "plain", text: "Plain"},
  {value: "component", text: "Component"},
  {value: "aspect", text: "Aspect ratio"},
];

export interface DisplayListener {
  rangeTyped: (range: GreyRange) => void;
  rangeReset: () => void;
  slicesChanged: () => void;
  meshChanged: () => void;
}

export class Display {
  readonly tint: Checkbox;
  readonly isoline: Checkbox;
  readonly cross: Checkbox;
  readonly outlines: Checkbox;
  readonly style: Choice<Style>;
  readonly colouring: Choice<Colouring>;
  private readonly window = field("window");
  private readonly level = field("level");
  private readonly problem = problemLine("window-problem");
  /** Fields for the slices, and for the mesh. */
  readonly ofSlices: HTMLElement[];
  readonly ofMesh: HTMLElement[];

  constructor(private readonly listener: DisplayListener) {
    const slices = (): void => listener.slicesChanged();
    this.tint = checkbox("tint", "Tint the inside", slices);
    this.isoline = checkbox("isoline", "Isoline", slices);
    this.cross = checkbox("cross", "Cross lines", slices);
    this.outlines = checkbox("outlines", "Outlines of the slices", () => listener.meshChanged());
    for (const {input} of [this.tint, this.isoline, this.cross, this.outlines])
      input.checked = true;
    this.style = choice("style", "Shading", STYLES, () => listener.meshChanged());
    this.colouring = choice("colouring", "Colour", COLOURINGS, () => listener.meshChanged());
    for (const input of [this.window, this.level])
      input.addEventListener("change", () => this.typed());
    this.ofSlices = [
      element(
        "div",
        {class: "pairs"},
        element("label", {for: "window"}, "Window"),
        this.window,
        element("label", {for: "level"}, "Level"),
        this.level,
        this.problem,
      ),
      element(
        "div",
        {class: "buttons"},
        button("reset-window", "Reset window and level", () => listener.rangeReset()),
      ),
      element(
        "div",
        {class: "checks"},
        this.isoline.field,
        this.tint.field,
        this.cross.field,
      ),
    ];
    this.ofMesh = [this.style.field, this.colouring.field, this.outlines.field];
  }

  showRange({low, high}: GreyRange): void {
    this.window.value = number(high - low, 6).replaceAll(",", "");
    this.level.value = number((low + high) / 2, 6).replaceAll(",", "");
    this.setProblem("");
  }

  private typed(): void {
    const [window, level] = [this.window, this.level].map(({value}) =>
      value.trim() === "" ? NaN : Number(value.trim().replace("−", "-")),
    );
    if (!(window > 0) || !Number.isFinite(window)) {
      this.setProblem(`Window: expected a number above 0, got “${this.window.value}”.`);
    } else if (!Number.isFinite(level)) {
      this.setProblem(`Level: expected a number, got “${this.level.value}”.`);
    } else {
      this.setProblem("");
      this.listener.rangeTyped({low: level - window / 2, high: level + window / 2});
    }
  }

  private setProblem(text: string): void {
    this.problem.textContent = text;
  }
}

const field = (id: string): HTMLInputElement =>
  element("input", {id, type: "text", inputmode: "decimal", autocomplete: "off"});
