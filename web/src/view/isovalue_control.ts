// SPDX-License-Identifier: Apache-2.0
// The histogram with the isovalue as a handle, a field for its number, suggested values, and which
// side is inside.
import {button, choice, problemLine} from "../controls";
import {count, drawn, element, number, percent} from "../dom";
import type {InsideRule} from "./isoline";
import {ends, parseIsovalue, shareBelow, snapped, stepOf, ticks} from "./isovalue";
import type {Side, Volume} from "./server";

type Height = "log" | "root";

const SIDES: {value: Side; text: string}[] = [
  {value: "above", text: "Above"},
  {value: "below", text: "Below"},
];
const HEIGHTS: {value: Height; text: string}[] = [
  {value: "log", text: "Logarithm"},
  {value: "root", text: "Square root"},
];

/**
 * Whether a number is being typed, or the handle moves, or the isovalue is settled, or what was
 * typed cannot be used.
 */
export type Change = "typed" | "moved" | "settled" | "refused";

export class IsovalueControl {
  value: number;
  private readonly bars = [drawn("path"), drawn("path")];
  private readonly insideBars: SVGElement;
  private readonly handle = element("div", {
    id: "handle",
    class: "handle",
    role: "slider",
    tabindex: "0",
    "aria-label": "Isovalue",
    "aria-orientation": "horizontal",
  }, element("span", {class: "grip"}));
  private readonly field = element("input", {
    id: "isovalue",
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    "aria-describedby": "isovalue-problem isovalue-share",
  });
  private readonly problem = problemLine("isovalue-problem");
  private readonly share = element("output", {
    id: "isovalue-share",
    class: "soft",
    for: "isovalue",
    "aria-live": "off",
  });
  private readonly chart = element("div", {class: "distribution", id: "histogram"});
  private readonly side = choice<Side>("inside", "Inside is", SIDES, () => this.sideChanged());
  private readonly nanSide = choice<Side>("nan", "", SIDES, () => {
    this.isNanChosen = true;
    this.changed("settled");
  });
  private readonly height = choice<Height>("height", "Height of the histogram", HEIGHTS, () =>
    this.drawBars(),
  );
  private isNanChosen = false;
  /** The histogram, the handle and the number. */
  readonly strip: HTMLElement;
  /** Everything else. */
  readonly settings: HTMLElement;

  constructor(
    private readonly volume: Volume,
    private readonly changed: (how: Change) => void,
  ) {
    this.value = volume.isovalue;
    const picture = (bars: SVGElement, name: string): SVGElement =>
      drawn(
        "svg",
        {viewBox: "0 0 100 100", preserveAspectRatio: "none", "aria-hidden": "true", class: name},
        bars,
      );
    this.insideBars = picture(this.bars[1], "bars inside-bars");
    this.chart.append(
      element("div", {class: "plot"}, picture(this.bars[0], "bars"), this.insideBars,
        ...this.suggestionMarks(), this.handle),
      this.scale(),
    );
    this.strip = element(
      "section",
      {class: "isovalue", "aria-label": "Isovalue"},
      element(
        "div",
        {class: "isovalue-line"},
        element("label", {for: "isovalue"}, "Isovalue"),
        this.field,
        this.share,
        this.problem,
      ),
      this.chart,
    );
    this.settings = element("div", {class: "controls"}, ...this.suggestions(), this.side.field);
    if (volume.not_finite > 0) this.settings.append(this.nanField());
    this.settings.append(this.height.field);
    this.side.set(volume.inside);
    this.setNanOutside();
    this.listen();
    this.drawBars();
    this.show();
  }

  get inside(): Side {
    return this.side.value();
  }

  /** The side of samples that are not finite; null if there are no such samples. */
  get nan(): Side | null {
    return this.volume.not_finite > 0 ? this.nanSide.value() : null;
  }

  get rule(): InsideRule {
    const {minimum, maximum} = this.volume;
    const offset = Math.max(Math.abs(maximum - this.value), Math.abs(minimum - this.value), 1e-300);
    return {isovalue: this.value, inside: this.inside, nan: this.nanSide.value(), offset};
  }

  /** Whether the field has the isovalue; if not, the isovalue is the last valid one. */
  get isValid(): boolean {
    return this.problem.textContent === "";
  }

  /** Shows why what was typed is no isovalue. */
  private setProblem(text: string): void {
    if (this.problem.textContent !== text) this.problem.textContent = text;
    this.field.setAttribute("aria-invalid", `${text !== ""}`);
  }

  focus(): void {
    this.handle.focus();
  }

  set(value: number, how: Change): void {
    this.value = value;
    this.field.value = `${value}`;
    this.setProblem("");
    this.show();
    this.changed(how);
  }

