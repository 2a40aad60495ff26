// SPDX-License-Identifier: Apache-2.0
#include "arguments.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/file_name.h"
#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "man_page.h"
#include "pages.h"
#include "wording/choices.h"

namespace isoatlas::detail::tool {
namespace {

/// Adds an option whose value is passed to `read`. Errors that `read` throws name the option.
template <class Read>
CLI::Option* add_value(CLI::App& app, const char* group, const std::string& name,
                       const char* placeholder, const std::string& description, Read read) {
  const auto callback = [read, name](const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      throw CLI::ValidationError(name, error.what());
    }
  };
  return app.add_option_function<std::string>(name, callback, description)
      ->type_name(placeholder)
      ->group(group);
}

/// Adds an option for a point that may be repeated.
template <class Read>
CLI::Option* add_repeated(CLI::App& app, const std::string& name, const char* placeholder,
                          const std::string& description, Read read) {
  const auto callback = [read, name](const std::vector<std::string>& texts) {
    try {
      for (const std::string& text : texts) read(text);
    } catch (const Error& error) {
      throw CLI::ValidationError(name, error.what());
    }
  };
  return app.add_option_function<std::vector<std::string>>(name, callback, description)
      ->type_name(placeholder)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(kSurface);
}

// Formatted by hand, so that the help texts start at the margin and stay readable.
// clang-format off
/// Adds the options that choose what to read from a volume file.
/// @param volume  the option that all of these need; null if the volume is a positional argument
void add_reading(CLI::App& app, ReadOptions& read, CLI::Option* volume = nullptr) {
  const auto add = [&](const std::string& name, const char* placeholder,
                       const std::string& description) {
    const auto set_option = [&read, name](const std::string& text) { set(read, name, text); };
    CLI::Option* option =
        add_value(app, kReading, "--" + name, placeholder, description, set_option);
    if (volume != nullptr) option->needs(volume);
    return option;
  };
  add("channel", "NAME", R"(
The channel, or the component of vector samples, to read: its name, or its number from 0. Needed if
the file has several; `isoatlas info` lists them.
)");
  add("time", "N", R"(
The time point to read, counted from 0. Needed if the file has several.
)");
  add("layer", "NAME", R"(
The layer of a segmentation file to read: its name, or its number from 0. Needed if the file has
several.
)");
  add("array", "NAME", R"(
The named array of a VTK file to read. Needed if the file has several.
)");
  add("series", "UID", R"(
The DICOM series or image to read: its number from 0 in the list of `isoatlas info`, or its UID.
Needed if the folder has several.
)");
  add("spacing", "SX,SY,SZ", R"(
Distance between samples along x, y and z. A unit may follow: 0.2,0.2,1um. Default: the file's
spacing.
)");
  add("roi", "X:X,Y:Y,Z:Z", R"(
Read only this region of interest: first and last sample along x, y and z, both included, counted
from 0. 10:99,0:63,: keeps all samples along z. The mesh has a boundary where the region ends.
Default: the whole volume.
)");
  CLI::Option* size = add("raw-size", "NX,NY,NZ", R"(
Number of samples along x, y and z of a headerless file; x runs fastest. Needs --raw-type.
)");
  CLI::Option* type = add("raw-type", "TYPE", R"(
Type of the samples of a headerless file: int8, uint8, int16, uint16, int32, uint32, int64,
uint64, float32 or float64.
)");
  CLI::Option* spacing = add("raw-spacing", "SX,SY,SZ", R"(
Distance between the samples of a headerless file along x, y and z. Default: 1,1,1.
)");
  CLI::Option* endian = add("raw-endian", "ORDER", R"(
Byte order of a headerless file: little or big. Default: little.
)");
  CLI::Option* offset = add("raw-offset", "BYTES", R"(
Number of bytes before the first sample of a headerless file. Default: 0.
)");
  add("max-memory", "SIZE", R"(
Refuse a volume whose samples need more memory than this: 8GiB, 500MB. Default: three quarters of
the machine's memory.
)");
  size->needs(type);
  type->needs(size);
  for (CLI::Option* option : {spacing, endian, offset}) option->needs(size);
}

void add_volume(CLI::App& app, VolumeArguments& volume, const char* help = R"(
File with a 3-D scalar image, folder with a DICOM series or image slices, or - for standard input.
See FILES.
)") {
  app.add_option("VOLUME", volume.path, help)->required()->group(kInput);
  add_reading(app, volume.read);
}
// clang-format on

