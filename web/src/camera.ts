// SPDX-License-Identifier: Apache-2.0
// The camera: a parallel projection, so that lengths can be read off, with any rotation, because
// volumes have no upward direction.
import {Matrix4, OrthographicCamera, Quaternion, Vector3} from "three";

export interface Pose {
  /** The point at the centre of the picture. */
  target: Vector3;
  /** Rotation of the camera: x is right, y is up, z points to the viewer. */
  rotation: Quaternion;
  /** 1: the whole mesh fits into the picture. */
  zoom: number;
}

const UP = new Vector3(0, 0, 1);
const X = new Vector3(1, 0, 0);
const Y = new Vector3(0, 1, 0);
const Z = new Vector3(0, 0, 1);
const MARGIN = 0.88;

/**
 * The rotation of a camera.
 * @param from the direction from the target to the viewer
 * @param up what is up in the picture; by default z, or y if the view is along z
 */
export function rotationFrom(from: Vector3, up?: Vector3): Quaternion {
  up ??= Math.abs(from.clone().normalize().dot(UP)) > 0.999 ? Y : UP;
  return new Quaternion().setFromRotationMatrix(new Matrix4().lookAt(from, new Vector3(), up));
}

export class Camera {
  readonly three = new OrthographicCamera();
  readonly pose: Pose = {target: new Vector3(), rotation: new Quaternion(), zoom: 1};
  moving = false;
  private home: Pose = {target: new Vector3(), rotation: new Quaternion(), zoom: 1};
  /** What fits into the picture when it is seen from a side. */
  framed: Float32Array = new Float32Array();
  /** Half the size of the mesh in the home view; zoom 1 shows all of it. */
  private extent: [number, number] = [1, 1];
  private radius = 1;
  private reach = 0;
  private width = 1;
  private height = 1;

  constructor(private readonly changed: () => void) {}

  /** Sets the home view and shows it. @param positions of the mesh, around 0 */
  setHome(positions: Float32Array): void {
    this.frame(positions);
    this.set(this.home);
  }

  /**
   * Sets the home view of another mesh. The picture stays as it is, apart from the mesh.
   * @param moved the old origin of positions relative to the new one
   */
  changeHome(positions: Float32Array, moved: Vector3): void {
    const before = this.scale;
    this.frame(positions);
    this.pose.zoom *= before / this.scale;
    this.pose.target.add(moved);
    this.stop();
  }

  private frame(positions: Float32Array): void {
    this.framed = positions;
    let farthest = 0;
    for (let i = 0; i < positions.length; i += 3) {
      const [x, y, z] = [positions[i], positions[i + 1], positions[i + 2]];
      farthest = Math.max(farthest, x * x + y * y + z * z);
    }
    this.radius = Math.sqrt(farthest) || 1;
    const rotation = rotationFrom(new Vector3(0.5, -1, 0.38));
    const {target, extent} = this.outline(rotation);
    this.extent = extent;
    this.home = {target, rotation, zoom: 1};
  }

  /** The outline of what is framed in a view: half its size, and its centre. */
  private outline(rotation: Quaternion): {target: Vector3; extent: [number, number]} {
    const positions = this.framed;
    const right = X.clone().applyQuaternion(rotation);
    const up = Y.clone().applyQuaternion(rotation);
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    for (let i = 0; i < positions.length; i += 3) {
      const [x, y, z] = [positions[i], positions[i + 1], positions[i + 2]];
      const h = x * right.x + y * right.y + z * right.z;
      const v = x * up.x + y * up.y + z * up.z;
      if (h < low[0]) low[0] = h;
      if (h > high[0]) high[0] = h;
      if (v < low[1]) low[1] = v;
      if (v > high[1]) high[1] = v;
    }
    if (positions.length === 0) low.fill(-1), high.fill(1);
    const least = 1e-6 * this.radius;
    return {
      target: right
        .multiplyScalar((low[0] + high[0]) / 2)
        .addScaledVector(up, (low[1] + high[1]) / 2),
      extent: [
        Math.max(high[0] - low[0], least) / 2,
        Math.max(high[1] - low[1], least) / 2,
      ],
    };
  }

  /** @param reach the largest distance from the origin of what is drawn in addition to the mesh */
  setReach(reach: number): void {
    this.reach = reach;
    this.apply();
  }

  resize(width: number, height: number): void {
    this.width = width;
    this.height = height;
    this.apply();
  }

  /** CSS pixels per unit of length. */
  get scale(): number {
    return this.scaleAt(this.pose.zoom);
  }

  private scaleAt(zoom: number): number {
    return zoom * this.fitting(this.extent);
  }

  /** CSS pixels per unit of length at which an outline fits into the picture. */
  private fitting([horizontal, vertical]: [number, number]): number {
    return (MARGIN * Math.min(this.width / horizontal, this.height / vertical)) / 2;
  }

