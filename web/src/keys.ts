// SPDX-License-Identifier: Apache-2.0
// The keyboard in the picture.
import {Vector3} from "three";

import type {Camera} from "./camera";

/** What keys do, apart from moving the camera. A page can leave some out. */
export interface KeyTarget {
  reset: () => void;
  step: (levels: number) => void;
  showWorst: () => void;
  lookFromSide: (side: number) => void;
  clickCentre: () => void;
  toggleMeasuring: () => void;
  end: () => void;
  hideSelected: () => void;
  isolateSelected: () => void;
  showAll: () => void;
  toggleFullScreen: () => void;
  savePicture: () => void;
}

/** Actions of mouse, touch and keyboard, for the help. */
export const HELP = [
  ["Rotate", "drag, or arrow keys"],
  ["Pan", "right button, two fingers, or Shift and drag or arrows"],
  ["Zoom", "wheel, pinch, or + and −"],
  ["Level", "[ and ]"],
  ["View from a side", "1 to 6, in the order of the buttons"],
  ["Along an axis", "x, y, z"],
  [
    "Component",
    "click it, or move it to the cross and press Enter; h hides it, i the others, a shows all",
  ],
  ["Measure", "m, then click two points, or move them to the cross and press Enter; Esc ends"],
  ["Worst triangle, whole mesh", "w, 0"],
  ["Full screen, save the picture", "f, p"],
];

const SIDES = ["1", "2", "3", "4", "5", "6"];

/** What a key does; undefined: nothing. */
export function keyAction(
  {key, shiftKey}: KeyboardEvent,
  camera: Camera,
  target: Partial<KeyTarget>,
): (() => void) | undefined {
  const arrow = (right: number, down: number) => (): void =>
    shiftKey ? camera.pan(30 * right, 30 * down) : camera.rotate(24 * right, 24 * down);
  const along = (axis: number) => (): void =>
    camera.lookFrom(new Vector3().setComponent(axis, axis === 1 ? -1 : 1));
  const {step, lookFromSide} = target;
  const actions: Record<string, (() => void) | undefined> = {
    ArrowLeft: arrow(-1, 0),
    ArrowRight: arrow(1, 0),
    ArrowUp: arrow(0, -1),
    ArrowDown: arrow(0, 1),
    "+": () => camera.zoomAt(1.2),
    "=": () => camera.zoomAt(1.2),
    "-": () => camera.zoomAt(1 / 1.2),
    "0": target.reset,
    Home: target.reset,
    "[": step && (() => step(-1)),
    "]": step && (() => step(1)),
    w: target.showWorst,
    x: along(0),
    y: along(1),
    z: along(2),
    ...Object.fromEntries(
      SIDES.map((key, side) => [key, lookFromSide && (() => lookFromSide(side))]),
    ),
    Enter: target.clickCentre,
    m: target.toggleMeasuring,
    Escape: target.end,
    h: target.hideSelected,
    i: target.isolateSelected,
    a: target.showAll,
    f: target.toggleFullScreen,
    p: target.savePicture,
  };
  return actions[key];
}
