// SPDX-License-Identifier: Apache-2.0
#include "other_programs.h"

#include <algorithm>

namespace isoatlas::detail::tool {
namespace {

struct Synonyms {
  std::string_view name;
  std::string_view words;  // separated by blanks
};

bool has_word(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    const std::string_view first = words.substr(0, words.find(' '));
    if (first == word) return true;
    words.remove_prefix(std::min(first.size() + 1, words.size()));
  }
  return false;
}

constexpr Synonyms kCommands[] = {
    {"extract",
     "mesh mesher meshing convert isosurface iso contour surface marching-cubes marchingcubes mc "
     "polygonize polygonise triangulate "
     "segment threshold export generate create make build run reconstruct stl vtk vol2mesh remesh "
     "simplify decimate"},
    {"view", "viewer show open display look browse gui slice slices window"},
    {"report", "viewer show open display html page web browse"},
    {"picture",
     "viewer show open display picture render screenshot plot draw image png snapshot "
     "thumbnail"},
    {"info",
     "inspect describe header stat stats statistics histogram list ls summary about metadata show "
     "open dump"},
    {"check",
     "validate verify test measure compare distance hausdorff quality analyze analyse diff repair"},
    {"levels", "lod lods level"},
    {"completion", "completions complete bash zsh fish"},
};

constexpr Synonyms kOptions[] = {
    {"--iso",
     "threshold thresh isovalue iso-value isolevel iso-level level value contour isosurface"},
    {"--label", "labels segment segments segmentation mask organ class roi-label"},
    {"the input file is given without an option, the isovalue with --iso", "i"},
    {"--output",
     "out output-file outfile out-file output-mesh outmesh save save-as export dest destination "
     "target to output-path"},
    {"--volume", "volume image reference ref vol compare-to"},
    {"the input file is given without an option",
     "input in input-file infile file volume image vol in-file f mesh"},
    {"--max-distance",
     "tolerance tol error max-error maxerror accuracy precision deviation hausdorff eps epsilon "
     "max-deviation step-size"},
    {"--max-vertices",
     "decimate decimation reduce reduction simplify target-reduction target-vertices num-vertices "
     "vertices n-vertices nvertices "
     "max-verts"},
    {"--max-vertices N, about half the number of triangles",
     "target-faces faces max-faces triangles max-triangles num-triangles num-faces "
     "target-triangles n-faces nfaces polygons"},
    {"meshes are not smoothed; smooth the volume, or use a larger --max-distance",
     "smooth smoothing laplacian taubin smooth-iterations gaussian sigma"},
    {"--max-edge",
     "edge-length target-edge-length max-edge-length element-size mesh-size cell-size"},
    {"--min-edge", "min-edge-length"},
    {"--normal-angle", "angle max-angle feature-angle"},
    {"--min-aspect", "quality aspect aspect-ratio min-quality"},
    {"--supersample", "upsample resample oversample subsample super-sample"},
    {"--spacing", "voxel-size voxelsize pixel-size pixelsize resolution scale voxel pixdim"},
    {"--raw-spacing",
     "voxel-size voxelsize pixel-size pixelsize resolution scale voxel pixdim spacing"},
    {"--size", "resolution width height geometry window window-size dimensions"},
    {"--raw-size", "size dims dimensions dimension shape dim"},
    {"--raw-type", "type dtype datatype data-type sample-type format"},
    {"--raw-endian", "endian byte-order byteorder big-endian little-endian endianness"},
    {"--channel", "channels component ch c"},
    {"--time", "frame frames timepoint time-point timestep t"},
    {"--layer", "label labels segment"},
    {"--array", "field scalars variable array-name"},
    {"--max-memory", "mem ram memory-limit"},
    {"--raw-offset", "offset header-size skip header raw-header"},
    {"the extension of the output file is its format",
     "format output-format file-format type ascii binary"},
    {"--keep-components 1",
     "largest largest-component keep-largest biggest only-largest largest-only connected"},
    {"--min-component-size",
     "min-size min-component remove-islands islands remove-small min-volume"},
    {"--levels", "lod lods level-of-detail num-levels n-levels ladder"},
    {"--refine", "subdivide refinement"},
    {"--inside below", "invert flip flip-normals reverse reverse-normals inverse"},
    {"--space ras", "ras to-ras"},
    {"--space lps", "lps to-lps"},
    {"--space", "coordinates coordinate-system coords orientation space-out"},
    {"--threads", "jobs j nthreads num-threads parallel cores cpus n-threads np"},
    {"--html", "web page view show viewer"},
    {"--neuroglancer", "precomputed multilod draco"},
    {"--report", "json log statistics stats json-report"},
    {"--json", "as-json format report"},
    {"--measure", "distance check verify hausdorff-distance"},
    {"--nan", "nans ignore-nan nan-value"},
    {"--self-intersections", "intersections self-intersection selfintersections intersect"},
    {"--interpolation", "cubic tricubic interp linear"},
    {"existing files are always replaced", "force overwrite y yes clobber"},
    {"--view", "camera direction eye azimuth elevation rotate rotation from"},
    {"--style hidden-line", "wireframe edges wire lines"},
    {"--level", "lod"},
    {"--version", "v version"},
};

}  // namespace

std::vector<std::string_view> commands_called(std::string_view word) {
  std::vector<std::string_view> commands;
  for (const Synonyms& command : kCommands)
    if (has_word(command.words, word)) commands.push_back(command.name);
  return commands;
}

std::vector<OtherOption> options_called(std::string_view name) {
  std::vector<OtherOption> options;
  for (const Synonyms& option : kOptions)
    if (has_word(option.words, name)) options.push_back({option.name});
  return options;
}

}  // namespace isoatlas::detail::tool
