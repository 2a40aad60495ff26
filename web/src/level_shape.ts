// SPDX-License-Identifier: Apache-2.0
// Properties of the triangles of a level that are computed when they are first needed.
import {Vector3} from "three";

import type {AspectRatio, Level} from "./data";
import {componentMeasures, type Measures} from "./measures";
import {aspectFacts, aspectRatios, components, type Components} from "./shape";

export interface Worst {
  triangle: number;
  ratio: number;
  /** Relative to the centre of the mesh. */
  corners: [Vector3, Vector3, Vector3];
  centroid: Vector3;
}

export class LevelShape {
  private knownRatios?: Float32Array;
  private knownAspect?: AspectRatio;
  private knownComponents?: Components;
  private knownMeasures?: Measures[];

  /** @param finest the finest level, whose order of the components all levels use; null: itself */
  constructor(
    readonly level: Level,
    private readonly finest: LevelShape | null = null,
  ) {}

  readonly ratios = (): Float32Array =>
    (this.knownRatios ??= aspectRatios(this.level.positions, this.level.triangles));

  /** A component has the same number in all levels, if they have the same components. */
  readonly components = (): Components => (this.knownComponents ??= this.numberedComponents());

  readonly measures = (): Measures[] =>
    (this.knownMeasures ??= componentMeasures(
      this.level.positions,
      this.level.triangles,
      this.components().of,
      this.components().list.length,
    ));

  /** Whether a component has an inside. */
  encloses(component: number): boolean {
    const {list} = this.components();
    return this.level.facts.manifold !== false && list[component].boundaryLoops === 0;
  }

  componentOf(triangle: number): number {
    return this.components().of[this.level.triangles[3 * triangle]];
  }

  private numberedComponents(): Components {
    const {level, finest} = this;
    const own = components(level.vertices, level.triangles);
    if (!finest) return own;
    const order = sameComponents(level, own, finest.level, finest.components());
    if (!order) return own;
    return {
      of: own.of.map((component) => order[component]),
      list: own.list
        .map((component, i) => ({component, number: order[i]}))
        .sort((a, b) => a.number - b.number)
        .map(({component}) => component),
      loops: own.loops,
    };
  }

  aspect(): AspectRatio {
    const stated = this.level.facts.quality?.aspect_ratio;
    if (stated?.histogram && stated.minimum !== undefined && stated.share_below_third !== undefined)
      return stated as AspectRatio;
    return (this.knownAspect ??= {...aspectFacts(this.ratios()), ...stated});
  }

  isClosed(): boolean {
    const {manifold, boundary_loops: loops} = this.level.facts;
    if (manifold === false) return false;
    return loops == null
      ? this.components().list.every((component) => component.boundaryLoops === 0)
      : loops === 0;
  }

  worst(): Worst | null {
    const {positions, triangles} = this.level;
    const ratios = this.ratios();
    if (ratios.length === 0) return null;
    let triangle = 0;
    for (let t = 1; t < ratios.length; ++t) if (ratios[t] < ratios[triangle]) triangle = t;
    const corner = (k: number): Vector3 =>
      new Vector3().fromArray(positions, 3 * triangles[3 * triangle + k]);
    const corners: Worst["corners"] = [corner(0), corner(1), corner(2)];
    const centroid = corners[0].clone().add(corners[1]).add(corners[2]).divideScalar(3);
    return {triangle, ratio: ratios[triangle], corners, centroid};
  }
}

/**
 * Which components of two levels are the same: those that share a vertex. If the levels number
 * their vertices differently, it is the vertex at the nearest position.
 * @returns per component of `coarse` the number in `fine`; null if they cannot be paired
 */
function sameComponents(
  coarse: Level,
  ofCoarse: Components,
  fine: Level,
  ofFine: Components,
): number[] | null {
  const count = ofCoarse.list.length;
  if (count !== ofFine.list.length) return null;
  const out = new Array<number>(count).fill(-1);
  for (const v of coarse.triangles) {
    const component = ofCoarse.of[v];
    if (out[component] >= 0) continue;
    out[component] = ofFine.of[coarse.nested ? v : nearestVertex(fine, coarse.positions, v)];
  }
  return new Set(out).size === count ? out : null;
}

/** The vertex in a triangle of the level that is nearest to a position. */
function nearestVertex({positions: p, triangles}: Level, of: Float32Array, v: number): number {
  const [x, y, z] = [of[3 * v], of[3 * v + 1], of[3 * v + 2]];
  let nearest = triangles[0];
  let least = Infinity;
  for (const w of triangles) {
    const squared = (p[3 * w] - x) ** 2 + (p[3 * w + 1] - y) ** 2 + (p[3 * w + 2] - z) ** 2;
    if (squared < least) {
      least = squared;
      nearest = w;
    }
  }
  return nearest;
}