/// Parses the format of a single file: an extension in any case, with or without its dot.
std::string stream_format(const std::string& text) {
  constexpr std::array<std::string_view, 8> kFormats{"ply", "stl", "obj", "off",
                                                     "vtp", "3mf", "gii", "glb"};
  const std::string format = lower_case(text.starts_with('.') ? text.substr(1) : text);
  if (std::ranges::find(kFormats, format) == kFormats.end())
    refuse_value("one of ply, stl, obj, off, vtp, 3mf, gii, glb", text);
  return format;
}

struct GoalOption {
  Quantity quantity;
  const char* placeholder;
  const char* description;
};

// clang-format off
constexpr std::array<GoalOption, kQuantityCount> kGoalOptions{{
    {Quantity::max_distance, "LENGTH",
     "Upper bound of the two-sided (Hausdorff) distance between surface and mesh."},
    {Quantity::mean_distance, "LENGTH",
     "Upper bound of the mean distance from the surface in a Voronoi cell to the mesh."},
    {Quantity::area_curvature, "RATIO",
     "Upper bound of the area of the surface in a Voronoi cell divided by its area projected along "
     "the triangle normals. Above 1."},
    {Quantity::area_curvature_smooth, "RATIO",
     "Same as --area-curvature, with normals interpolated between the vertices. Above 1."},
    {Quantity::geodesic_ratio, "RATIO",
     "Upper bound of the geodesic distance divided by the straight distance, from the site of a "
     "Voronoi cell to its boundary. Above 1."},
    {Quantity::normal_angle, "DEGREES",
     "Upper bound of the total change of the surface normal along the path from the site of a "
     "Voronoi cell to its boundary."},
    {Quantity::max_vertices, "N",
     "Largest number of vertices, 4 or more. Topology and the absence of self-intersections may "
     "need more."},
    {Quantity::min_vertices, "N", "Smallest number of vertices, 4 or more."},
    {Quantity::min_edge, "LENGTH", "Lower bound of the length of an edge."},
    {Quantity::max_edge, "LENGTH", "Upper bound of the length of an edge."},
    {Quantity::min_aspect, "RATIO",
     "Lower bound of the aspect ratio of a triangle: its shortest edge divided by its longest. "
     "Between 0 and 1."},
}};

/// Adds --refine and the constraints for all levels. They are evaluated after parsing, because
/// their priority is their order on the command line, which CLI11 stores apart from the values.
void add_goals(CLI::App& command, ExtractArguments& arguments) {
  const auto ignore = [](const auto&) {};
  CLI::Option* refine =
      command.add_option_function<std::vector<std::string>>("--refine", ignore, R"(
Add a level, refined from the previous level until it satisfies SPEC. SPEC is
METRIC:BOUND[,METRIC:BOUND...]; METRIC is the name of an option below, without the dashes. May be
repeated. Default: one level, at max-distance:0.5vx, or at an eighth of the largest spacing if that
is more.
)");
  refine->type_name("SPEC")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(kLevels);
  std::map<const CLI::Option*, Quantity> quantity_of;
  for (const GoalOption& goal : kGoalOptions) {
    const CLI::Option* option =
        command
            .add_option_function<std::string>("--" + std::string(name(goal.quantity)), ignore,
                                              goal.description)
            ->type_name(goal.placeholder)
            ->group(kLevels);
    quantity_of[option] = goal.quantity;
  }

  command.parse_complete_callback([&command, &arguments, refine, quantity_of] {
    std::vector<GoalArgument> found;
    std::size_t refined = 0;
    for (const CLI::Option* option : command.parse_order()) {
      const auto quantity = quantity_of.find(option);
      if (option != refine && quantity == quantity_of.end()) continue;
      try {
        if (option == refine)
          found.push_back({true, parse_level(refine->results().at(refined++))});
        else
          found.push_back({false, {parse_bound(quantity->second, option->results().at(0))}});
      } catch (const Error& error) {
        throw CLI::ValidationError((option == refine ? "--refine: " : "--") +
                                   std::string(error.what()));
      }
    }
    try {
      arguments.goals = plan_levels(found, arguments.coarse, arguments.options.levels);
    } catch (const Error& error) {
      throw CLI::ValidationError(error.what());
    }
  });
}
// clang-format on

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      ManPage::Text page) {
  CLI::App* command = app.add_subcommand(name, description);
  command->formatter(std::make_shared<ManPage>(std::move(page)));
  command->set_help_flag("-h,--help", "Print this page.")->group(kRunning);
  return command;
}

