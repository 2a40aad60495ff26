// SPDX-License-Identifier: Apache-2.0
// Saves files from the page: the picture, and a mesh.

/** Offers a file for download. */
export function download(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  // The browser reads the content after this task.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** A file name from a title: "head.nrrd at 80.5" becomes "head_80.5". */
export function fileStem(title: string): string {
  const stem = title
    .replace(/(\.(nrrd|nhdr|mha|mhd|nii|gz|tiff?|vti|vtk|mgz|dcm|npy|raw|glb|vtm|ply|stl))+/gi, "")
    .replaceAll(" at ", "_")
    .replace(/[^\p{L}\p{N}._+-]+/gu, "_")
    .replace(/^[._]+|[._]+$/g, "");
  return stem.slice(0, 100) || "mesh";
}

const DRAWN = ["fill", "stroke", "stroke-width", "stroke-linejoin", "stroke-linecap",
  "stroke-dasharray", "paint-order", "font-size", "font-family", "font-weight", "opacity",
  "visibility"] as const;

/** The overlay as an image, with the style that the page gives it. */
async function imageOf(svg: SVGElement, width: number, height: number): Promise<HTMLImageElement> {
  const copy = svg.cloneNode(true) as SVGElement;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", `${width}`);
  copy.setAttribute("height", `${height}`);
  const copies = [...copy.querySelectorAll<SVGElement>("*")];
  [...svg.querySelectorAll<SVGElement>("*")].forEach((from, i) => {
    const style = getComputedStyle(from);
    for (const name of DRAWN) copies[i].style.setProperty(name, style.getPropertyValue(name));
  });
  const image = new Image();
  const text = new XMLSerializer().serializeToString(copy);
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  return image;
}

export interface PictureSource {
  /** Draws the mesh at a number of pixels per CSS pixel. */
  withPicture: (ratio: number, use: (canvas: HTMLCanvasElement) => void) => void;
  overlay: SVGElement;
  /** Size of the picture in CSS pixels. */
  width: number;
  height: number;
  background: string;
}

/** Least width of a saved picture, and most pixels along a side. */
const WIDTH = 2400;
const MOST = 8192;

/** The picture as PNG, at least 2400 pixels wide, with its background, axes and scale. */
export async function pngOf(source: PictureSource): Promise<Blob> {
  const {width, height, overlay, background} = source;
  const ratio = Math.min(
    Math.max(WIDTH / width, devicePixelRatio),
    MOST / Math.max(width, height),
  );
  const out = document.createElement("canvas");
  out.width = Math.round(width * ratio);
  out.height = Math.round(height * ratio);
  const context = out.getContext("2d")!;
  context.fillStyle = background;
  context.fillRect(0, 0, out.width, out.height);
  const axes = await imageOf(overlay, width, height);
  source.withPicture(ratio, (canvas) => context.drawImage(canvas, 0, 0, out.width, out.height));
  context.drawImage(axes, 0, 0, out.width, out.height);
  return new Promise((done, failed) =>
    out.toBlob((blob) =>
      blob ? done(blob) : failed(new Error("the browser could not encode the picture")),
    ),
  );
}
