// SPDX-License-Identifier: Apache-2.0
// The 3-D scene: the level, its style, colours and cuts. It is drawn only when something changes.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DoubleSide,
  GLSL3,
  Mesh as Solid,
  RawShaderMaterial,
  Scene as World,
  Vector3,
  WebGLRenderer,
} from "three";

import {Camera, rotationFrom} from "./camera";
import {Caps, closingFans} from "./caps";
import {colour, type Colouring, type Colours, type Legend} from "./colours";
import type {Mesh, Triple} from "./data";
import type {LevelShape, Worst} from "./level_shape";
import {Outlines, type Outline} from "./outlines";
import {firstHit, isHidden, type Span} from "./rays";
import {FRAGMENT, VERTEX} from "./shaders";
import {enclosedVolume, vertexNormals} from "./shape";

export type Style = "smooth" | "split" | "lines";
/** Their names on the pages. */
export const STYLES: {value: Style; text: string}[] = [
  {value: "smooth", text: "Smooth"},
  {value: "split", text: "Both"},
  {value: "lines", text: "Hidden line"},
];

export interface Cut {
  /** Position in the bounding box, 0 to 1. */
  share: number;
  /** The side that is kept. */
  keep: "below" | "above";
}

/** What is visible at a pixel. */
export interface Picked {
  /** Relative to the centre of the mesh. */
  point: Vector3;
  /** null: a filled cut. */
  triangle: number | null;
  /** The corner of the triangle that is nearest to the point; null: a filled cut. */
  vertex: number | null;
  component: number | null;
}

/** A level with separate vertices for each triangle, which carry the colours of its corners. */
interface Prepared {
  geometry: BufferGeometry;
  colouring: Colouring | null;
  colours: Colours | null;
  /** Closes the open ends of the shown components, to fill cuts. */
  closing: BufferGeometry;
  /** The value of `visibility` that the index of `geometry` and `closing` are for. */
  visibility: number;
}

const MODES = {plain: 0, blend: 1, nearest: 2};

export class Scene {
  readonly camera: Camera;
  readonly cuts: [Cut, Cut, Cut] = [
    {share: 1, keep: "below"},
    {share: 1, keep: "below"},
    {share: 1, keep: "below"},
  ];
  frames = 0;
  private readonly renderer: WebGLRenderer;
  private readonly world = new World();
  private readonly texture = new DataTexture(new Uint8Array(4 * 256), 256, 1);
  private readonly material: RawShaderMaterial;
  private readonly surface: Solid<BufferGeometry, RawShaderMaterial>;
  private mesh!: Mesh;
  private shapes: LevelShape[] = [];
  private prepared: (Prepared | undefined)[] = [];
  private style: Style = "smooth";
  private readonly caps: Caps;
  private readonly outlines = new Outlines();
  private level = 0;
  private facesInward = false;
  private closed = false;
  private fillsCuts = true;
  private isShown: (component: number) => boolean = () => true;
  private visibility = 0;  // increases when other components are shown
  private isDrawPending = false;

