// SPDX-License-Identifier: Apache-2.0
// The samples of a volume in space: world coordinates, and how slices lie on the screen.
import type {Triple} from "../data";
import {isPatientSpace} from "../orientation";
import type {Volume} from "./server";

export const AXES = ["x", "y", "z"] as const;

/** A direction of the screen: along which axis of the volume, and 1 or -1. */
export interface Way {
  axis: number;
  sign: 1 | -1;
}

/** How slices across an axis lie on the screen. */
export interface Plane {
  /** The axis across which the slices are. */
  axis: number;
  right: Way;
  down: Way;
  /** Axial, coronal or sagittal; "" if the volume is not of a patient. */
  name: string;
  /** What is at the left, right, top and bottom of the picture: R, L, A, P or −x, +x, ... */
  ends: {left: string; right: string; top: string; bottom: string};
}

const LETTERS = [
  ["R", "L"],
  ["A", "P"],
  ["I", "S"],
];
const NAMES = ["Sagittal", "Coronal", "Axial"];

export class Grid {
  readonly size: Triple;
  readonly spacing: Triple;
  readonly unit: string;
  readonly anatomical: boolean;
  private readonly matrix: Volume["index_to_world"];

  constructor(volume: Volume) {
    this.size = volume.size;
    this.spacing = volume.spacing;
    this.unit = volume.unit;
    this.matrix = volume.index_to_world;
    this.anatomical = volume.anatomical ?? isPatientSpace(volume.input ?? {});
  }

  /** " mm", or nothing if the volume states no unit. */
  get unitText(): string {
    return this.unit ? ` ${this.unit}` : "";
  }

  world([i, j, k]: Triple): Triple {
    return this.matrix.map(([a, b, c, t]) => a * i + b * j + c * k + t) as Triple;
  }

  /** The unit vector of an axis in world coordinates. */
  private direction(axis: number): Triple {
    const column = this.matrix.map((row) => row[axis]);
    const length = Math.hypot(...column) || 1;
    return column.map((v) => v / length) as Triple;
  }

  /** The world axis that is nearest to each axis of the volume; all differ. */
  private nearestWorldAxes(): Triple {
    let best: Triple = [0, 1, 2];
    let most = -1;
    for (const order of ORDERS) {
      const sum = order.reduce((s, w, axis) => s + Math.abs(this.direction(axis)[w]), 0);
      if (sum > most + 1e-9) [most, best] = [sum, order];
    }
    return best;
  }

  /** As radiologists see slices: the patient's right is left, anterior or superior is up. */
  plane(axis: number): Plane {
    const [first, second] = [0, 1, 2].filter((other) => other !== axis);
    const world = this.nearestWorldAxes();
    if (!this.anatomical) {
      // As in pictures, rows go down; slices along z are stacked upward.
      const right: Way = {axis: first, sign: 1};
      const down: Way = {axis: second, sign: second === 2 ? -1 : 1};
      return {axis, right, down, name: "", ends: this.ends(right, down)};
    }
    const [across, along] = world[first] < world[second] ? [first, second] : [second, first];
    const towards = (of: number): 1 | -1 => (this.direction(of)[world[of]] >= 0 ? 1 : -1);
    const upward = world[along] === 2 ? -1 : 1;  // S is up; A, at -y, is up, too
    const right: Way = {axis: across, sign: towards(across)};
    const down: Way = {axis: along, sign: (towards(along) * upward) as 1 | -1};
    return {axis, right, down, name: NAMES[world[axis]], ends: this.ends(right, down)};
  }

  private ends(right: Way, down: Way): Plane["ends"] {
    return {
      left: this.endOf(right, -1),
      right: this.endOf(right, 1),
      top: this.endOf(down, -1),
      bottom: this.endOf(down, 1),
    };
  }

  private endOf({axis, sign}: Way, side: 1 | -1): string {
    const towards = sign * side;
    if (!this.anatomical) return `${towards > 0 ? "+" : "−"}${AXES[axis]}`;
    // As in DICOM, an oblique direction has several letters, the main one first.
    return this.direction(axis)
      .map((v, world) => ({size: Math.abs(v), letter: LETTERS[world][v * towards > 0 ? 1 : 0]}))
      .sort((a, b) => b.size - a.size)
      .filter(({size}, i) => i === 0 || size > 0.38)
      .map(({letter}) => letter)
      .join("");
  }
}

const ORDERS: Triple[] = [
  [0, 1, 2],
  [0, 2, 1],
  [1, 0, 2],
  [1, 2, 0],
  [2, 0, 1],
  [2, 1, 0],
];