Size3 parse_block_size(const std::string& text) {
  constexpr const char* kExpected = "one or three numbers of grid cells, 1 or more, like 256";
  if (text.find(',') == std::string::npos) {
    const auto side = parse_whole<std::size_t>(text);
    if (!side || *side == 0) refuse_value(kExpected, text);
    return {*side, *side, *side};
  }
  return parse_triple<std::size_t>(text, kExpected, [](std::size_t n) { return n > 0; });
}

// clang-format off
CLI::App* add_extract_options(CLI::App* command, ExtractArguments& arguments) {
  ExtractOptions& options = arguments.options;

  add_volume(*command, arguments.volume);
  add_value(*command, kInput, "--nan", "SIDE", R"(
Side of the isovalue on which NaN samples are: below or above. Infinite samples are on the side of
their sign. Default: volumes with NaN or infinite samples are refused.
)", [&](const std::string& text) { set(arguments, "nan", text); });

  CLI::Option* iso = add_value(*command, kSurface, "--iso", "X", R"(
The isovalue. `isoatlas info` suggests values. For integer samples, use a value between two
integers, like 80.5, so that no sample equals it.
)", [&](const std::string& text) { set(arguments, "iso", text); })->required();
  CLI::Option* label = add_repeated(*command, "--label", "N", R"(
For a segmentation, in place of --iso: mesh the samples with this label. May be repeated; the
labels are then meshed as one part. The surface is the isosurface at 0 of a smooth field in which
every sample keeps its side, with the components, tunnels and cavities of the segmentation, where
samples that touch at an edge are connected. --topology is faces.
)", [&arguments, iso](const std::string& text) {
    const auto number = parse_whole<std::int64_t>(text);
    if (!number) refuse_value("the whole number of a label", text);
    arguments.labels.push_back(*number);
    iso->required(false);
  });
  label->trigger_on_parse()->excludes(iso);
  add_value(*command, kSurface, "--connectivity", "N", R"(
Which samples with the labels are connected: 18, across faces and edges; 6, across faces only; or
field, as the smooth field happens to be between them. Default: 18.
)", [&arguments](const std::string& text) {
    if (text == "18") arguments.mask.connectivity = MaskConnectivity::inside_18;
    else if (text == "6") arguments.mask.connectivity = MaskConnectivity::inside_6;
    else if (text == "field") arguments.mask.connectivity = MaskConnectivity::field;
    else refuse_value("one of 18, 6, field", text);
  })->needs(label);
  add_value(*command, kSurface, "--save-field", "FILE", R"(
Also write the smooth field of the labels, as .nrrd. `isoatlas check --volume FILE --iso 0
--topology faces` compares meshes with it.
)", [&arguments](const std::string& text) {
    if (!text.ends_with(".nrrd")) refuse_value("a name that ends in .nrrd", text);
    arguments.field = text;
  })->needs(label);
  add_value(*command, kSurface, "--inside", "SIDE", R"(
Side of the isovalue that is inside: above or below. Triangles face outwards. A sample equal to the
isovalue is inside in both cases. Default: above.
)", [&](const std::string& text) { set(arguments, "inside", text); })->excludes(label);
  add_value(*command, kSurface, "--topology", "NAME", R"(
Topology of the surface inside a grid cell. trilinear: that of the trilinear interpolant, where a
tunnel can join two closed loops on the faces of the cell. faces: one disk for each closed loop.
Default: trilinear.
)", [&](const std::string& text) { set(arguments, "topology", text); })->excludes(label);
  add_value(*command, kSurface, "--interpolation", "NAME", R"(
Interpolation between samples: trilinear or tricubic (smooth). Affects vertex positions and
distances. Affects the topology only together with --supersample. Default: trilinear.
)", [&](const std::string& text) { set(arguments, "interpolation", text); });
  add_value(*command, kSurface, "--supersample", "K", R"(
Mesh the volume upsampled K times along each axis with --interpolation, for details that are too
fine for the grid. Needs about K*K times the time and memory, and an eighth of a byte per upsampled
sample. Default: 1.
)", [&](const std::string& text) { set(arguments, "supersample", text); });
  add_value(*command, kSurface, "--adaptive-supersample", "N", R"(
Upper limit, per refined level, on how often the surface is subdivided where a bound cannot be
satisfied otherwise: 0 (never) to 8. Stops earlier where subdivision hardly helps. Subdivision that
separates self-intersections is not limited. Default: 6.
)", [&](const std::string& text) { set(arguments, "adaptive-supersample", text); });

  add_value(*command, kSurface, "--min-component-size", "SIZE", R"(
Drop components that enclose a smaller volume: 10vx (ten voxels), 2.5 (the volume's unit cubed) or
2.5mm3. The volume boundary caps components that it cuts. Components connected by the cap count as
one part. Default: keep all.
)", [&](const std::string& text) { set(arguments, "min-component-size", text); });
  add_value(*command, kSurface, "--keep-components", "N", R"(
Keep only the N largest components. If the volume boundary cuts a part into several components, all
of them are kept. Default: keep all.
)", [&](const std::string& text) { set(arguments, "keep-components", text); });

  add_repeated(*command, "--keep-near", "X,Y,Z", R"(
Keep only the component that is nearest to this point, in the coordinates of the mesh. May be
repeated. If the volume boundary cuts a part into several components, all of them are kept. Default:
keep all.
)", [&](const std::string& text) { set(arguments, "keep-near", text); });
  add_repeated(*command, "--drop-near", "X,Y,Z", R"(
Drop the component that is nearest to this point. May be repeated. Default: drop none.
)", [&](const std::string& text) { set(arguments, "drop-near", text); });

  command->add_flag("--coarse", arguments.coarse, R"(
Mesh only level 0, the coarsest mesh that preserves the topology. Constraints are checked on level
0, but not enforced.
)")->group(kMesh);
  add_value(*command, kMesh, "--max-radius", "LENGTH", R"(
Largest radius of the disks that cover the surface. A smaller radius gives more triangles. Default:
half the longest side of the volume.
)", [&](const std::string& text) { set(arguments, "max-radius", text); });
  add_value(*command, kMesh, "--covering", "NAME", R"(
How disks cover the surface. sizing-field: the radii follow a field that grows slowly away from
places that need small radii. halving: the paper's method, for comparison; radii are halved until
adjacent disks are compatible. Default: sizing-field.
)", [&](const std::string& text) { set(arguments, "covering", text); });
  add_value(*command, kMesh, "--event-persistence", "LENGTH", R"(
Ignore holes in a growing disk that close again within this length. A larger length ignores more
noise in the choice of triangle sizes. Every value preserves the topology. Default: 1.5vx; with
--covering halving 0.
)", [&](const std::string& text) { set(arguments, "event-persistence", text); });
  add_value(*command, kMesh, "--border", "HOW", R"(
The mesh where the volume boundary cuts the surface. open: it ends there. closed: it is closed by
planar caps on the volume boundary, as if everything beyond were outside; for 3-D printing and
volumes. Default: open.
)", [&](const std::string& text) { set(arguments, "border", text); });
  add_value(*command, kMesh, "--placement", "WHERE", R"(
Placement of the vertices. surface: on the isosurface, the same in all levels. balanced: displaced
in each level so that the mesh lies evenly on both sides of the surface. Default: surface.
)", [&](const std::string& text) { set(arguments, "placement", text); });
  command->add_flag("--allow-self-intersections", options.allow_self_intersections, R"(
Keep triangles that intersect. This is faster and gives fewer triangles. Default: no two triangles
of a level intersect.
)")->group(kMesh);
  add_value(*command, kLevels, "--levels", "N", R"(
Make N levels of detail, 1 to 16. The finest has the bound --max-distance (default: as without
--levels); each coarser one has twice the bound of the next, or less, so that the coarsest keeps a
recognisable shape. The other bounds hold in every level.
)", [&](const std::string& text) { set(arguments, "levels", text); });
  add_goals(*command, arguments);
  command->add_flag("--strict", arguments.strict, R"(
Write nothing if the exit status would be 1: a requested bound is violated, a mesh has
self-intersections, or a component is inverted or inside the wrong component. Default: write
everything.
)")->group(kOutput);

  command->add_option("-o,--output", arguments.mesh, R"(
The mesh to write. The extension of its name is the format: .glb and .vtm hold all levels, other
formats the finest. NAME-{level}.ply is one file per level; - is standard output. See FILES.
)")->type_name("MESH")->required()->group(kOutput);
  add_value(*command, kOutput, "--format", "EXT", R"(
Format of -o -: ply, stl, obj, off, vtp, 3mf, gii or glb. Default: ply.
)", [&](const std::string& text) { arguments.format = stream_format(text); });
  command->add_flag("--glb-per-level", arguments.glb_per_level, R"(
Also write each level to its own file. For -o NAME.glb these are NAME-0.glb, NAME-1.glb, ...;
NAME.json lists them.
)")->group(kOutput);
  command->add_option("--report", arguments.report, R"(
Write topology, certificates, metrics, constraints, triangle shapes, timings and memory as JSON. See
docs/reference/report.md. - is standard output, if the mesh does not go there.
)")->type_name("FILE")->group(kOutput);
  command->add_option("--html", arguments.page, R"(
Write a page that shows the levels in 3-D with their data. It opens in any browser, without a
network. It names files without their folders. See docs/report.md.
)")->type_name("FILE")->group(kOutput);
  command->add_option("--neuroglancer", arguments.neuroglancer, R"(
Also write all levels for Neuroglancer into a folder, as a multi-resolution mesh. See docs/scale.md.
)")->type_name("FOLDER")->group(kOutput);
  add_value(*command, kOutput, "--space", "SPACE", R"(
Coordinates of the mesh. lps: world coordinates as in ITK. ras: the same with x and y negated.
voxel: sample indices. Default: lps.
)", [&](const std::string& text) { set(arguments, "space", text); });

  const auto measure_levels = [&options] { options.measure_samples = kMeasureSamples; };
  CLI::Option* measure = command->add_flag_callback("--measure", measure_levels, R"(
Measure the two-sided distance between each level and the isosurface, with 200,000 samples in each
direction.
)")->group(kOutput);
  CLI::Option* samples = add_value(*command, kOutput, "--measure-samples", "N", R"(
Same as --measure, with N samples in each direction.
)", [&](const std::string& text) { set(arguments, "measure-samples", text); });
  measure->excludes(samples);

  add_value(*command, kRunning, "--threads", "N", R"(
Number of threads; 0 uses all that the machine has. The result does not depend on it. Default: 0.
)", [&](const std::string& text) { set(arguments, "threads", text); });
  CLI::Option* memory = add_value(*command, kBlockOptions, "--memory", "SIZE", R"(
Mesh a large volume in blocks that take about this much memory each: 4GiB, 800MB. Samples of
uncompressed files are then read where they are needed.
)", [&](const std::string& text) { arguments.memory = parse_bytes(text); });
  add_value(*command, kBlockOptions, "--block-size", "NX,NY,NZ", R"(
Mesh the volume in blocks of this many grid cells along x, y and z; one number for cubes.
)", [&](const std::string& text) { arguments.block_size = parse_block_size(text); })
      ->excludes(memory);
  command->add_option("--parts", arguments.parts, R"(
Keep the meshes of the blocks in this folder. A run that was ended continues with those that are
there. Default: in memory.
)")->type_name("FOLDER")->group(kBlockOptions);
  CLI::Option* quiet = command->add_flag("-q,--quiet", arguments.quiet, R"(
Print nothing unless something is wrong; no progress bar.
)");
  CLI::Option* verbose = command->add_flag("-v,--verbose", arguments.verbose, R"(
Also print all metrics of the levels, timings, coarser complexes, repairs and memory.
)");
  quiet->excludes(verbose)->group(kRunning);
  verbose->group(kRunning);
  return command;
}
// clang-format on