  /** @param context WebGL 2 of the canvas; @param drew called after each frame */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    private readonly drew: () => void,
  ) {
    this.renderer = new WebGLRenderer({
      canvas,
      context,
      alpha: true,
      antialias: true,
      stencil: true,
    });
    this.renderer.autoClear = false;
    // Checks wait for the graphics process; the tests compare pictures.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.setClearColor(0x000000, 0);  // the background is that of the page
    const colourNames = ["clay", "inside", "paper", "paperInside", "ink", "section"];
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      side: DoubleSide,
      uniforms: {
        mode: {value: 0},
        palette: {value: this.texture},
        cutAt: {value: new Vector3()},
        cutSide: {value: new Vector3()},
        facesInward: {value: false},
        solid: {value: false},
        linesFrom: {value: 0},
        pixelRatio: {value: 1},
        ...Object.fromEntries(colourNames.map((name) => [name, {value: new Vector3()}])),
      },
    });
    this.surface = new Solid(new BufferGeometry(), this.material);
    this.surface.frustumCulled = false;
    this.world.add(this.surface, this.outlines.lines);
    const {cutAt, cutSide} = this.material.uniforms;
    this.caps = new Caps({at: cutAt.value as Vector3, side: cutSide.value as Vector3});
    this.camera = new Camera(() => this.draw());
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  /**
   * Shows another mesh, in the home view of its finest level.
   * @param keepsView whether the view stays as it is, if there is one
   */
  show(mesh: Mesh, shapes: LevelShape[], keepsView = false): void {
    for (const old of this.prepared) {
      old?.geometry.dispose();
      old?.closing.dispose();
    }
    const before = keepsView ? (this.mesh as Mesh | undefined) : undefined;
    this.mesh = mesh;
    this.shapes = shapes;
    this.prepared = [];
    // If samples below the isovalue are inside, a mesh may face inward as a whole. Its outside is
    // still the side that is visible from outside.
    const finest = mesh.levels[mesh.levels.length - 1];
    this.facesInward = enclosedVolume(finest.positions, finest.triangles) < 0;
    this.material.uniforms.facesInward.value = this.facesInward;
    if (before) this.camera.changeHome(finest.positions, fromTo(mesh.centre, before.centre));
    else this.camera.setHome(finest.positions);
  }

  /** @returns the legend of the colours */
  update(level: number, style: Style, colouring: Colouring, unit: string): Legend | null {
    this.style = style;
    const prepared = (this.prepared[level] ??= this.prepare(level));
    if (prepared.colouring !== colouring) {
      prepared.colours = colour(
        colouring,
        this.mesh,
        this.mesh.levels[level],
        this.shapes[level],
        unit,
      );
      prepared.colouring = colouring;
      const {values} = prepared.colours;
      if (values)
        prepared.geometry.setAttribute("corners", new BufferAttribute(perCorner(values), 4, true));
    }
    const {mode, palette, legend} = prepared.colours!;
    this.material.uniforms.mode.value = MODES[mode];
    if (palette) {
      (this.texture.image.data as Uint8Array).set(palette);
      this.texture.needsUpdate = true;
    }
    this.level = level;
    this.showShown(prepared);
    this.surface.geometry = prepared.geometry;
    this.closed = this.shapes[level].isClosed();
    this.draw();
    return legend;
  }

  /** Shows only some components. @param isShown by the number of the component */
  showComponents(isShown: (component: number) => boolean): void {
    this.isShown = isShown;
    ++this.visibility;
    const prepared = this.prepared[this.level];
    if (!prepared) return;
    this.showShown(prepared);
    this.draw();
  }

  /** Restricts a level to the shown components. */
  private showShown(prepared: Prepared): void {
    if (prepared.visibility === this.visibility) return;
    prepared.visibility = this.visibility;
    const {positions, triangles} = this.mesh.levels[this.level];
    const {of, list, loops} = this.shapes[this.level].components();
    const all = list.every((_, component) => this.isShown(component));
    const corners: number[] = [];
    if (!all)
      for (let i = 0; i < triangles.length; i += 3)
        if (this.isShown(of[triangles[i]])) corners.push(i, i + 1, i + 2);
    prepared.geometry.setIndex(
      all ? null : new BufferAttribute(Uint32Array.from(corners), 1),
    );
    // An empty picture keeps its frame.
    if (all) this.camera.framed = positions;
    else if (corners.length > 0)
      this.camera.framed = Float32Array.from(
        corners.flatMap((i) => [0, 1, 2].map((axis) => positions[3 * triangles[i] + axis])),
      );
    const fans = closingFans(positions, loops.filter(([v]) => this.isShown(of[v])));
    prepared.closing.setAttribute("position", new BufferAttribute(fans, 3));
  }

  /** Whether cuts are filled where they are inside the solid. */
  fillCuts(fill: boolean): void {
    this.fillsCuts = fill;
    this.draw();
  }

  /** Cuts can be filled if the surface bounds a solid. */
  canFillCuts(): boolean {
    return this.mesh.levels[this.level].facts.manifold !== false;
  }

  get areCutsFilled(): boolean {
    return this.fillsCuts && this.canFillCuts();
  }

  /** 1, or -1 if the triangles of outer surfaces face inward. */
  get facing(): number {
    return this.facesInward ? -1 : 1;
  }

  /** What is visible at pixel (x, y); null: the background. */
  pick(x: number, y: number): Picked | null {
    if (!this.mesh) return null;
    const {positions, triangles} = this.mesh.levels[this.level];
    const {of} = this.shapes[this.level].components();
    const {from, along} = this.camera.rayAt(x, y);
    const span = this.uncut(from, along);
    const isShown = (triangle: number): boolean => this.isShown(of[triangles[3 * triangle]]);
    const closing = this.prepared[this.level]?.closing.getAttribute("position").array;
    const hit = firstHit(
      {
        positions,
        triangles,
        isShown,
        facesInward: this.facesInward,
        filled:
          this.areCutsFilled && span.first > -Infinity && closing
            ? {bounds: () => true, closing: closing as Float32Array}
            : null,
      },
      {from: from.toArray(), along: along.toArray()},
      span,
    );
    if (!hit) return null;
    const point = from.addScaledVector(along, hit.at);
    if (hit.triangle === null) return {point, triangle: null, vertex: null, component: null};
    const nearest = hit.weights.indexOf(Math.max(...hit.weights));
    const vertex = triangles[3 * hit.triangle + nearest];
    return {point, triangle: hit.triangle, vertex, component: of[vertex]};
  }

  /** The part of a line that the cuts leave. */
  private uncut(from: Vector3, along: Vector3): Span {
    const span = {first: -Infinity, last: Infinity};
    for (let axis = 0; axis < 3; ++axis) {
      if (!this.isCut(axis)) continue;
      const slope = along.getComponent(axis);
      const distance = this.cutPosition(axis) - from.getComponent(axis);
      const keepsBelow = this.cuts[axis].keep === "below";
      if (slope === 0) {
        if (distance >= 0 !== keepsBelow) span.last = -Infinity;
      } else if (slope > 0 === keepsBelow) {
        span.last = Math.min(span.last, distance / slope);
      } else {
        span.first = Math.max(span.first, distance / slope);
      }
    }
    return span;
  }

  private cutPosition(axis: number): number {
    return (2 * this.cuts[axis].share - 1) * this.mesh.half[axis];
  }

  /** Draws closed lines around the mesh, in place of the previous ones. */
  setOutlines(outlines: Outline[]): void {
    this.outlines.set(outlines);
    this.camera.setReach(this.outlines.reach);
  }

  cut(axis: number, cut: Cut): void {
    this.cuts[axis] = cut;
    this.draw();
  }

  /** False if the cut is at the end of the box and removes nothing. */
  isCut(axis: number): boolean {
    const {share, keep} = this.cuts[axis];
    return keep === "below" ? share < 1 : share > 0;
  }

  /** Colours of the theme, from the style sheet. */
  theme(colours: Record<string, string>): void {
    for (const [name, text] of Object.entries(colours)) {
      const {r, g, b} = new Color(text).convertLinearToSRGB();  // the shader uses sRGB values
      const uniform = name === "cap" ? this.caps.colour : this.material.uniforms[name];
      (uniform.value as Vector3).set(r, g, b);
    }
    this.draw();
  }

  /** Shows the worst triangle of a level, from a direction without occlusion if possible. */
  centre(worst: Worst, level: number): void {
    const {corners: [a, b, c], centroid} = worst;
    const {positions, triangles} = this.mesh.levels[level];
    const size = Math.max(a.distanceTo(b), b.distanceTo(c), c.distanceTo(a)) || 1e-3;
    const normal = new Vector3().crossVectors(b.clone().sub(a), c.clone().sub(a)).normalize();
    if (this.facesInward) normal.negate();
    if (!(normal.lengthSq() > 0.5)) normal.set(0, 0, 1).applyQuaternion(this.camera.pose.rotation);
    const side = new Vector3(1, 0, 0).addScaledVector(normal, -normal.x);
    if (side.lengthSq() < 0.1) side.set(0, 1, 0).addScaledVector(normal, -normal.y);
    side.normalize();
    const other = new Vector3().crossVectors(normal, side);
    let from = normal;
    // From outside with increasing tilt, finally from inside.
    search: for (const tilt of [0.15, 0.5, 0.85, 1.15, Math.PI - 0.5, Math.PI - 1]) {
      for (let k = 0; k < 8; ++k) {
        const angle = (k * Math.PI) / 4;
        const tried = normal
          .clone()
          .multiplyScalar(Math.cos(tilt))
          .addScaledVector(side, Math.sin(tilt) * Math.cos(angle))
          .addScaledVector(other, Math.sin(tilt) * Math.sin(angle));
        const ray = {from: centroid.toArray(), along: tried.toArray()};
        if (isHidden(positions, triangles, worst.triangle, ray, 1e-4 * size)) continue;
        from = tried;
        break search;
      }
    }
    this.camera.glide({
      target: centroid,
      rotation: rotationFrom(from),
      zoom: Math.max(this.camera.zoomFor(size, 130), 1),
    });
  }

  /** Draws now. The picture can be read from the canvas until the next task. */
  render(): void {
    this.drawAt(pixelRatio());
    ++this.frames;
    this.drew();
  }

  /**
   * Calls `use` while the canvas has a larger picture, which is not shown.
   * @param ratio pixels of the picture per CSS pixel
   */
  withPicture(ratio: number, use: (canvas: HTMLCanvasElement) => void): void {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    this.renderer.setSize(Math.round(width * ratio), Math.round(height * ratio), false);
    this.drawAt(ratio);
    use(this.canvas);
    this.renderer.setSize(...pixelsOf(this.canvas), false);
    this.render();
  }

  private drawAt(ratio: number): void {
    const {uniforms} = this.material;
    for (let axis = 0; axis < 3; ++axis) {
      (uniforms.cutAt.value as Vector3).setComponent(axis, this.cutPosition(axis));
      (uniforms.cutSide.value as Vector3).setComponent(
        axis,
        this.isCut(axis) ? (this.cuts[axis].keep === "below" ? 1 : -1) : 0,
      );
    }
    const isCut = [0, 1, 2].some((axis) => this.isCut(axis));
    uniforms.solid.value = this.closed && !isCut;
    uniforms.pixelRatio.value = ratio;
    uniforms.linesFrom.value = {
      smooth: 1e9,
      split: Math.round((this.canvas.clientWidth / 2) * ratio),
      lines: -1,
    }[this.style];
    this.renderer.clear();
    this.renderer.render(this.world, this.camera.three);
    if (!isCut || !this.areCutsFilled) return;
    this.caps.draw(
      this.renderer,
      this.camera.three,
      this.surface.geometry,
      this.prepared[this.level]!.closing,
      this.facesInward,
      this.mesh.half,
    );
  }

  draw(): void {
    if (this.isDrawPending || !this.mesh) return;
    this.isDrawPending = true;
    requestAnimationFrame(() => {
      this.isDrawPending = false;
      this.render();
    });
  }

  private prepare(at: number): Prepared {
    const {positions, triangles} = this.mesh.levels[at];
    const normals = vertexNormals(positions, triangles);
    const cornerPositions = new Float32Array(3 * triangles.length);
    const cornerNormals = new Int16Array(4 * triangles.length);
    for (let i = 0; i < triangles.length; ++i) {
      const v = 3 * triangles[i];
      cornerPositions[3 * i] = positions[v];
      cornerPositions[3 * i + 1] = positions[v + 1];
      cornerPositions[3 * i + 2] = positions[v + 2];
      cornerNormals[4 * i] = 32767 * normals[v];
      cornerNormals[4 * i + 1] = 32767 * normals[v + 1];
      cornerNormals[4 * i + 2] = 32767 * normals[v + 2];
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(cornerPositions, 3));
    geometry.setAttribute("normal", new BufferAttribute(cornerNormals, 4, true));
    geometry.setAttribute(
      "corners",
      new BufferAttribute(new Uint8Array(4 * triangles.length), 4, true),
    );
    const closing = new BufferGeometry();
    return {geometry, colouring: null, colours: null, closing, visibility: -1};
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (width === 0 || height === 0) return;
    const [wide, high] = pixelsOf(this.canvas);
    // Setting the size, even the same one, clears the canvas and waits for the graphics process.
    if (this.canvas.width !== wide || this.canvas.height !== high)
      this.renderer.setSize(wide, high, false);
    this.camera.resize(width, height);
    if (this.mesh) this.render();  // in this frame, because resizing has cleared the canvas
  }
}

