// SPDX-License-Identifier: Apache-2.0
#include "pages.h"

#include <string>

namespace isoatlas::detail::tool {
namespace {

const std::string kExitStatus = R"(0    success
2    invalid argument or file; nothing was written
3    an internal check failed, a bug of isoatlas; nothing was written
4    out of memory, or above --max-memory; nothing was written
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM;
     nothing was written
)";

const std::string kExtractExitStatus = R"(0    success
1    everything was written (with --strict nothing), but a requested
     constraint is violated, a mesh has self-intersections, or a component
     is inverted or inside the wrong component; standard error has a line
     for each
2    invalid argument or file, or no surface; nothing was written
3    an internal check failed, a bug of isoatlas; nothing was written
4    out of memory, or above --max-memory; nothing was written
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM;
     nothing was written
)";

const std::string kToolExitStatus = R"(0    success
1    extract: everything was written, but a requested constraint is
     violated, a mesh has self-intersections, or a component is inverted or
     inside the wrong component;
     check, levels: a mesh is not a consistently oriented manifold;
     check --self-intersections: the mesh has self-intersections;
     check --volume: the mesh is nowhere near the volume
2    invalid argument or file, or no surface; nothing was written
3    an internal check failed, a bug of isoatlas; nothing was written
4    out of memory, or above --max-memory; nothing was written
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM;
     nothing was written
)";

const std::string kCheckExitStatus =
    R"(0    the mesh is a consistently oriented manifold, has at least one triangle
     and (with --self-intersections) no self-intersections
1    the mesh is not so, or is nowhere near the volume of --volume
2    invalid argument or file, or no surface
3    an internal check failed, a bug of isoatlas
4    out of memory, or above --max-memory
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM
)";

const std::string kLevelsExitStatus =
    R"(0    every level is a consistently oriented manifold with triangles
1    at least one level is not
2    invalid argument or file
3    an internal check failed, a bug of isoatlas
4    out of memory
129  stopped by SIGHUP, 130 by Ctrl-C (SIGINT), 143 by SIGTERM
)";

const std::string kViewExitStatus = R"(0    the page was closed, or Ctrl-C
2    invalid argument or file
3    an internal check failed, a bug of isoatlas
4    out of memory, or above --max-memory
)";

const std::string kVolumeFiles =
    R"(Volumes: NRRD (.nrrd, .nhdr), NIfTI-1 and -2 (.nii, .nii.gz, .hdr, .img),
MetaImage (.mha, .mhd), TIFF (.tif, .tiff; ImageJ, OME, LSM), DICOM (.dcm,
or a folder), a folder of TIFF or PNG slices, VTK (.vtk, .vti, .vtr, .pvti,
.pvtr), MGH (.mgh, .mgz), MRC (.mrc, .map, .rec), NumPy (.npy), Zarr and
OME-Zarr (a folder, or one of its resolutions, as a.zarr/2), HDF5 (.h5,
.hdf5, .ims), and headerless files (--raw-size, --raw-type). NIfTI, MGH and
MRC files may be compressed by gzip, NIfTI also by bzip2. Analyze files
(.hdr, .img) are read as well. The content of a file determines its format,
not its name.
)";

}  // namespace

