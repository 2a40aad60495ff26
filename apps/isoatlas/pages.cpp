// SPDX-License-Identifier: Apache-2.0
#include "pages.h"

#include <string>

namespace isoatlas::detail::tool {
namespace {

const std::string kExitStatus = R"(0    done
2    invalid argument or file, or there is no surface; nothing was written
3    isoatlas' own check failed, a bug; nothing was written
4    out of memory, or above --max-memory; nothing was written
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM;
     nothing was written
)";

const std::string kExtractExitStatus = R"(0    done
1    done, but a constraint that was asked for is not met; stderr says
     which and why, everything was written
2    invalid argument or file, or there is no surface; nothing was written
3    isoatlas' own check failed, a bug; nothing was written
4    out of memory, or above --max-memory; nothing was written
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM;
     nothing was written
)";

const std::string kToolExitStatus = R"(0    done
1    isoatlas check, levels: not a consistently oriented manifold;
     with --self-intersections: some found; with --volume: the mesh is
     nowhere near the volume;
     isoatlas extract: a constraint that was asked for is not met,
     everything was written
2    invalid argument or file, or there is no surface; nothing was written
3    isoatlas' own check failed, a bug; nothing was written
4    out of memory, or above --max-memory; nothing was written
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM;
     nothing was written
)";

const std::string kCheckExitStatus =
    R"(0    a manifold, consistently oriented, with at least one triangle
     (and with --self-intersections: none found)
1    not so, or nowhere near the volume of --volume
2    invalid argument or file
3    a bug of isoatlas
4    out of memory
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM
)";

const std::string kLevelsExitStatus =
    R"(0    every level is a manifold, consistently oriented, with triangles
1    not so
2    invalid argument or file
3    a bug of isoatlas
4    out of memory
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM
)";

const std::string kVolumeFiles =
    R"(Volumes: NRRD (.nrrd, .nhdr), NIfTI-1 and -2 (.nii, .nii.gz, .hdr, .img),
MetaImage (.mha, .mhd), TIFF (.tif, .tiff; ImageJ, OME, LSM), DICOM (.dcm,
or a folder), a folder of TIFF or PNG slices, VTK (.vtk, .vti, .vtr, .pvti,
.pvtr), MGH (.mgh, .mgz), MRC (.mrc, .map, .rec), NumPy (.npy), and
headerless samples (--raw-size, --raw-type). NIfTI, MGH and MRC files may be
compressed by gzip, NIfTI also by bzip2. Analyze files (.hdr, .img) are read
as well. A file's format is that of its content.
)";

}  // namespace

ManPage::Text tool_page() {
  return {
      .synopsis =
          "isoatlas COMMAND [options]\n"
          "isoatlas help COMMAND",
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
      .common_options = R"(--iso X                the isovalue; `isoatlas info VOLUME` suggests some
-o, --output MESH      its extension is the format: .ply, .stl, .glb, ...
--max-distance LENGTH  how close to the surface: 0.5vx (voxels) or 0.2mm;
                       larger: fewer triangles. Default: 0.5vx
--refine SPEC          one more level of detail, like max-distance:2vx
--report FILE          all that was counted and measured, as JSON
--html FILE            a page that shows the mesh in 3-D, in any browser

isoatlas extract head.nrrd --iso 80.5 -o head.ply --html head.html
)",
      .description = R"(
Reads a volume, meshes the surface on which it has the value X in nested levels of detail, checks the meshes and writes
them. Level 0 is the coarsest mesh: few triangles where the surface is smooth, more where its topology needs them. Each
further level keeps the vertices of the one before and adds some until it meets its constraints. Every level is a manifold
(with boundary where the surface leaves the volume), consistently oriented, and has component by component the topology
of the full-resolution surface; that is checked before anything is written.

--refine sets the constraints of one level; other options set them for all levels after level 0 (with --coarse: for
level 0). If constraints conflict, the first on the command line takes priority; topology always does.

A length is a number in the volume's unit (2.5), a number with a unit (2.5mm, 0.2um; nm, um, mm, cm, m, A and in are
converted to the volume's unit, which it must state), or voxels: 3vx is three times the volume's smallest spacing.

The same input gives the same bytes, whatever the number of threads.
)",
      .groups = {kInput, kSurface, kMesh, kLevels, kOutput, kReading, kRunning},
      .sections = {{"Examples", R"(isoatlas extract head.nrrd --iso 80.5 -o head.ply
    The surface at 80.5 within half a voxel, in the world coordinates of the
    file.

isoatlas extract head.nrrd --iso 80.5 --coarse -o head.ply
    As few triangles as its topology allows.

isoatlas extract head.nrrd --iso 80.5 -o head.glb \
    --refine max-distance:2vx --refine max-distance:0.5vx,normal-angle:20deg
    Three levels of detail in one file.

isoatlas extract head.nrrd --iso 80.5 -o head-{level}.stl \
    --max-vertices 5000 --refine max-distance:1mm
    head-0.stl and head-1.stl; at most 5000 vertices matter more than 1 mm.

isoatlas extract dragon_sdf.nii.gz --iso 0 --inside below -o dragon.stl
    A signed distance field, negative inside.

isoatlas extract ct.mha --iso 300 --max-radius 20mm -o a.vtp --report r.json
    No disk larger than 20 mm; all numbers in r.json.

gunzip -c ct.nrrd.gz | isoatlas extract - --iso 300 -o - > ct.ply
    From standard input to standard output.

isoatlas extract fuel.raw --raw-size 64,64,64 --raw-type uint8 --iso 70.5 \
    -o fuel.off
    Headerless samples.
)"},
                   {"Exit status", kExtractExitStatus},
                   {"Files",
                    kVolumeFiles +
                        R"(Meshes: .ply and .stl (binary), .obj, .off, .vtp, .3mf, .gii: the finest
level, or with {level} in the name each level in a file of its own; .glb:
all levels, the extension MSFT_lod; .vtm: all levels, with a folder beside
it. The extension decides. What is rounded to float (.stl, .gii, .glb) is
read back and checked, and the error as stated includes it. A .3mf states
the volume's unit; a .gii is in RAS and millimetres, whatever --space says.
With -o - the mesh goes to standard output, the summary to standard error.
Outputs appear whole, all together, or not at all. They are prepared in a
hidden folder .isoatlas-* beside the destination; one that a killed process
left behind can be deleted.
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
      .groups = {kInput, kReading, kOutput, kRunning},
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
          "isoatlas check MESH [--self-intersections] [--json]\n"
          "isoatlas check MESH --volume VOLUME --iso X [options]",
      .description = R"(
Reads any triangle mesh and says whether it is a manifold (every edge in one or two triangles, the triangles of every
vertex one fan) and consistently oriented, and if so its components, Euler characteristic, genus and boundary loops;
then the shape of its triangles. The aspect ratio of a triangle is its shortest edge over its longest.

With --self-intersections it also looks for pairs of triangles that intersect, and lists the first of them. Two triangles
may touch in a vertex or an edge that they share by index, nowhere else; two vertices at the same place are two vertices.

With a volume it also measures, both ways, how far the mesh is from the isosurface: distances from samples of
the mesh to the surface and from samples of the surface to the mesh, and the angles between triangles and surface.
Distances do not change the exit status, unless the mesh is nowhere near the volume: then its coordinates are others than
--space says.
)",
      .groups = {kInput, kMesh, kDistance, kReading, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas check head.ply
isoatlas check head.ply --json | jq .genus
isoatlas check head.ply --self-intersections
isoatlas check head.ply --volume head.nrrd --iso 80.5
)"},
                   {"Exit status", kCheckExitStatus},
                   {"Files",
                    R"(Meshes: .ply, .stl, .obj, .off, .vtp, .3mf, .gii. Polygons are cut into
triangles; corners of an STL file at equal positions are one vertex. The
unit that a .3mf or .gii states is converted to the volume's.
)" + kVolumeFiles}},
  };
}