const pixelRatio = (): number => Math.min(devicePixelRatio, 2);

const pixelsOf = (canvas: HTMLCanvasElement): [number, number] => [
  Math.round(canvas.clientWidth * pixelRatio()),
  Math.round(canvas.clientHeight * pixelRatio()),
];

/** A WebGL 2 context for a canvas at its size in the page; null if WebGL 2 is not available. */
export function contextOf(canvas: HTMLCanvasElement): WebGL2RenderingContext | null {
  [canvas.width, canvas.height] = pixelsOf(canvas);
  return canvas.getContext("webgl2", {
    alpha: true,
    antialias: true,
    depth: true,
    stencil: true,
    premultipliedAlpha: true,
  });
}

/** Copies the three bytes of each triangle to each of its corners. */
function perCorner(values: Uint8Array): Uint8Array {
  const out = new Uint8Array((4 * 3 * values.length) / 3);
  for (let t = 0, o = 0; t < values.length; t += 3) {
    for (let k = 0; k < 3; ++k, o += 4) {
      out[o] = values[t];
      out[o + 1] = values[t + 1];
      out[o + 2] = values[t + 2];
    }
  }
  return out;
}

const fromTo = (from: Triple, to: Triple): Vector3 =>
  new Vector3(...to).sub(new Vector3(...from));

/** A point in the coordinates of the file. */
export function toFile(point: Vector3, centre: Triple): Triple {
  return [point.x + centre[0], point.y + centre[1], point.z + centre[2]];
}