ManPage::Text tool_page() {
  return {
      .synopsis =
          "isoatlas COMMAND [options]\n"
          "isoatlas help COMMAND",
      .description = R"(
Turns scalar volumes (CT, MRI, microscopy, distance fields, simulations) into triangle meshes. Every
mesh is a manifold and has, component by component, the topology of the full-resolution surface. A
certificate verifies this; a mesh that fails is never written.
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
      .common_options =
          R"(--iso X                the isovalue; `isoatlas info VOLUME` suggests values
-o, --output MESH      its extension is the format: .ply, .stl, .glb, ...
--max-distance LENGTH  largest distance between surface and mesh: 0.2mm or
                       1vx (voxel); larger: fewer triangles. Default: 0.5vx
--levels N             N levels of detail, with errors in equal ratios
--report FILE          all counts and measurements as JSON
--html FILE            a page that shows the mesh in 3-D, in any browser

isoatlas extract head.nrrd --iso 80.5 -o head.ply --html head.html
)",
      .description = R"(
Reads a volume, meshes the isosurface at X in nested levels of detail, checks the meshes and writes
them. Level 0 is the coarsest mesh: few triangles where the surface is smooth, more where its
topology needs them. Each further level keeps all vertices of the previous level and adds vertices
until it satisfies its constraints. Every level is a consistently oriented manifold, with boundary
where the volume boundary cuts the surface. It has, component by component, the topology of the
full-resolution surface. This is verified before anything is written.

--refine sets the constraints of one level. The other options of LEVELS set constraints for all
levels after level 0 (with --coarse: for level 0). If constraints conflict, the first on the command
line has priority. Topology has priority over all constraints. --levels chooses the bounds of all
levels; level 0 then also has a bound on its distance from the surface, and a recognisable shape.

A LENGTH is a number in the unit of the volume (2.5), a number with a unit (2.5mm, 0.2um), or a
multiple of the smallest spacing of the volume (3vx). Units are nm, um, mm, cm, m, A and in. They
are converted to the unit of the volume; if the volume states no unit, they are refused.

The same input gives the same bytes, for any number of threads.
)",
      .groups = {kInput, kSurface, kMesh, kLevels, kOutput, kReading, kBlockOptions, kRunning},
      .sections = {{"Examples", R"(isoatlas extract head.nrrd --iso 80.5 -o head.ply
    The surface at 80.5 within half a voxel, in world coordinates.

isoatlas extract head.nrrd --iso 80.5 --coarse -o head.ply
    The coarsest mesh that preserves the topology.

isoatlas extract head.nrrd --iso 80.5 -o head.glb \
    --refine max-distance:2vx --refine max-distance:0.5vx,normal-angle:20deg
    Three levels of detail in one file.

isoatlas extract head.nrrd --iso 80.5 -o head.glb --levels 4
    Four levels within 4, 2, 1 and 0.5 voxels.

isoatlas extract head.nrrd --iso 80.5 -o head-{level}.stl \
    --max-vertices 5000 --refine max-distance:1mm
    Writes head-0.stl and head-1.stl. The bound of 5000 vertices is first,
    so it has priority over 1 mm.

isoatlas extract dragon_sdf.nii.gz --iso 0 --inside below -o dragon.stl
    A signed distance field, negative inside.

isoatlas extract ct.mha --iso 300 --max-radius 20mm -o a.vtp --report r.json
    No disk is larger than 20 mm; r.json has all numbers.

gunzip -c ct.nrrd.gz | isoatlas extract - --iso 300 -o - > ct.ply
    From standard input to standard output.

isoatlas extract fuel.raw --raw-size 64,64,64 --raw-type uint8 --iso 70.5 \
    -o fuel.off
    A headerless file.
)"},
                   {"Exit status", kExtractExitStatus},
                   {"Files",
                    kVolumeFiles +
                        R"(Meshes: .ply and .stl (binary), .obj, .off, .vtp, .3mf and .gii hold the
finest level, or each level in its own file if the name has {level}. .glb
holds all levels (extension MSFT_lod); .vtm holds all levels, with a folder
of the same name. The extension determines the format.
.stl, .gii and .glb round coordinates to float32. The rounded mesh is read
back and checked, and the stated error includes the rounding. A .3mf states
the volume's unit; a .gii is in RAS and millimetres, for every --space.
With -o - the mesh goes to standard output, the summary to standard error.
Output files appear complete or not at all, and all files of a run together.
They are prepared in a hidden folder .isoatlas-* next to their destination.
A folder that a killed process left behind can be deleted.
)"}},
  };
}

ManPage::Text blocks_plan_page() {
  return {
      .synopsis = "isoatlas blocks plan VOLUME --iso X -o MESH --parts FOLDER [options]",
      .description = R"(
Plans to mesh a large volume in blocks, by one or several machines that share a folder. Writes
FOLDER/plan.json with the options, which are those of `isoatlas extract`. Meshes nothing yet.

Neighbouring blocks share one layer of samples, and their meshes fit there vertex by vertex. The
merged mesh has the topology of the isosurface of the whole volume. It does not depend on the order
of the blocks, or on the number of machines.
)",
      .groups = {kInput, kSurface, kMesh, kLevels, kOutput, kReading, kBlockOptions, kRunning},
      .sections = {{"Examples", R"(isoatlas blocks plan brain.nrrd --iso 80.5 -o brain.ply \
    --memory 4GiB --parts brain-parts
isoatlas blocks run brain-parts
isoatlas blocks merge brain-parts
)"},
                   {"Exit status", kExitStatus},
                   {"Files", kVolumeFiles + "FOLDER/plan.json: the plan.\n"}},
  };
}