void add_folder(CLI::App& command, BlocksArguments& arguments) {
  command.add_option("FOLDER", arguments.folder, "The folder of `isoatlas blocks plan --parts`.")
      ->required()
      ->group(kInput);
  add_value(command, kRunning, "--threads", "N", "Number of threads. Default: that of the plan.",
            [&](const std::string& text) { arguments.threads = parse_threads(text); });
  command.add_flag("-q,--quiet", arguments.quiet, "Print nothing unless something is wrong.")
      ->group(kRunning);
}

BlockRange parse_range(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto first = parse_whole<std::size_t>(std::string_view(text).substr(0, colon));
  const auto last = colon == std::string::npos
                        ? first
                        : parse_whole<std::size_t>(std::string_view(text).substr(colon + 1));
  if (!first || !last || *last < *first)
    refuse_value("numbers of blocks like 0:9, or one number", text);
  return {*first, *last + 1};
}

}  // namespace

CLI::App* add_extract_command(CLI::App& app, ExtractArguments& arguments) {
  return add_extract_options(
      add_command(app, "extract", "mesh an isosurface, with certified topology", extract_page()),
      arguments);
}

CLI::App* add_blocks_plan_command(CLI::App& app, ExtractArguments& arguments) {
  CLI::App* command =
      add_command(app, "blocks-plan", "cut a large volume into blocks", blocks_plan_page());
  add_extract_options(command, arguments);
  command->get_option("--parts")->required();
  return command;
}

