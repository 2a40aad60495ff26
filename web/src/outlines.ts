// SPDX-License-Identifier: Apache-2.0
// Closed lines in the scene, hidden where they are behind the mesh.
import {BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments} from "three";
import type {Vector3} from "three";

export interface Outline {
  /** Relative to the centre of the mesh. */
  points: Vector3[];
  /** As in a style sheet. */
  colour: string;
}

export class Outlines {
  readonly lines = new LineSegments(
    new BufferGeometry(),
    new LineBasicMaterial({vertexColors: true}),
  );
  /** The largest distance from the centre of the mesh. */
  reach = 0;

  constructor() {
    this.lines.frustumCulled = false;
  }

  set(outlines: Outline[]): void {
    const positions: number[] = [];
    const colours: number[] = [];
    this.reach = 0;
    for (const {points, colour} of outlines) {
      this.lines.material.color.set(colour);
      const rgb = this.lines.material.color.toArray();
      points.forEach((point, i) => {
        for (const end of [point, points[(i + 1) % points.length]]) {
          positions.push(...end.toArray());
          colours.push(...rgb);
        }
        this.reach = Math.max(this.reach, point.length());
      });
    }
    this.lines.material.color.set("white");  // it is multiplied by the colours of the vertices
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    const attribute = (of: number[]): BufferAttribute =>
      new BufferAttribute(Float32Array.from(of), 3);
    this.lines.geometry.setAttribute("position", attribute(positions));
    this.lines.geometry.setAttribute("color", attribute(colours));
  }
}