ManPage::Text blocks_run_page() {
  return {
      .synopsis = "isoatlas blocks run FOLDER [options]",
      .description = R"(
Meshes the blocks of a plan that have no mesh yet, and writes each to its own file in FOLDER. A run
that was ended, in any way, continues where it was when it is started again. Several runs can work
in one folder: each leaves blocks alone that another one is making.
)",
      .groups = {kInput, kRunning},
      .sections = {{"Examples", R"(isoatlas blocks run brain-parts
isoatlas blocks run brain-parts --blocks 0:9
    Ten of the blocks, for example as one task of a job array.
)"},
                   {"Exit status", kExitStatus},
                   {"Files",
                    R"(FOLDER/block-000000.mesh and so on: the mesh of a block, with a digest of
its samples and options. A file appears whole or not at all. If samples or
options have changed, it is made again.
)"}},
  };
}

ManPage::Text blocks_merge_page() {
  return {
      .synopsis = "isoatlas blocks merge FOLDER [options]",
      .description = R"(
Merges the meshes of all blocks, checks the merged mesh, and writes the files that the plan names:
mesh, report and page.
)",
      .groups = {kInput, kRunning},
      .sections = {{"Examples", "isoatlas blocks merge brain-parts\n"},
                   {"Exit status", kExtractExitStatus},
                   {"Files", "Those of `isoatlas extract`, with the names of the plan.\n"}},
  };
}

ManPage::Text info_page() {
  return {
      .synopsis = "isoatlas info VOLUME [options]",
      .description = R"(
Prints size, sample type, spacing, origin, orientation, extent, range and memory of a volume. Counts
NaN and infinite samples. Draws a histogram with logarithmic heights. Suggests isovalues: thresholds
that split the samples into two and into three classes (Otsu's method), and 0 for data that looks
like a signed distance field.

The three letters of the orientation give the directions of the x, y and z axes in LPS world
coordinates: Left or Right, Posterior or Anterior, Superior or Inferior.
)",
      .groups = {kInput, kReading, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas info head.nrrd
isoatlas info fuel.raw --raw-size 64,64,64 --raw-type uint8
)"},
                   {"Exit status", kExitStatus},
                   {"Files", kVolumeFiles}},
  };
}

ManPage::Text view_page() {
  return {
      .synopsis = "isoatlas view VOLUME [options]",
      .description = R"(
Opens a page in the browser that shows slices of the volume with the isoline, the histogram with the
isovalue as a handle, and a coarse mesh that follows it. A region of interest, components, bounds
and levels are chosen there; the page saves the mesh, and shows the command line of
`isoatlas extract` that does the same.

The address is printed on standard output. It is served on the loopback interface only, with a
random token: only this machine can open it, and only who knows the address. From another machine,
forward a port: ssh -L 8000:127.0.0.1:8000, with --port 8000 --no-browser. The page loads nothing
from a network. Saved meshes go to the browser's downloads. The command ends when the page is
closed, or with Ctrl-C.
)",
      .groups = {kInput, kSurface, kReading, kRunning},
      .sections = {{"Examples", R"(isoatlas view head.nrrd
isoatlas view scan/ --series 2 --iso 300.5
)"},
                   {"Exit status", kViewExitStatus},
                   {"Files", kVolumeFiles}},
  };
}

