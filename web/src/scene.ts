// The mesh in 3-D: which level, how it is shaded, coloured and cut, and where it is looked at from.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, LineBasicMaterial, LineSegments, Mesh as Solid, MeshBasicMaterial,
  MeshLambertMaterial, OrthographicCamera, Plane, Scene as World, Sphere, Vector3, WebGLRenderer,
} from "three";
import {OrbitControls} from "three/addons/controls/OrbitControls.js";

import {colour, type Colouring, type Legend} from "./colours";
import type {Level, Mesh} from "./data";
import {aspectRatios, edges, vertexNormals} from "./shape";

export type Style = "smooth" | "hidden-line";

const AXES = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];

export class Scene {
  private readonly renderer: WebGLRenderer;
  private readonly world = new World();
  private readonly camera = new OrthographicCamera(-1, 1, 1, -1, -100, 100);
  private readonly controls: OrbitControls;
  private readonly light = new DirectionalLight(0xffffff, 2.2);
  private readonly surface = new Solid(new BufferGeometry(), new MeshLambertMaterial({vertexColors: true, side: DoubleSide}));
  private readonly fill = new MeshBasicMaterial({polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, side: DoubleSide, vertexColors: true});
  private readonly shaded = this.surface.material as MeshLambertMaterial;
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  private readonly mark = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0xd62728, depthTest: false}));
  private readonly planes = AXES.map((axis) => new Plane(axis.clone().negate(), 0));
  private mesh: Mesh | null = null;
  private unit = "";
  private bounds = new Sphere();
  private style: Style = "smooth";
  private colouring: Colouring = "plain";
  private level = 0;
  private waiting = false;
  private ground = new Color("#ffffff");
  private ink = new Color("#1c2126");

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
    this.renderer.localClippingEnabled = true;
    this.light.position.set(0.4, 0.7, 1);
    this.camera.add(this.light, new DirectionalLight(0xffffff, 0.5));
    this.mark.renderOrder = 1;
    this.mark.visible = false;
    this.world.add(new AmbientLight(0xffffff, 0.9), this.camera, this.surface, this.lines, this.mark);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.fit()).observe(canvas);
  }

  /** Another result: its finest level is what the view is made for. */
  show(mesh: Mesh, unit: string): void {
    this.mesh = mesh;
    this.unit = unit;
    const finest = mesh.levels[mesh.levels.length - 1];
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(finest.positions, 3));
    geometry.computeBoundingSphere();
    this.bounds = geometry.boundingSphere!;
    this.reset();
  }

  /** @returns what the colours say */
  update(level: number, style: Style, colouring: Colouring): Legend {
    this.level = level;
    this.style = style;
    this.colouring = colouring;
    return this.rebuild();
  }

  /** Which half of the box along an axis is shown: the part below `share`, 0 to 1; 1: all. */
  clip(axis: number, share: number): void {
    const {center, radius} = this.bounds;
    this.planes[axis].constant = center.getComponent(axis) + (2 * share - 1) * radius;
    this.planes[axis].constant += share >= 1 ? radius : 0;
    this.draw();
  }

  theme(ground: string, ink: string): void {
    this.ground = new Color(ground);
    this.ink = new Color(ink);
    this.rebuild();
  }

  reset(): void {
    const {center, radius} = this.bounds;
    this.camera.zoom = 1;
    this.camera.up.set(0, 0, 1);
    this.camera.position.copy(center).add(new Vector3(0.45, -1, 0.35).normalize().multiplyScalar(2 * radius));
    this.controls.target.copy(center);
    this.mark.visible = false;
    this.planes.forEach((_, axis) => this.clip(axis, 1));
    this.fit();
    this.controls.update();
  }

  /** Turns the view, radians. */
  turn(right: number, up: number): void {
    const from = this.camera.position.clone().sub(this.controls.target);
    from.applyAxisAngle(this.camera.up, right);
    const side = new Vector3().crossVectors(this.camera.up, from).normalize();
    const tilted = from.clone().applyAxisAngle(side, -up);
    if (Math.abs(tilted.clone().normalize().dot(this.camera.up)) < 0.995) from.copy(tilted);
    this.camera.position.copy(this.controls.target).add(from);
    this.controls.update();
    this.draw();
  }

  /** Moves the view, shares of its width. */
  move(right: number, up: number): void {
    const width = (this.camera.right - this.camera.left) / this.camera.zoom;
    const shift = new Vector3(right, up, 0).multiplyScalar(width).applyQuaternion(this.camera.quaternion);
    this.camera.position.add(shift);
    this.controls.target.add(shift);
    this.controls.update();
    this.draw();
  }

  zoom(factor: number): void {
    this.camera.zoom = Math.min(Math.max(this.camera.zoom * factor, 0.2), 5000);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Centres the triangle with the smallest aspect ratio, marks it and looks at it from outside. @returns its ratio */
  showWorst(): number {
    const {positions, triangles} = this.shown();
    const ratios = aspectRatios(positions, triangles);
    let worst = 0;
    for (let t = 1; t < ratios.length; ++t) if (ratios[t] < ratios[worst]) worst = t;
    const corner = [0, 1, 2].map((k) => new Vector3().fromArray(positions, 3 * triangles[3 * worst + k]));
    const centre = corner[0].clone().add(corner[1]).add(corner[2]).divideScalar(3);
    const normal = new Vector3().crossVectors(corner[1].clone().sub(corner[0]), corner[2].clone().sub(corner[0])).normalize();
    if (!(normal.lengthSq() > 0.5)) normal.copy(this.camera.position).sub(this.controls.target).normalize();
    if (Math.abs(normal.dot(this.camera.up)) > 0.99) normal.add(new Vector3(0.15, 0.1, 0)).normalize();
    const size = Math.max(...corner.map((c) => c.distanceTo(centre)));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(normal, 2 * this.bounds.radius);
    this.camera.zoom = Math.min(Math.max((0.12 * this.bounds.radius) / Math.max(size, 1e-9), 1), 2000);
    this.mark.geometry.dispose();
    this.mark.geometry = new BufferGeometry().setFromPoints([corner[0], corner[1], corner[1], corner[2], corner[2], corner[0]]);
    this.mark.visible = true;
    this.fit();
    this.controls.update();
    return ratios[worst];
  }

  private shown(): Level {
    return this.mesh!.levels[this.level];
  }

  private rebuild(): Legend {
    if (!this.mesh) return {title: ""};
    const level = this.shown();
    const {positions, triangles} = level;
    const smooth = this.style === "smooth";
    const coloured = colour(this.colouring, this.mesh, level, this.unit);
    // One corner, one vertex: colours change at edges.
    const corners = new Float32Array(3 * triangles.length);
    const normals = smooth ? new Float32Array(corners.length) : null;
    const normal = smooth ? vertexNormals(positions, triangles) : null;
    for (let i = 0; i < triangles.length; ++i) {
      for (let k = 0; k < 3; ++k) {
        corners[3 * i + k] = positions[3 * triangles[i] + k];
        if (normals && normal) normals[3 * i + k] = normal[3 * triangles[i] + k];
      }
    }
    this.surface.geometry.dispose();
    const geometry = (this.surface.geometry = new BufferGeometry());
    geometry.setAttribute("position", new BufferAttribute(corners, 3));
    geometry.setAttribute("color", new BufferAttribute(coloured.corners, 3));
    if (normals) geometry.setAttribute("normal", new BufferAttribute(normals, 3));
    if (!smooth && this.colouring === "plain") {  // the paper's figure 1: lines, and what is behind the surface hidden by it
      const {r, g, b} = this.ground;
      for (let i = 0; i < coloured.corners.length; i += 3) coloured.corners.set([r, g, b], i);
    }
    this.surface.material = smooth ? this.shaded : this.fill;
    this.lines.visible = !smooth;
    if (!smooth) {
      this.lines.geometry.dispose();
      this.lines.geometry = new BufferGeometry();
      this.lines.geometry.setAttribute("position", new BufferAttribute(positions, 3));
      this.lines.geometry.setIndex(new BufferAttribute(edges(triangles, level.facts.vertices), 1));
    }
    (this.lines.material as LineBasicMaterial).color = this.ink;
    for (const material of [this.shaded, this.fill, this.lines.material as LineBasicMaterial]) material.clippingPlanes = this.planes;
    this.world.background = this.ground;
    this.mark.visible = false;
    this.draw();
    return coloured.legend;
  }

  private fit(): void {
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    const half = 1.05 * this.bounds.radius;
    const wide = Math.max(width / height, 1) * half;
    const high = Math.max(height / width, 1) * half;
    Object.assign(this.camera, {left: -wide, right: wide, top: high, bottom: -high, near: -4 * half, far: 8 * half});
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.world, this.camera);
    });
  }
}