  /** The zoom at which a length has a number of pixels. */
  zoomFor(length: number, pixels: number): number {
    return Math.min(Math.max(pixels / (length * this.scaleAt(1)), 0.2), 1e5);
  }

  /** The position of a point in the picture, in pixels from the upper left corner. */
  project(point: Vector3): [number, number] {
    const seen = point
      .clone()
      .sub(this.pose.target)
      .applyQuaternion(this.pose.rotation.clone().invert());
    return [this.width / 2 + seen.x * this.scale, this.height / 2 - seen.y * this.scale];
  }

  /**
   * Rotates by a number of pixels: to the right around the volume's z axis, down around the
   * picture's x axis.
   */
  rotate(right: number, down: number): void {
    const perPixel = 3.2 / Math.max(Math.min(this.width, this.height), 200);
    const {rotation} = this.pose;
    // Upside down, the direction changes.
    const upright = Y.clone().applyQuaternion(rotation).z >= 0 ? 1 : -1;
    rotation.premultiply(new Quaternion().setFromAxisAngle(UP, -upright * right * perPixel));
    rotation.multiply(new Quaternion().setFromAxisAngle(X, -down * perPixel)).normalize();
    this.stop();
  }

  /** Pans by a number of pixels. */
  pan(right: number, down: number): void {
    const step = new Vector3(-right, down, 0)
      .divideScalar(this.scale)
      .applyQuaternion(this.pose.rotation);
    this.pose.target.add(step).clampLength(0, 3 * this.radius);
    this.stop();
  }

  /** Zooms; the point at pixel (x, y) stays there. */
  zoomAt(factor: number, x = this.width / 2, y = this.height / 2): void {
    const before = this.scale;
    this.pose.zoom = Math.min(Math.max(this.pose.zoom * factor, 0.2), 1e5);
    const share = this.scale / before - 1;
    this.pan((this.width / 2 - x) * share, (this.height / 2 - y) * share);
  }

  goHome(): void {
    this.glide(this.home);
  }

  /** Shows all that is framed from a direction. @param up what is up in the picture */
  lookFrom(from: Vector3, up?: Vector3): void {
    const rotation = rotationFrom(from, up);
    const {target, extent} = this.outline(rotation);
    this.glide({target, rotation, zoom: this.fitting(extent) / this.fitting(this.extent)});
  }

  /** The line of sight through pixel (x, y). `along` is a unit vector away from the viewer. */
  rayAt(x: number, y: number): {from: Vector3; along: Vector3} {
    const {target, rotation} = this.pose;
    const from = new Vector3(x - this.width / 2, this.height / 2 - y, 0)
      .divideScalar(this.scale)
      .applyQuaternion(rotation)
      .add(target);
    return {from, along: Z.clone().negate().applyQuaternion(rotation)};
  }

  /** Moves to another pose in a third of a second; at once if the user prefers reduced motion. */
  glide(to: Pose): void {
    const from: Pose = {
      target: this.pose.target.clone(),
      rotation: this.pose.rotation.clone(),
      zoom: this.pose.zoom,
    };
    const goal: Pose = {target: to.target.clone(), rotation: to.rotation.clone(), zoom: to.zoom};
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.set(goal);
      return;
    }
    this.moving = true;
    const id = ++this.gliding;
    const begin = performance.now();
    const step = (now: number): void => {
      if (id !== this.gliding) return;
      const share = Math.min(Math.max((now - begin) / 350, 0), 1);
      if (share === 1) {
        this.set(goal);
        return;
      }
      const eased = share * share * (3 - 2 * share);
      this.pose.target.lerpVectors(from.target, goal.target, eased);
      this.pose.rotation.slerpQuaternions(from.rotation, goal.rotation, eased);
      this.pose.zoom = from.zoom * (goal.zoom / from.zoom) ** eased;
      this.apply();
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }
  private gliding = 0;

  /** Shows another pose at once. */
  set(pose: Pose): void {
    this.pose.target.copy(pose.target);
    this.pose.rotation.copy(pose.rotation);
    this.pose.zoom = pose.zoom;
    this.stop();
  }

  private stop(): void {
    ++this.gliding;
    this.moving = false;
    this.apply();
  }

  private apply(): void {
    const {target, rotation} = this.pose;
    const towards = Z.clone().applyQuaternion(rotation);
    // For any target, the camera is outside the bounding ball of all that is drawn, and the ball is
    // between the near and far planes.
    const radius = Math.max(this.radius, this.reach);
    const ahead = radius * 1.01 - target.dot(towards);
    this.three.position.copy(target).addScaledVector(towards, ahead);
    this.three.quaternion.copy(rotation);
    const [w, h] = [this.width / this.scale / 2, this.height / this.scale / 2];
    Object.assign(this.three, {
      left: -w,
      right: w,
      top: h,
      bottom: -h,
      near: 0,
      far: 2.02 * radius,
    });
    this.three.updateProjectionMatrix();
    this.changed();
  }
}