ManPage::Text levels_page() {
  return {
      .synopsis = "isoatlas levels FILE [--json]",
      .description = R"(
Prints a column for each level of detail in a file: vertices, triangles, largest and mean value of each metric, shape of the
triangles, topology; and whether the levels are nested, that is, whether the vertices of each are the first ones of the
next, bit by bit.

Topology and shape are counted again from the triangles, where the file has triangles. Metrics are what `extract` wrote
into the file; "-" where it has none.
)",
      .groups = {kInput, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas levels head.glb
isoatlas levels report.json
)"},
                   {"Exit status", kLevelsExitStatus},
                   {"Files",
                    R"(.glb and .vtm of isoatlas extract; .json: its report (then nothing can be
counted again) or the list of levels that --glb-per-level wrote.
)"}},
  };
}

ManPage::Text report_page() {
  return {
      .synopsis = "isoatlas report RESULT... -o FILE",
      .description = R"(
Writes one HTML file that shows results in 3-D, level by level, with their topology, certificate, shape and errors; it
needs nothing but a browser. With a report the page also says which command made the mesh, and compares the shape of its
triangles with marching cubes, if the volume is still where it was.
)",
      .groups = {kInput, kOutput, kRunning},
      .sections = {{"Examples",
                    R"(isoatlas extract head.nrrd --iso 80.5 -o head.glb --report head.json
isoatlas report head.json -o head.html

isoatlas report head.glb other.ply -o both.html
    Two results on one page, to compare.
)"},
                   {"Exit status", kExitStatus},
                   {"Files",
                    R"(.json: the report of isoatlas extract, whose meshes and volume are looked
for where it says and then beside it. .glb, .vtm: levels of detail. .ply,
.stl, .obj, .off, .vtp, .3mf, .gii: one mesh, of any program.
)"}},
  };
}

ManPage::Text picture_page() {
  return {
      .synopsis = "isoatlas picture RESULT -o FILE [options]",
      .description = R"(
Draws a mesh into a PNG or JPEG file, on white, in parallel projection. The extension of the name is the format.

VTK does the drawing and needs an X display; where there is none, Xvfb is started for the time that it takes (Debian:
package xvfb).
)",
      .groups = {kInput, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas picture head.ply -o head.png
isoatlas picture head.ply --view left -o left.jpg
isoatlas picture head.glb --level 0 --style hidden-line -o coarse.png
)"},
                   {"Exit status", kExitStatus},
                   {"Files",
                    R"(.glb, .vtm: levels of detail. .ply, .stl, .obj, .off, .vtp, .3mf, .gii: one
mesh.
)"}},
  };
}

ManPage::Text completion_page() {
  return {
      .synopsis = "isoatlas completion bash|zsh|fish",
      .description = R"(
Prints a script with which the shell completes commands, options, the words that options take, and file names. The Debian
package installs all three.
)",
      .groups = {kInput, kRunning},
      .sections = {{"Examples", R"(source <(isoatlas completion bash)
isoatlas completion zsh > ~/.zfunc/_isoatlas
isoatlas completion fish > ~/.config/fish/completions/isoatlas.fish
)"},
                   {"Exit status", kToolExitStatus},
                   {"Files", "None.\n"}},
  };
}

}  // namespace isoatlas::detail::tool