ManPage::Text check_page() {
  return {
      .synopsis =
          "isoatlas check MESH [--self-intersections] [--json]\n"
          "isoatlas check MESH --volume VOLUME --iso X [options]",
      .description = R"(
Reads any triangle mesh and checks whether it is a manifold (every edge is in one or two triangles,
and the triangles around every vertex form one fan) and consistently oriented. For such a mesh,
prints components, Euler characteristic, genus and boundary loops. Also prints the extent, the area
and the enclosed volume of the mesh and of its largest components, and the shape of the triangles.
The aspect ratio of a triangle is its shortest edge divided by its longest.

With --self-intersections, also searches for pairs of triangles that intersect, and lists the first
ten. Two triangles may touch only in a vertex or an edge that they share by index. Two vertices at
the same position are two vertices.

With --volume, also measures the two-sided distance between mesh and isosurface: from samples of the
mesh to the surface, and from samples of the surface to the mesh. It also measures the angles
between triangles and surface. Distances do not change the exit status, unless the mesh is nowhere
near the volume; its coordinates are then probably not those of --space.
)",
      .groups = {kInput, kMesh, kDistance, kReading, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas check head.ply
isoatlas check head.ply --json | jq .genus,.extent.volume
isoatlas check head.ply --self-intersections
isoatlas check head.ply --volume head.nrrd --iso 80.5
)"},
                   {"Exit status", kCheckExitStatus},
                   {"Files",
                    R"(Meshes: .ply, .stl, .obj, .off, .vtp, .3mf, .gii. Polygons are
split into triangles. Corners of an STL file at equal positions become one
vertex. The unit of a .3mf or .gii is converted to that of the volume.
)" + kVolumeFiles}},
  };
}

ManPage::Text levels_page() {
  return {
      .synopsis = "isoatlas levels FILE [--json]",
      .description = R"(
Prints one column per level of detail in a file: vertices, triangles, maximum and mean of each
metric, triangle shape and topology. Also prints whether the levels are nested: whether the vertices
of each level are the first vertices of the next level, bit by bit.

Topology and shape are recounted from the triangles, if the file has triangles. Metrics are those
that `isoatlas extract` wrote into the file; "-" means that the file has none.
)",
      .groups = {kInput, kOutput, kRunning},
      .sections = {{"Examples", R"(isoatlas levels head.glb
isoatlas levels report.json
)"},
                   {"Exit status", kLevelsExitStatus},
                   {"Files",
                    R"(.glb and .vtm files of isoatlas extract; .json: its report, or the list of
levels that --glb-per-level writes. A .json has no triangles to recount.
)"}},
  };
}

ManPage::Text report_page() {
  return {
      .synopsis = "isoatlas report RESULT... -o FILE",
      .description = R"(
Writes one HTML file that shows results in 3-D, level by level, with their topology, certificate,
shape and errors. It needs only a browser. For a report, the page also shows the command that made
the mesh and, if the volume is still there, compares the shape of the triangles with marching cubes.
It names files without their folders.
)",
      .groups = {kInput, kOutput, kRunning},
      .sections = {{"Examples",
                    R"(isoatlas extract head.nrrd --iso 80.5 -o head.glb --report head.json
isoatlas report head.json -o head.html

isoatlas report head.glb other.ply -o both.html
    Compare two results on one page.
)"},
                   {"Exit status", kExitStatus},
                   {"Files",
                    R"(.json: a report of isoatlas extract. Its meshes and volume are searched for
at the paths in the report, then next to the report. .glb, .vtm: levels of
detail. .ply, .stl, .obj, .off, .vtp, .3mf, .gii: one mesh, of any program.
)"}},
  };
}

ManPage::Text picture_page() {
  return {
      .synopsis = "isoatlas picture RESULT -o FILE [options]",
      .description = R"(
Draws a mesh into a PNG or JPEG file, on a white background, in parallel projection. The extension
of the name is the format.

VTK draws the picture and needs OpenGL and an X display. Without a display, Xvfb is started for the
duration of the command (Debian: packages libopengl0 libgl1 libgl1-mesa-dri libx11-6 xvfb).
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
Prints a script with which the shell completes commands, options, the words that options take, and
file names. The Debian package installs the scripts of all three shells.
)",
      .groups = {kInput, kRunning},
      .sections = {{"Examples", R"(source <(isoatlas completion bash)
isoatlas completion zsh > ~/.zfunc/_isoatlas
isoatlas completion fish > ~/.config/fish/completions/isoatlas.fish
)"},
                   {"Exit status", kExitStatus},
                   {"Files", "None.\n"}},
  };
}

}  // namespace isoatlas::detail::tool
