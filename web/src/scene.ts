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
import {colour, type Colouring, type Colours, type Legend} from "./colours";
import type {AspectRatio, Level, Mesh, Triple} from "./data";
import {FRAGMENT, VERTEX} from "./shaders";
import {
  aspectFacts,
  aspectRatios,
  components,
  enclosedVolume,
  isHidden,
  vertexNormals,
  type Components,
} from "./shape";

export type Style = "smooth" | "split" | "lines";

export interface Cut {
  /** Position in the bounding box, 0 to 1. */
  share: number;
  /** The side that is kept. */
  keep: "below" | "above";
}

export interface Worst {
  triangle: number;
  ratio: number;
  /** Relative to the centre of the mesh. */
  corners: [Vector3, Vector3, Vector3];
  centroid: Vector3;
}

/** Properties of a level that are computed when they are first needed. */
export class LevelShape {
  private knownRatios?: Float32Array;
  private knownAspect?: AspectRatio;
  private knownComponents?: Components;

  constructor(readonly level: Level) {}

  readonly ratios = (): Float32Array =>
    (this.knownRatios ??= aspectRatios(this.level.positions, this.level.triangles));
  readonly components = (): Components =>
    (this.knownComponents ??= components(this.level.vertices, this.level.triangles));

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

/** A level with separate vertices for each triangle, which carry the colours of its corners. */
interface Prepared {
  geometry: BufferGeometry;
  colouring: Colouring | null;
  colours: Colours | null;
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
  private facesInward = false;
  private closed = false;
  private isDrawPending = false;

  /** @param context WebGL 2 of the canvas; @param drew called after each frame */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    private readonly drew: () => void,
  ) {
    this.renderer = new WebGLRenderer({canvas, context, alpha: true, antialias: true});
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
    this.world.add(this.surface);
    this.camera = new Camera(() => this.draw());
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  /** Shows another mesh, in the home view of its finest level. */
  show(mesh: Mesh, shapes: LevelShape[]): void {
    for (const old of this.prepared) old?.geometry.dispose();
    this.mesh = mesh;
    this.shapes = shapes;
    this.prepared = [];
    // If samples below the isovalue are inside, a mesh may face inward as a whole. Its outside is
    // still the side that is visible from outside.
    const finest = mesh.levels[mesh.levels.length - 1];
    this.facesInward = enclosedVolume(finest.positions, finest.triangles) < 0;
    this.material.uniforms.facesInward.value = this.facesInward;
    this.camera.setHome(mesh.levels[mesh.levels.length - 1].positions);
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
    this.surface.geometry = prepared.geometry;
    this.closed = this.shapes[level].isClosed();
    this.draw();
    return legend;
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
      (this.material.uniforms[name].value as Vector3).set(r, g, b);
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
        const [at, along] = [centroid.toArray(), tried.toArray()];
        if (isHidden(positions, triangles, worst.triangle, at, along, 1e-4 * size)) continue;
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
    const {uniforms} = this.material;
    const {half} = this.mesh;
    for (let axis = 0; axis < 3; ++axis) {
      const {share, keep} = this.cuts[axis];
      (uniforms.cutAt.value as Vector3).setComponent(axis, (2 * share - 1) * half[axis]);
      (uniforms.cutSide.value as Vector3).setComponent(
        axis,
        this.isCut(axis) ? (keep === "below" ? 1 : -1) : 0,
      );
    }
    uniforms.solid.value = this.closed && ![0, 1, 2].some((axis) => this.isCut(axis));
    const ratio = pixelRatio();
    uniforms.pixelRatio.value = ratio;
    uniforms.linesFrom.value = {
      smooth: 1e9,
      split: Math.round((this.canvas.clientWidth / 2) * ratio),
      lines: -1,
    }[this.style];
    this.renderer.render(this.world, this.camera.three);
    ++this.frames;
    this.drew();
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
    return {geometry, colouring: null, colours: null};
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

/** A point in the coordinates of the file. */
export function toFile(point: Vector3, centre: Triple): Triple {
  return [point.x + centre[0], point.y + centre[1], point.z + centre[2]];
}
