// SPDX-License-Identifier: Apache-2.0
// Fills cuts. For each cut, the stencil buffer counts per pixel how often a line of sight leaves
// the solid beyond the plane of the cut, minus how often it enters it. Where the count is above 0,
// the plane is inside the solid and is drawn.
import {
  AlwaysStencilFunc,
  BackSide,
  BufferAttribute,
  BufferGeometry,
  DecrementStencilOp,
  DoubleSide,
  FrontSide,
  GLSL3,
  IncrementStencilOp,
  KeepStencilOp,
  LessStencilFunc,
  Mesh as Solid,
  RawShaderMaterial,
  Scene as World,
  Vector3,
  type OrthographicCamera,
  type Side,
  type WebGLRenderer,
} from "three";

import {CAP_FRAGMENT, CAP_VERTEX, countFragment, countVertex} from "./shaders";

/** The count 0 in the stencil buffer, so that counts below 0 are possible. */
const ZERO = 128;

/** The planes of the cuts, one per axis. */
export interface Planes {
  at: Vector3;
  /** 1: the side below is kept; -1: the side above; 0: no cut. */
  side: Vector3;
}

export class Caps {
  /** Vector3 of the colour, as sRGB. */
  readonly colour = {value: new Vector3()};
  private readonly axis = {value: new Vector3()};
  private readonly planes: {cutAt: {value: Vector3}; cutSide: {value: Vector3}};
  private readonly counted = new World();
  private readonly drawn = new World();
  private readonly solids: Solid<BufferGeometry, RawShaderMaterial>[] = [];
  private readonly closings: Solid<BufferGeometry, RawShaderMaterial>[] = [];
  private readonly quad: Solid<BufferGeometry, RawShaderMaterial>;

  constructor({at, side}: Planes) {
    this.planes = {cutAt: {value: at}, cutSide: {value: side}};
    for (const facing of [FrontSide, BackSide] as const) {
      // The triangles that close a flat end overlap. At the centre of a pixel, all of them are on
      // the same side of a cut.
      for (const [list, place] of [[this.solids, "centroid"], [this.closings, ""]] as const) {
        const solid = new Solid(new BufferGeometry(), this.counting(facing, place));
        solid.frustumCulled = false;
        this.counted.add(solid);
        list.push(solid);
      }
    }
    const corners = new BufferGeometry();
    corners.setAttribute("position", new BufferAttribute(new Float32Array(12), 3));
    corners.setIndex([0, 1, 2, 2, 1, 3]);
    this.quad = new Solid(
      corners,
      new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: CAP_VERTEX,
        fragmentShader: CAP_FRAGMENT,
        side: DoubleSide,
        uniforms: {...this.planes, axis: this.axis, cap: this.colour},
        stencilWrite: true,
        stencilRef: ZERO,
        stencilFunc: LessStencilFunc,
        stencilZPass: KeepStencilOp,
      }),
    );
    this.quad.frustumCulled = false;
    this.drawn.add(this.quad);
  }

  private counting(side: Side, place: string): RawShaderMaterial {
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: countVertex(place),
      fragmentShader: countFragment(place),
      side,
      uniforms: {...this.planes, axis: this.axis},
      colorWrite: false,
      depthWrite: false,
      depthTest: false,
      stencilWrite: true,
      stencilFunc: AlwaysStencilFunc,
    });
  }

  /**
   * Draws the filled cuts, after the surface.
   * @param surface the triangles of the shown components that bound a solid
   * @param closing triangles that close their open ends; without an index
   * @param facesInward whether the triangles of outer surfaces face inward
   * @param half half the size of the bounding box of the mesh, whose centre is 0
   */
  draw(
    renderer: WebGLRenderer,
    camera: OrthographicCamera,
    surface: BufferGeometry,
    closing: BufferGeometry,
    facesInward: boolean,
    half: readonly number[],
  ): void {
    for (const solid of this.solids) solid.geometry = surface;
    for (const solid of this.closings) solid.geometry = closing;
    const towards = new Vector3(0, 0, 1).applyQuaternion(camera.quaternion);
    const cleared = renderer.state.buffers.stencil;
    for (let axis = 0; axis < 3; ++axis) {
      const side = this.planes.cutSide.value.getComponent(axis);
      if (side === 0) continue;
      this.axis.value.set(0, 0, 0).setComponent(axis, 1);
      // Seen from the side that is kept, the count is that of the lines before the plane.
      const seenFromCut = towards.getComponent(axis) * side > 0;
      this.countExits(facesInward !== seenFromCut);
      cleared.setClear(ZERO);
      renderer.clearStencil();
      renderer.render(this.counted, camera);
      this.placeQuad(axis, half);
      renderer.render(this.drawn, camera);
    }
    cleared.setClear(0);
  }

  /** @param ofBackFaces whether the back faces are the exits */
  private countExits(ofBackFaces: boolean): void {
    for (const list of [this.solids, this.closings]) {
      list.forEach(({material}, i) => {
        const isExit = (i === 1) === ofBackFaces;
        material.stencilZPass = isExit ? IncrementStencilOp : DecrementStencilOp;
      });
    }
  }

  private placeQuad(axis: number, half: readonly number[]): void {
    const corners = this.quad.geometry.getAttribute("position") as BufferAttribute;
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    for (let corner = 0; corner < 4; ++corner) {
      const at = new Vector3().setComponent(axis, this.planes.cutAt.value.getComponent(axis));
      at.setComponent(u, (corner % 2 === 0 ? -1.05 : 1.05) * half[u]);
      at.setComponent(v, (corner < 2 ? -1.05 : 1.05) * half[v]);
      corners.setXYZ(corner, at.x, at.y, at.z);
    }
    corners.needsUpdate = true;
  }
}

/**
 * Triangles that close the open ends of a surface: a fan from the centroid of each boundary loop,
 * facing like the surface. A flat end, such as that at a side of the volume, is closed exactly.
 * @param loops vertices in the order of the triangles' sides
 * @returns 9 numbers per triangle
 */
export function closingFans(positions: Float32Array, loops: number[][]): Float32Array {
  const out = new Float32Array(9 * loops.reduce((sum, loop) => sum + loop.length, 0));
  let end = 0;
  for (const loop of loops) {
    const centroid = [0, 0, 0];
    for (const v of loop)
      for (let axis = 0; axis < 3; ++axis)
        centroid[axis] += positions[3 * v + axis] / loop.length;
    loop.forEach((v, i) => {
      const next = loop[(i + 1) % loop.length];
      out.set(positions.subarray(3 * next, 3 * next + 3), end);
      out.set(positions.subarray(3 * v, 3 * v + 3), end + 3);
      out.set(centroid, end + 6);
      end += 9;
    });
  }
  return out;
}