CLI::App* add_blocks_run_command(CLI::App& app, BlocksArguments& arguments) {
  CLI::App* command =
      add_command(app, "blocks-run", "mesh the blocks of a plan", blocks_run_page());
  add_folder(*command, arguments);
  add_value(*command, kInput, "--blocks", "FIRST:LAST",
            "Only these blocks, both included, counted from 0. Default: all.",
            [&](const std::string& text) { arguments.range = parse_range(text); });
  return command;
}

CLI::App* add_blocks_merge_command(CLI::App& app, BlocksArguments& arguments) {
  CLI::App* command =
      add_command(app, "blocks-merge", "merge the meshes of all blocks", blocks_merge_page());
  add_folder(*command, arguments);
  command->add_flag("-v,--verbose", arguments.verbose, "Print details, as `isoatlas extract -v`.")
      ->group(kRunning);
  return command;
}

CLI::App* add_info_command(CLI::App& app, InfoArguments& arguments) {
  CLI::App* command =
      add_command(app, "info", "describe a volume and suggest isovalues", info_page());
  add_volume(*command, arguments.volume);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")
      ->group(kOutput);
  return command;
}

// clang-format off
CLI::App* add_view_command(CLI::App& app, ViewArguments& arguments) {
  CLI::App* command =
      add_command(app, "view", "choose an isovalue by looking, in the browser", view_page());
  add_volume(*command, arguments.volume, R"(
File with a 3-D scalar image, or folder with a DICOM series or image slices. See FILES.
)");
  add_value(*command, kSurface, "--iso", "X", R"(
The first isovalue. Default: the first that `isoatlas info` suggests.
)", [&](const std::string& text) { arguments.isovalue = parse_finite(text); });
  add_value(*command, kSurface, "--inside", "SIDE", R"(
Side of the isovalue that is inside at first: above or below. Default: below for signed distances,
else above.
)", [&](const std::string& text) { arguments.inside = parse_inside(text); });
  command->add_flag_callback("--no-browser", [&] { arguments.opens_browser = false; }, R"(
Only print the address of the page; open no browser.
)")->group(kRunning);
  add_value(*command, kRunning, "--port", "N", R"(
The port of the loopback interface, 1 to 65535. Default: any free one.
)", [&](const std::string& text) {
    const auto port = parse_whole<std::uint16_t>(text);
    if (!port || *port == 0) refuse_value("a whole number from 1 to 65535", text);
    arguments.port = *port;
  });
  command->add_flag("-q,--quiet", arguments.quiet, "Print nothing but the address.")
      ->group(kRunning);
  command->parse_complete_callback([command, &arguments] {
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_group() != kReading || option->count() == 0) continue;
      arguments.reading.push_back("--" + option->get_single_name());
      arguments.reading.push_back(option->results().at(0));
    }
  });
  return command;
}

CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments) {
  CLI::App* command =
      add_command(app, "check", "check the topology, shape and distance of a mesh", check_page());
  MeasureOptions& options = arguments.measure;

  command->add_option("MESH", arguments.mesh, "The mesh to check. See FILES.")
      ->required()
      ->group(kInput);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")
      ->group(kOutput);

  command->add_flag("--self-intersections", arguments.self_intersections, R"(
Search for triangles that intersect, with exact arithmetic. Two triangles may touch only in a vertex
or an edge that they share.
)")->group(kMesh);

  CLI::Option* volume = command->add_option("--volume", arguments.volume, R"(
Measure the two-sided distance between the mesh and the isosurface of this volume: a file, a folder,
or - for standard input. Needs --iso. See FILES.
)")->type_name("VOLUME")->group(kDistance);
  CLI::Option* iso = add_value(*command, kDistance, "--iso", "X", R"(
The isovalue.
)", [&](const std::string& text) { set(options, "iso", text); });
  CLI::Option* inside = add_value(*command, kDistance, "--inside", "SIDE", R"(
Side of the isovalue that is inside: above or below. Determines the expected orientation of
triangles. Default: above.
)", [&](const std::string& text) { set(options, "inside", text); });
  CLI::Option* topology = add_value(*command, kDistance, "--topology", "NAME", R"(
Topology of the surface inside a grid cell: trilinear or faces, as for `isoatlas extract`. Default:
trilinear.
)", [&](const std::string& text) { set(options, "topology", text); });
  CLI::Option* nan = add_value(*command, kDistance, "--nan", "SIDE", R"(
Side of the isovalue on which NaN samples are: below or above, as for `isoatlas extract`. Default:
volumes with NaN or infinite samples are refused.
)", [&](const std::string& text) { set(options, "nan", text); });
  CLI::Option* interpolation = add_value(*command, kDistance, "--interpolation", "NAME", R"(
Interpolation between samples: trilinear or tricubic, as for `isoatlas extract`. Default: trilinear.
)", [&](const std::string& text) { set(options, "interpolation", text); });
  CLI::Option* space = add_value(*command, kDistance, "--space", "SPACE", R"(
Coordinates of the mesh: lps, ras or voxel, as for `isoatlas extract`. Default: the space that the
file states (SPACE=... in its header or comments), else lps.
)", [&](const std::string& text) { arguments.space = parse_space(text); });
  CLI::Option* samples = add_value(*command, kDistance, "--samples", "N", R"(
Number of samples spread over the area of each of the two surfaces. Vertices, edge midpoints,
centroids and c-vertices are sampled as well. Default: 200000.
)", [&](const std::string& text) { set(options, "samples", text); });
  add_reading(*command, arguments.read, volume);

  volume->needs(iso);
  for (CLI::Option* option : {iso, inside, topology, nan, interpolation, space, samples})
    option->needs(volume);
  return command;
}
// clang-format on

