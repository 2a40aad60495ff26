// SPDX-License-Identifier: Apache-2.0
#include "pages.h"

#include <string>

namespace isoatlas::tool {
namespace {

const std::string kExitStatus = R"(0    done
2    an argument or a file is not as it should be, or there is no surface;
     nothing was written
3    isoatlas' own check failed, a bug; nothing was written
4    out of memory; nothing was written
130  interrupted (Ctrl-C); nothing was written. 143: the same by SIGTERM
)";

const std::string kToolExitStatus = R"(0    done
1    isoatlas check: not a consistently oriented manifold
2    an argument or a file is not as it should be, or there is no surface;
     nothing was written
3    isoatlas' own check failed, a bug; nothing was written
4    out of memory; nothing was written
130  interrupted (Ctrl-C); nothing was written. 143: the same by SIGTERM
)";

const std::string kCheckExitStatus = R"(0    a manifold, consistently oriented, with at least one triangle
1    not so
2    an argument or the file is not as it should be
3    a bug of isoatlas
4    out of memory
130  interrupted (Ctrl-C). 143: the same by SIGTERM
)";

const std::string kVolumeFiles = R"(Volumes: NRRD (.nrrd, .nhdr), NIfTI (.nii, .nii.gz, .hdr, .img), MetaImage
(.mha, .mhd), TIFF stacks (.tif, .tiff), VTK (.vtk, .vti), a folder with one
DICOM series, and headerless samples (--raw-size, --raw-type).
)";

}  // namespace

ManPage::Text tool_page() {
  return {
      .synopsis =
          "isoatlas COMMAND [options]\n"
          "isoatlas COMMAND --help",
      .description = R"(
Turns scalar volumes (CT, MRI, microscopy, distance fields, simulations) into triangle meshes. Every mesh that is
written is a manifold with the topology of the full-resolution surface, component by component; that is checked, not
assumed.
)",
      .groups = {kRunning},
      .sections = {{"Examples", R"(isoatlas info head.nrrd
isoatlas extract head.nrrd --iso 80.5 -o head.ply
isoatlas check head.ply
)"},
                   {"Exit status", kToolExitStatus},
                   {"Files", kVolumeFiles}},
  };
}

ManPage::Text extract_page() {
  return {
      .synopsis = "isoatlas extract VOLUME --iso X -o MESH [options]",
      .description = R"(
Reads a volume, meshes the surface on which it has the value X, checks the mesh and writes it. The mesh is coarse and
adaptive: few triangles where the surface is tame, more where its topology asks for them. It is a manifold
(with boundary where the surface leaves the volume), consistently oriented, and has component by component the topology
of the full-resolution surface; that is checked before anything is written.

Lengths are world units, as the volume's spacing: 2.5 or 2.5mm; or voxels: 3vx is three times the volume's smallest
spacing.

The same input gives the same bytes, whatever the number of threads.
)",
      .groups = {kInput, kSurface, kMesh, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas extract head.nrrd --iso 80.5 -o head.ply
    The surface at 80.5, in the world coordinates of the file.

isoatlas extract dragon_sdf.nii.gz --iso 0 --inside below -o dragon.stl
    A signed distance field, negative inside.

isoatlas extract ct.mha --iso 300 --max-radius 20mm -o a.vtp --report r.json
    No disk larger than 20 mm; all numbers in r.json.

isoatlas extract fuel.raw --raw-size 64,64,64 --raw-type uint8 --iso 70.5 \
    -o fuel.off
    Headerless samples.
)"},
                   {"Exit status", kExitStatus},
                   {"Files", kVolumeFiles + R"(Meshes: .ply and .stl (binary), .obj, .off, .vtp; the extension decides.
Outputs appear whole, mesh and report together, or not at all. They are
prepared in a hidden folder .isoatlas-* beside the destination; one that a
killed process left behind can be deleted.
)"}},
  };
}

ManPage::Text info_page() {
  return {
      .synopsis = "isoatlas info VOLUME [options]",
      .description = R"(
Prints size, sample type, spacing, origin, orientation, extent, range and memory of a volume, counts samples that are
not finite, draws a histogram (heights are logarithmic) and suggests isovalues: thresholds that split the samples into
two and into three classes (Otsu's method), and 0 for what looks like a signed distance field.

The three letters of the orientation say where the x, y and z axes point, taking the world as LPS: Left or Right,
Posterior or Anterior, Superior or Inferior.
)",
      .groups = {kInput, kRunning},
      .sections = {{"Examples", R"(isoatlas info head.nrrd
isoatlas info fuel.raw --raw-size 64,64,64 --raw-type uint8
)"},
                   {"Exit status", kExitStatus},
                   {"Files", kVolumeFiles}},
  };
}

ManPage::Text check_page() {
  return {
      .synopsis =
          "isoatlas check MESH [--json]\n"
          "isoatlas check MESH --volume VOLUME --iso X [options]",
      .description = R"(
Reads any triangle mesh and says whether it is a manifold (every edge in one or two triangles, the triangles of every
vertex one fan) and consistently oriented, and if so its components, Euler characteristic, genus and boundary loops;
then the shape of its triangles. The aspect ratio of a triangle is its shortest edge over its longest.

With a volume it also measures, both ways, how far the mesh is from the trilinear isosurface: distances from samples of
the mesh to the surface and from samples of the surface to the mesh, and the angles between triangles and surface.
Distances do not change the exit status.
)",
      .groups = {kInput, kDistance, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas check head.ply
isoatlas check head.ply --json | jq .genus
isoatlas check head.ply --volume head.nrrd --iso 80.5
)"},
                   {"Exit status", kCheckExitStatus},
                   {"Files", R"(Meshes: .ply, .stl, .obj, .off, .vtp. Polygons are cut into triangles;
corners of an STL file at equal positions are one vertex.
)" + kVolumeFiles}},
  };
}

}  // namespace isoatlas::tool
