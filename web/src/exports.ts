// SPDX-License-Identifier: Apache-2.0
// Saves what is shown: the picture, and the shown components of a level as a mesh.
import type {ComponentChoice} from "./component_list";
import type {Mesh, Result} from "./data";
import {count, plural} from "./dom";
import type {LevelShape} from "./level_shape";
import {meshFile, partOf, type MeshFormat} from "./mesh_files";
import type {Overlay} from "./overlay";
import {download, fileStem, pngOf} from "./save";
import type {Scene} from "./scene";
import {levelName} from "./words";

/** What is saved. */
export interface Saved {
  result: Result;
  mesh: Mesh;
  shape: LevelShape;
  choice: ComponentChoice;
  /** Of isoatlas. */
  version: string;
}

const stemOf = ({result, shape}: Saved): string =>
  `${fileStem(result.title)}_level_${levelName(shape.level.facts)}`;

export async function savePicture(
  saved: Saved,
  scene: Scene,
  overlay: Overlay,
  canvas: HTMLCanvasElement,
  background: string,
): Promise<void> {
  const png = await pngOf({
    withPicture: (ratio, use) => scene.withPicture(ratio, use),
    overlay: overlay.svg,
    width: canvas.clientWidth,
    height: canvas.clientHeight,
    background,
  });
  download(`${stemOf(saved)}.png`, png);
}

/** @returns what was saved, in words */
export function saveMesh(format: MeshFormat, saved: Saved): string {
  const {result, mesh, shape, choice, version} = saved;
  const part = partOf({...shape.level, centre: mesh.centre}, (triangle) =>
    choice.isShown(shape.componentOf(triangle)),
  );
  const name = `${stemOf(saved)}.${format}`;
  const space = result.parameters?.space;
  const bytes = meshFile(format, part, {
    comment: `isoatlas ${version}, ${name}`.replace(/[^\x20-\x7e]/g, "?"),
    space: space === "lps" || space === "ras" ? space.toUpperCase() : null,
    unit: space === "voxel" ? "" : result.unit,
  });
  download(name, new Blob([bytes as BlobPart]));
  const all = shape.components().list.length;
  const shown = all - choice.hidden.size;
  return (
    `Saved ${name}: ${shown < all ? `${count(shown)} of ` : ""}${plural(all, "component")}, ` +
    `${plural(part.triangles.length / 3, "triangle")}. Cuts do not apply to saved meshes.`
  );
}
