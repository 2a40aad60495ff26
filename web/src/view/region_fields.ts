// SPDX-License-Identifier: Apache-2.0
// Six number fields for the region of interest, and a button to draw it in the slices.
import {button, problemLine} from "../controls";
import {element} from "../dom";
import {AXES} from "./grid";
import type {Ends, Region} from "./region";

export class RegionFields {
  readonly section: HTMLElement;
  private readonly inputs: [HTMLInputElement, HTMLInputElement][];
  private readonly problem = problemLine("region-problem");
  private readonly problems = ["", "", ""];  // per axis
  private readonly edit = button(
    "edit-region",
    "Drag its edges",
    () => this.setEdited(!this.edited),
    {"aria-pressed": "false", title: "Show edges in the slices that can be dragged"},
  );
  private readonly whole = button("whole-volume", "Whole volume", () => {
    // Before this button is disabled.
    if (document.activeElement === this.whole) this.edit.focus();
    this.region.reset();
    this.show();
    this.changed(true);
  });

  /**
   * @param changed gets whether the region has another extent; if not, a field became invalid
   * @param editedChanged called when its edges can, or can no longer, be dragged
   */
  constructor(
    private readonly region: Region,
    size: readonly number[],
    private readonly changed: (extent: boolean) => void,
    private readonly editedChanged: () => void,
  ) {
    this.inputs = AXES.map((letter, axis) => {
      const field = (name: string): HTMLInputElement => {
        const input = element("input", {
          id: `region-${letter}-${name}`,
          type: "text",
          inputmode: "numeric",
          autocomplete: "off",
          "aria-label": `${name === "first" ? "First" : "Last"} sample along ${letter}`,
        });
        input.addEventListener("change", () => this.typed(axis));
        return input;
      };
      return [field("first"), field("last")];
    });
    const rows = AXES.map((letter, axis) =>
      element(
        "div",
        {class: "region-row"},
        element("span", {}, letter),
        this.inputs[axis][0],
        element("span", {class: "soft"}, "to"),
        this.inputs[axis][1],
        element("span", {class: "soft"}, `of 0 to ${size[axis] - 1}`),
      ),
    );
    this.section = element(
      "div",
      {class: "controls"},
      element("div", {}, ...rows),
      this.problem,
      element("div", {class: "buttons"}, this.edit, this.whole),
    );
    this.show();
  }

  get edited(): boolean {
    return this.edit.getAttribute("aria-pressed") === "true";
  }

  /** Whether all fields can be used; if not, the region has their last valid values. */
  get isValid(): boolean {
    return this.problems.every((problem) => problem === "");
  }

  private setEdited(edited: boolean): void {
    this.edit.setAttribute("aria-pressed", `${edited}`);
    this.editedChanged();
  }

  show(): void {
    this.region.ends.forEach((ends, axis) =>
      this.inputs[axis].forEach((input, end) => {
        input.value = `${ends[end]}`;
        input.setAttribute("aria-invalid", "false");
      }),
    );
    this.problems.fill("");
    this.update();
  }

  private update(): void {
    this.whole.disabled = this.region.isWhole && this.isValid;
    this.problem.textContent = this.problems
      .map((problem, axis) => problem && `${AXES[axis]}: ${problem}`)
      .filter(Boolean)
      .join(" ");
  }

  private typed(axis: number): void {
    const ends = this.inputs[axis].map(({value}) =>
      /^\s*\d+\s*$/.test(value) ? Number(value) : NaN,
    ) as Ends;
    const problem = this.region.problem(axis, ends);
    for (const input of this.inputs[axis]) input.setAttribute("aria-invalid", `${problem !== ""}`);
    this.problems[axis] = problem;
    if (!problem) this.region.set(axis, ends);
    this.update();
    this.changed(!problem);
  }
}