CLI::App* add_levels_command(CLI::App& app, LevelsArguments& arguments) {
  CLI::App* command =
      add_command(app, "levels", "compare the levels of detail in a file", levels_page());
  command
      ->add_option("FILE", arguments.file,
                   "A .glb or .vtm of `isoatlas extract`, or its report. See FILES.")
      ->required()
      ->group(kInput);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")
      ->group(kOutput);
  return command;
}

CLI::App* add_report_command(CLI::App& app, ReportArguments& arguments) {
  CLI::App* command =
      add_command(app, "report", "write a page that shows results in 3-D", report_page());
  command
      ->add_option("RESULT", arguments.results,
                   "A result of `isoatlas extract`: a report, a file of levels, or one mesh. "
                   "See FILES.")
      ->required()
      ->group(kInput);
  command->add_option("-o,--output", arguments.page, "The page to write.")
      ->type_name("FILE")
      ->required()
      ->group(kOutput);
  command->add_flag("-q,--quiet", arguments.quiet, "Print nothing unless something is wrong.")
      ->group(kRunning);
  return command;
}

namespace {

Vec3 parse_direction(const std::string& text) {
  constexpr const char* kExpected = "three numbers like 0.45,-1,0.35, not all 0";
  const auto [x, y, z] =
      parse_triple<double>(text, kExpected, [](double v) { return std::isfinite(v); });
  if (x == 0 && y == 0 && z == 0) refuse_value(kExpected, text);
  return Vec3{x, y, z};
}

bool is_name_of_view(const std::string& text) {
  const std::string word = plain_word(text);
  return !word.empty() && word[0] >= 'a' && word[0] <= 'z';
}

/// Names refer to a patient in LPS: x points to the left, y to the back, z to the head.
Vec3 parse_view(const std::string& text) {
  if (!is_name_of_view(text)) return parse_direction(text);
  const std::string word = plain_word(text);
  if (word == "front") return {0, -1, 0};
  if (word == "back") return {0, 1, 0};
  if (word == "left") return {1, 0, 0};
  if (word == "right") return {-1, 0, 0};
  if (word == "top") return {0, 0, 1};
  if (word == "bottom") return {0, 0, -1};
  refuse_value("one of front, back, left, right, top, bottom, or three numbers like 0.45,-1,0.35",
               text);
}

}  // namespace