  private listen(): void {
    this.field.addEventListener("input", () => this.typed("typed"));
    this.field.addEventListener("change", () => this.typed("settled"));
    // Also if the text has not changed: the mesh may have been cancelled.
    this.field.addEventListener("keydown", ({key}) => {
      if (key === "Enter") this.typed("settled");
    });
    let isMoving = false;  // by a key that is pressed
    this.handle.addEventListener("keydown", (event) => {
      const to = this.keyValue(event);
      if (to === null || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      isMoving = true;
      this.set(to, "moved");
    });
    this.handle.addEventListener("keyup", () => {
      if (isMoving) this.changed("settled");
      isMoving = false;
    });
    const {chart} = this;
    let pointer: number | null = null;
    chart.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || pointer !== null) return;
      pointer = event.pointerId;
      chart.setPointerCapture(pointer);
      event.preventDefault();
      this.handle.focus({preventScroll: true});
      this.set(this.valueAt(event.clientX), "moved");
    });
    chart.addEventListener("pointermove", (event) => {
      if (event.pointerId === pointer) this.set(this.valueAt(event.clientX), "moved");
    });
    const up = (event: PointerEvent): void => {
      if (event.pointerId !== pointer) return;
      pointer = null;
      this.changed("settled");
    };
    chart.addEventListener("pointerup", up);
    chart.addEventListener("pointercancel", up);
  }

  private typed(how: Change): void {
    const parsed = parseIsovalue(this.field.value, this.volume);
    if ("problem" in parsed) {
      this.setProblem(parsed.problem);
      this.changed("refused");
      return;
    }
    this.setProblem("");
    this.value = parsed.value;
    this.show();
    this.changed(how);
  }

  private keyValue({key, shiftKey}: KeyboardEvent): number | null {
    const step = stepOf(this.volume) * (shiftKey ? 10 : 1);
    const [from, to] = ends(this.volume);
    const page = Math.max(10, Math.round((to - from) / 40 / step)) * step;
    const by: Record<string, number> = {
      ArrowRight: step,
      ArrowUp: step,
      ArrowLeft: -step,
      ArrowDown: -step,
      PageUp: page,
      PageDown: -page,
      Home: -Infinity,
      End: Infinity,
    };
    if (!(key in by)) return null;
    const next = Math.min(Math.max(this.value + by[key], this.volume.minimum), this.volume.maximum);
    return snapped(next, stepOf(this.volume), this.volume);
  }

  private valueAt(clientX: number): number {
    const {left, width} = this.chart.getBoundingClientRect();
    const [from, to] = ends(this.volume);
    const share = Math.min(Math.max((clientX - left) / width, 0), 1);
    const perPixel = (to - from) / Math.max(width, 1);
    return snapped(from + share * (to - from), 10 ** Math.floor(Math.log10(perPixel)), this.volume);
  }

  private shareOf(value: number): number {
    const [from, to] = ends(this.volume);
    return (value - from) / (to - from);
  }

  private sideChanged(): void {
    if (!this.isNanChosen) this.setNanOutside();
    this.show();
    this.changed("settled");
  }

  private setNanOutside(): void {
    this.nanSide.set(this.inside === "above" ? "below" : "above");
  }

  private show(): void {
    const at = this.shareOf(this.value);
    const text = `${this.value}`;
    const {minimum, maximum} = this.volume;
    this.handle.style.left = `${100 * Math.min(Math.max(at, 0), 1)}%`;
    this.handle.setAttribute("aria-valuemin", `${minimum}`);
    this.handle.setAttribute("aria-valuemax", `${maximum}`);
    this.handle.setAttribute("aria-valuenow", text);
    this.handle.setAttribute("aria-valuetext", text);
    if (document.activeElement !== this.field && this.isValid) this.field.value = text;
    const [left, right] = this.inside === "above" ? [at, 0] : [0, 1 - at];
    this.insideBars.style.clipPath = `inset(0 ${100 * right}% 0 ${100 * left}%)`;
    const below = shareBelow(this.value, this.volume);
    this.share.value =
      `about ${percent(this.inside === "above" ? 1 - below : below)} of the samples are inside`;
  }

  private drawBars(): void {
    const {counts} = this.volume.histogram;
    const height = (n: number): number =>
      this.height.value() === "log" ? Math.log1p(n) : Math.sqrt(n);
    const top = Math.max(...counts.map(height), 1e-9);
    let path = "M0 100";
    counts.forEach((n, bin) => {
      const y = n > 0 ? 98 - (96 * height(n)) / top : 100;
      path += `V${y.toFixed(2)}H${((100 * (bin + 1)) / counts.length).toFixed(3)}`;
    });
    for (const bars of this.bars) bars.setAttribute("d", `${path}V100Z`);
  }

  private scale(): HTMLElement {
    const marks = ticks(ends(this.volume), 8)
      .map((value) => ({value, at: this.shareOf(value)}))
      .filter(({at}) => at > 0.02 && at < 0.98)
      .map(({value, at}) => {
        const tick = element("span", {}, number(value, 6).replace("-", "−"));
        tick.style.left = `${100 * at}%`;
        return tick;
      });
    return element("div", {class: "marks", "aria-hidden": "true"}, ...marks);
  }

  private suggestionMarks(): HTMLElement[] {
    return this.volume.suggested.map(({isovalue}) => {
      const mark = element("span", {class: "suggested"});
      mark.style.left = `${100 * this.shareOf(isovalue)}%`;
      return mark;
    });
  }

  private suggestions(): HTMLElement[] {
    const {suggested} = this.volume;
    if (suggested.length === 0) return [];
    const rows = suggested.map(({isovalue, reason}, i) =>
      element(
        "li",
        {},
        button(`suggested-${i + 1}`, `${isovalue}`, () => this.set(isovalue, "settled"), {
          class: "small",
        }),
        element("span", {class: "soft"}, reason),
      ),
    );
    return [
      element(
        "fieldset",
        {},
        element("legend", {}, "Suggested"),
        element("ul", {class: "suggestions"}, ...rows),
      ),
    ];
  }

  private nanField(): HTMLElement {
    const {field} = this.nanSide;
    field.querySelector("legend")!.textContent = "NaN samples count as";
    field.append(
      element(
        "p",
        {class: "soft note"},
        element("span", {class: "swatch not-finite"}),
        `${count(this.volume.not_finite)} samples are NaN or infinite. Infinite ones are on the ` +
          "side of their sign.",
      ),
    );
    return field;
  }
}
