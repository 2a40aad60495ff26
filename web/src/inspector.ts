// SPDX-License-Identifier: Apache-2.0
// What the user points at: coordinates, error and component under the pointer, the selected
// component, and the distance between two points.
import type {Vector3} from "three";

import {measuresText, type ComponentChoice} from "./component_list";
import {button} from "./controls";
import type {Mesh, Triple} from "./data";
import {element, number, plural} from "./dom";
import type {Listener, Point} from "./gestures";
import type {LevelShape} from "./level_shape";
import type {Overlay} from "./overlay";
import {toFile, type Picked, type Scene} from "./scene";

/** What is shown. */
export interface Shown {
  mesh: Mesh;
  shape: LevelShape;
  /** Units of positions and of errors. */
  unit: string;
  errorUnit: string;
  /** The name of the space of the positions, such as LPS; empty: unknown. */
  space: string;
  /** 1, or -1 if outer surfaces face inward. */
  facing: number;
}

export class Inspector implements Listener {
  private readonly readout = element("output", {id: "readout", class: "readout"});
  private readonly selection = element("div", {
    id: "selection",
    class: "selection",
    "aria-live": "polite",
  });
  private readonly status = element("p", {class: "status", id: "status", role: "status"});
  readonly card = element("div", {class: "card"}, this.readout, this.selection, this.status);
  /** Turns measuring on and off. */
  readonly measure = button("measure", "Measure", () => this.setMeasuring(!this.measuring), {
    "aria-pressed": "false",
    title: "The distance between two points of the mesh (m)",
  });
  private measuring = false;
  private pending: Point | null = null;

  /** @param draw draws the overlay again */
  constructor(
    private readonly scene: Scene,
    private readonly overlay: Overlay,
    private readonly choice: ComponentChoice,
    private readonly shown: () => Shown,
    private readonly draw: () => void,
  ) {
    this.setStatus("");
    this.refresh();
  }

  setStatus(text: string): void {
    this.status.textContent = text;
    this.showCard();
  }

  /** Forgets all points, for another mesh. */
  reset(): void {
    this.overlay.points = [];
    this.readout.value = "";
    this.setMeasuring(false);
  }

  // Moves come faster than frames.
  pointedAt(at: Point | null): void {
    const waits = this.pending !== null;
    this.pending = at;
    if (!at) this.showReadout(null);
    if (!at || waits) return;
    requestAnimationFrame(() => {
      if (this.pending) this.showReadout(this.scene.pick(this.pending.x, this.pending.y));
      this.pending = null;
    });
  }

  clicked({x, y}: Point): void {
    const picked = this.scene.pick(x, y);
    if (this.measuring) this.addPoint(picked);
    else this.choice.select(picked?.component ?? null);
    this.showReadout(picked);
  }

  setMeasuring(on: boolean): void {
    this.measuring = on;
    this.measure.setAttribute("aria-pressed", `${on}`);
    this.overlay.points = [];
    if (on) this.choice.select(null);
    this.setStatus(
      on ? "Click two points of the mesh, or move them to the cross and press Enter." : "",
    );
    this.draw();
  }

  get isMeasuring(): boolean {
    return this.measuring;
  }

  /** The measured points in the coordinates of the file, and their distance. */
  get measured(): {points: Triple[]; distance: number | null} {
    const {points} = this.overlay;
    return {
      points: points.map((point) => toFile(point, this.shown().mesh.centre)),
      distance: points.length === 2 ? points[0].distanceTo(points[1]) : null,
    };
  }

  private addPoint(picked: Picked | null): void {
    if (!picked) {
      this.setStatus("There is no mesh at this point.");
      return;
    }
    const {points} = this.overlay;
    this.overlay.points = points.length === 2 ? [picked.point] : [...points, picked.point];
    const {distance} = this.measured;
    const {unit} = this.shown();
    if (distance === null) {
      this.setStatus(`First point ${this.place(picked.point)}. Now the second one.`);
    } else {
      const [from, to] = this.overlay.points;
      this.overlay.distance = `${number(distance, 4)} ${unit}`;
      this.setStatus(
        `Distance ${number(distance, 5)} ${unit}, from ${this.place(from)} to ${this.place(to)}.`,
      );
    }
    this.draw();
  }

  private place(point: Vector3): string {
    return `(${toFile(point, this.shown().mesh.centre)
      .map((v) => number(v, 5))
      .join(", ")})`;
  }

  private showReadout(picked: Picked | null): void {
    this.readout.value = picked ? this.describe(picked) : "";
    this.showCard();
  }

  private describe({point, vertex, component}: Picked): string {
    const {shape, unit, errorUnit, space} = this.shown();
    const parts = [`${this.place(point)} ${unit}${space ? ` ${space}` : ""}`];
    const {distance} = shape.level;
    if (vertex !== null && distance) {
      const error = (distance.steps[vertex] * distance.maximum) / 255;
      parts.push(`error here at most ${number(error)} ${errorUnit}`);
    }
    if (component === null) parts.push("on the cut");
    else if (shape.components().list.length > 1) parts.push(`component ${component + 1}`);
    return parts.join(" · ");
  }

  /** Shows the selected component. */
  refresh(): void {
    const {selected} = this.choice;
    this.selection.replaceChildren();
    this.readout.value = "";
    const list = selected === null ? [] : this.shown().shape.components().list;
    if (selected !== null && selected < list.length) {
      const {shape, unit, facing} = this.shown();
      const {triangles} = list[selected];
      const encloses = shape.encloses(selected);
      const text = measuresText(shape.measures()[selected], encloses, facing, unit);
      const sizes = [
        plural(triangles, "triangle"),
        text.extent,
        `area ${text.area} ${unit}²`,
        encloses ? `volume ${text.volume} ${unit}³` : "not closed",
      ];
      this.selection.append(
        element("p", {}, element("strong", {}, `Component ${selected + 1}`),
          `: ${sizes.join(", ")}`),
        element(
          "div",
          {class: "buttons"},
          button("hide-selected", "Hide", () => this.hideSelected()),
          button("only-selected", "Only this", () => this.isolateSelected()),
          button("end-selection", "Close", () => this.choice.select(null)),
        ),
      );
    }
    this.showCard();
  }

  hideSelected(): void {
    const {selected} = this.choice;
    if (selected === null) return;
    this.choice.selected = null;
    this.choice.show(selected, false);
  }

  isolateSelected(): void {
    const {selected} = this.choice;
    if (selected !== null)
      this.choice.isolate(selected, this.shown().shape.components().list.length);
  }

  private showCard(): void {
    // The status stays in the page, because screen readers follow it.
    const isEmpty = !this.readout.value && this.selection.childElementCount === 0;
    this.card.classList.toggle("bare", isEmpty && !this.status.textContent);
  }
}