// clang-format off
CLI::App* add_picture_command(CLI::App& app, PictureArguments& arguments) {
  CLI::App* command =
      add_command(app, "picture", "draw a mesh into a PNG or JPEG file", picture_page());
  PictureOptions& options = arguments.options;
  command->add_option("RESULT", arguments.mesh, "A mesh, or a file of levels. See FILES.")
      ->required()
      ->group(kInput);
  add_value(*command, kInput, "--level", "K", R"(
The level to draw, of a file of levels; 0 is the coarsest. Default: the finest.
)", [&](const std::string& text) {
    arguments.level = parse_whole<std::uint32_t>(text);
    if (!arguments.level) refuse_value("a level's number, 0 or more", text);
  });
  command
      ->add_option("-o,--output", arguments.picture, "The picture to write: .png, .jpg or .jpeg.")
      ->type_name("FILE")
      ->required()
      ->group(kOutput);
  add_value(*command, kOutput, "--style", "NAME", R"(
Style of the drawing. smooth: shaded. hidden-line: visible edges, dark on white. Default: smooth.
)", [&](const std::string& text) {
    const std::string style = plain_word(text);
    if (style != "smooth" && style != "hidden-line")
      refuse_value("one of smooth, hidden-line", text);
    options.style = style == "smooth" ? PictureStyle::smooth : PictureStyle::hidden_line;
  });
  add_value(*command, kOutput, "--size", "WIDTH,HEIGHT", R"(
Size of the picture in pixels, 16 to 8192 each. Default: 1200,900.
)", [&](const std::string& text) {
    const std::size_t comma = text.find(',');
    const auto width = parse_whole<int>(std::string_view(text).substr(0, comma));
    const auto height = comma == std::string::npos
                            ? std::nullopt
                            : parse_whole<int>(std::string_view(text).substr(comma + 1));
    const auto is_possible = [](std::optional<int> pixels) {
      return pixels && *pixels >= 16 && *pixels <= 8192;
    };
    if (!is_possible(width) || !is_possible(height))
      refuse_value("two whole numbers from 16 to 8192 like 1200,900", text);
    options.width = *width;
    options.height = *height;
  });
  add_value(*command, kOutput, "--view", "X,Y,Z", R"(
Direction from the mesh to the viewer, in its coordinates; or the side of a patient that is seen:
front, back, left, right, top or bottom. In LPS these are -y, y, x, -x, z and -z; in RAS x and y are
negated. Default: the front from slightly above, 0.45,-1,0.35 in LPS.
)", [&](const std::string& text) {
    options.view = parse_view(text);
    arguments.view_is_in_lps = is_name_of_view(text);
  });
  add_value(*command, kOutput, "--up", "X,Y,Z", R"(
Direction that points up in the picture. 0,0,-1 corrects a picture that is upside down. Default:
0,0,1; in views along z the front, 0,-1,0 or in RAS 0,1,0.
)", [&](const std::string& text) { options.up = parse_direction(text); });
  add_value(*command, kOutput, "--zoom", "FACTOR", R"(
Magnification relative to a mesh that fills the picture. Default: 1.
)", [&](const std::string& text) {
    options.zoom = parse_finite(text);
    if (!(options.zoom > 0)) refuse_value("a number above 0", text);
  });
  command->add_flag("-q,--quiet", arguments.quiet, "Print nothing unless something is wrong.")
      ->group(kRunning);
  return command;
}
// clang-format on

CLI::App* add_completion_command(CLI::App& app, CompletionArguments& arguments) {
  CLI::App* command =
      add_command(app, "completion", "print a script for shell completion", completion_page());
  command->add_option("SHELL", arguments.shell, "The shell: bash, zsh or fish.")
      ->required()
      ->group(kInput);
  return command;
}

void describe_tool(CLI::App& app) {
  app.name("isoatlas");
  app.description("isosurfaces as adaptive triangle meshes, with certified topology");
  app.formatter(std::make_shared<ManPage>(tool_page()));
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "Print this page.")->group(kRunning);
  app.set_version_flag("--version", "isoatlas " ISOATLAS_VERSION, "Print the version.")
      ->group(kRunning);
}

}  // namespace isoatlas::detail::tool
