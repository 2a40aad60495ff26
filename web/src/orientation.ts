// SPDX-License-Identifier: Apache-2.0
// Names of directions: those of a patient if the volume is in a patient's space, else of axes.
import type {Result, Triple} from "./data";

/** A side of the mesh that faces the viewer. */
export interface Side {
  name: string;
  /** The end of an axis at this side: "A", or "−y". */
  end: string;
  /** From the mesh to the viewer. */
  from: Triple;
  up: Triple;
}

export interface Orientation {
  anatomical: boolean;
  /** The ends of the axes. */
  ends: {text: string; direction: Triple}[];
  sides: Side[];
}

/** The ends of the axes of LPS: left, right, posterior, anterior, superior, inferior. */
const LPS = [
  {letter: "L", axis: 0, sign: 1},
  {letter: "R", axis: 0, sign: -1},
  {letter: "P", axis: 1, sign: 1},
  {letter: "A", axis: 1, sign: -1},
  {letter: "S", axis: 2, sign: 1},
  {letter: "I", axis: 2, sign: -1},
];
/** The sides as in `isoatlas picture --view`, by the letters of their ends. */
const SIDES = [
  ["Front", "A"],
  ["Back", "P"],
  ["Left", "L"],
  ["Right", "R"],
  ["Top", "S"],
  ["Bottom", "I"],
] as const;
const AXES = ["x", "y", "z"];

/**
 * Whether the world coordinates of the volume are those of a patient.
 * @param input as in a report
 */
export function isPatientSpace(input: Record<string, unknown>): boolean {
  const stated = Array.isArray(input.decisions) ? input.decisions : [];
  const decision = (key: string): string => {
    const found = stated.find((one: {key?: unknown}) => one?.key === key) as
      | {value?: unknown}
      | undefined;
    return typeof found?.value === "string" ? found.value : "";
  };
  const format = typeof input.format === "string" ? input.format : "";
  if (/DICOM/.test(format)) return true;
  if (format === "NRRD")
    return /^(right|left)-(anterior|posterior)-superior|^(ras|las|lps)t?$/i.test(decision("space"));
  if (format === "MetaImage") return /AnatomicalOrientation/.test(decision("unit"));
  if (/^NIfTI|^Analyze/.test(format)) return /form/.test(decision("affine"));
  return format === "MGH" && decision("affine") !== "none";
}

/** The orientation of the coordinates of a mesh. */
export function orientationOf({input, parameters}: Result): Orientation {
  const space = parameters?.space;
  const anatomical = (space === "lps" || space === "ras") && isPatientSpace(input ?? {});
  return orientationIn(space === "ras" ? "ras" : "lps", anatomical);
}

export function orientationIn(space: "lps" | "ras", anatomical: boolean): Orientation {
  const turned = space === "ras" ? -1 : 1;  // x and y of RAS are those of LPS, negated
  const ends = LPS.map(({letter, axis, sign}) => {
    const towards = axis < 2 ? turned * sign : sign;
    const direction: Triple = [0, 0, 0];
    direction[axis] = towards;
    return {letter, text: `${towards > 0 ? "+" : "−"}${AXES[axis]}`, direction};
  });
  const front = ends.find(({letter}) => letter === "A")!.direction;
  return {
    anatomical,
    ends: anatomical
      ? ends.map(({letter, direction}) => ({text: letter, direction}))
      : AXES.map((text, axis) => ({text, direction: unit(axis)})),
    sides: SIDES.map(([name, letter]) => {
      const {text, direction} = ends.find((end) => end.letter === letter)!;
      return {
        name,
        end: anatomical ? letter : text,
        from: direction,
        up: direction[2] === 0 ? [0, 0, 1] : front,
      };
    }),
  };
}

function unit(axis: number): Triple {
  const out: Triple = [0, 0, 0];
  out[axis] = 1;
  return out;
}
