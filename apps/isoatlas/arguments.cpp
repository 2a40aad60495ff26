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

/// An option with a value that `read` makes something of; what that throws names the option.
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

// Options read as a page: prose at the margin, then what it does.
// clang-format off
/// How to read a volume.
/// @param volume  the option that all of these need; null: the volume is an argument of its own
void add_reading(CLI::App& app, ReadOptions& read, CLI::Option* volume = nullptr) {
  const auto add = [&](const std::string& name, const char* placeholder, const std::string& description) {
    CLI::Option* option = add_value(app, kReading, "--" + name, placeholder, description,
                                    [&read, name](const std::string& text) { set(read, name, text); });
    if (volume != nullptr) option->needs(volume);
    return option;
  };
  add("channel", "NAME", R"(
Which of several channels, or of several values per sample, to read: its name, or its number from 0. `isoatlas info`
lists them.
)");
  add("time", "N", R"(
Which of several time points to read; the first is 0.
)");
  add("layer", "NAME", R"(
Which layer of a segmentation file to read: its name, or its number from 0.
)");
  add("array", "NAME", R"(
Which of several named arrays of a VTK file to read.
)");
  add("series", "UID", R"(
Which of several DICOM series or images to read: its number from 0 in the list that `isoatlas info` prints, or its UID.
)");
  add("spacing", "SX,SY,SZ", R"(
Distance between samples along x, y and z, in place of the file's. A unit may follow: 0.2,0.2,1um.
)");
  add("roi", "X:X,Y:Y,Z:Z", R"(
Read only this part of the volume: from which sample to which along x, y and z, both included, counted from 0. 10:99,0:63,:
keeps all along z. The mesh ends where the part does.
)");
  CLI::Option* size = add("raw-size", "NX,NY,NZ", R"(
The file has no header: samples along x, y and z, x running fastest.
)");
  CLI::Option* type = add("raw-type", "TYPE", R"(
Type of headerless samples: int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32 or float64.
)");
  CLI::Option* spacing = add("raw-spacing", "SX,SY,SZ", R"(
Distance between headerless samples along x, y and z. Default: 1,1,1.
)");
  CLI::Option* endian = add("raw-endian", "ORDER", R"(
Byte order of headerless samples: little or big. Default: little.
)");
  CLI::Option* offset = add("raw-offset", "BYTES", R"(
Bytes to skip before the first headerless sample. Default: 0.
)");
  add("max-memory", "SIZE", R"(
Refuse a volume whose samples take more: 8GiB, 500MB. Default: three quarters of the machine's memory.
)");
  size->needs(type);
  type->needs(size);
  for (CLI::Option* option : {spacing, endian, offset}) option->needs(size);
}

void add_volume(CLI::App& app, VolumeArguments& volume) {
  app.add_option("VOLUME", volume.path, "File with a 3-D scalar image, folder with a DICOM series or image slices, or - for standard input. See FILES.")
      ->required()
      ->group(kInput);
  add_reading(app, volume.read);
}
// clang-format on

/// The formats that are one file: an extension in any case, with or without its dot.
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
    {Quantity::max_distance, "LENGTH", "Largest distance between surface and mesh, both ways."},
    {Quantity::mean_distance, "LENGTH", "Mean distance of a cell's part of the surface from the mesh."},
    {Quantity::area_curvature, "RATIO", "Area of a cell's part of the surface over its area as seen along the triangles' normals; above 1."},
    {Quantity::area_curvature_smooth, "RATIO", "The same with normals interpolated between the vertices; above 1."},
    {Quantity::geodesic_ratio, "RATIO", "Distance along the surface over straight distance, from a cell's site to its border; above 1."},
    {Quantity::normal_angle, "DEGREES", "Total change of the surface normal along the path from a Voronoi cell's site to its boundary."},
    {Quantity::max_vertices, "N", "No more vertices than N."},
    {Quantity::min_vertices, "N", "No fewer vertices than N."},
    {Quantity::min_edge, "LENGTH", "No shorter edge."},
    {Quantity::max_edge, "LENGTH", "No longer edge."},
    {Quantity::min_aspect, "RATIO", "No triangle whose shortest edge is a smaller part of its longest; between 0 and 1."},
}};

/// --refine and the options that hold for all levels. They are read when all are there: their order on the command
/// line, which CLI11 keeps apart from the values, is their priority.
void add_goals(CLI::App& command, ExtractArguments& arguments) {
  const auto ignore = [](const auto&) {};
  CLI::Option* refine = command.add_option_function<std::vector<std::string>>("--refine", ignore, R"(
One more level, refined from the last one until it meets SPEC, METRIC:BOUND[,METRIC:BOUND...]; METRIC is one of the
options below without the dashes. May be given again and again. Without it there is one such level, at max-distance:0.5vx,
or an eighth of the largest spacing where that is more.
)");
  refine->type_name("SPEC")->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->group(kLevels);
  std::map<const CLI::Option*, Quantity> quantity_of;
  for (const GoalOption& option : kGoalOptions)
    quantity_of[command.add_option_function<std::string>("--" + std::string(name(option.quantity)), ignore, option.description)
                    ->type_name(option.placeholder)
                    ->group(kLevels)] = option.quantity;

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
        throw CLI::ValidationError((option == refine ? "--refine: " : "--") + std::string(error.what()));
      }
    }
    try {
      arguments.goals = plan_levels(found, arguments.coarse);
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

}  // namespace

// clang-format off
CLI::App* add_extract_command(CLI::App& app, ExtractArguments& arguments) {
  CLI::App* command = add_command(app, "extract", "mesh an isosurface, with certified topology", extract_page());
  ExtractOptions& options = arguments.options;

  add_volume(*command, arguments.volume);
  add_value(*command, kInput, "--nan", "SIDE", R"(
NaN and infinite samples are refused unless this says where NaN is: below or above the isovalue. Infinities are then on
the side of their sign.
)", [&](const std::string& text) { set(arguments, "nan", text); });

  add_value(*command, kSurface, "--iso", "X", R"(
The isovalue. `isoatlas info` suggests some. For integer samples a value between two integers, like 80.5, is best: no
sample equals it.
)", [&](const std::string& text) { set(arguments, "iso", text); })->required();
  add_value(*command, kSurface, "--inside", "SIDE", R"(
Which samples are inside: those above or those below the isovalue. Triangles face outwards. A sample equal to the
isovalue is inside either way. Default: above.
)", [&](const std::string& text) { set(arguments, "inside", text); });
  add_value(*command, kSurface, "--topology", "NAME", R"(
What the surface is inside a cell of the volume. trilinear: what the trilinear interpolant has there; it can join two
closed loops on the cell's faces by a tunnel. faces: one disk for every such loop. Default: trilinear.
)", [&](const std::string& text) { set(arguments, "topology", text); });
  add_value(*command, kSurface, "--interpolation", "NAME", R"(
What the surface is between samples, for where vertices are and for all distances: trilinear or tricubic. Tricubic is
smooth. The topology is the same, unless supersampled. Default: trilinear.
)", [&](const std::string& text) { set(arguments, "interpolation", text); });
  add_value(*command, kSurface, "--supersample", "K", R"(
Mesh the surface of the volume upsampled K times along each axis by the interpolation, for details that its grid is too
coarse for. Takes an eighth of a byte for each of its samples, and as much more time and memory as there is more of the
surface, about K*K. Default: 1.
)", [&](const std::string& text) { set(arguments, "supersample", text); });
  add_value(*command, kSurface, "--adaptive-supersample", "N", R"(
How often, in each refined level, the surface may be sampled more finely at places where a bound cannot be kept
otherwise, from 0, never, to 8. Stops earlier where this hardly helps. Subdivision that removes self-intersections is
not limited. Default: 6.
)", [&](const std::string& text) { set(arguments, "adaptive-supersample", text); });

  add_value(*command, kSurface, "--min-component-size", "SIZE", R"(
Leave out components that enclose less: 10vx is ten voxels, 2.5 or 2.5mm3 are world units cubed. Where the volume's border
cuts a component open, the border is its cap; components that the cap connects count as one. Default: nothing.
)", [&](const std::string& text) { set(arguments, "min-component-size", text); });
  add_value(*command, kSurface, "--keep-components", "N", R"(
Leave out all but the N largest components; of a part that the volume's border cuts into several, all are kept. Default: all
are kept.
)", [&](const std::string& text) { set(arguments, "keep-components", text); });

  command->add_flag("--coarse", arguments.coarse, R"(
Only the coarsest mesh that keeps the topology: level 0. Constraints are then checked on level 0, but not enforced.
)")->group(kMesh);
  add_value(*command, kMesh, "--max-radius", "LENGTH", R"(
Largest radius of the disks that cover the surface; smaller means more triangles. Default: half the longest side of the
volume.
)", [&](const std::string& text) { set(arguments, "max-radius", text); });
  add_value(*command, kMesh, "--covering", "NAME", R"(
How disks cover the surface. sizing-field: their radii follow a field that grows slowly away from where it has to be
small. halving: the paper's own, for comparison: radii are halved until neighbours fit. Default: sizing-field.
)", [&](const std::string& text) { set(arguments, "covering", text); });
  add_value(*command, kMesh, "--event-persistence", "LENGTH", R"(
Holes in a growing disk that close again within this length do not limit it. Larger ignores more noise in the choice of
triangle sizes; topology is kept whatever the value. Default: 1.5vx; with --covering halving 0.
)", [&](const std::string& text) { set(arguments, "event-persistence", text); });
  add_value(*command, kMesh, "--placement", "WHERE", R"(
Where vertices sit: on the surface, the same in all levels; or balanced, in each level moved so that the mesh lies evenly
on both sides of the surface. Default: surface.
)", [&](const std::string& text) { set(arguments, "placement", text); });
  command->add_flag("--allow-self-intersections", options.allow_self_intersections, R"(
Leave triangles as they are that meet others beyond the corners and edges they share. It is faster and takes fewer
triangles. Default: no two triangles of a level meet.
)")->group(kMesh);
  add_goals(*command, arguments);
  command->add_flag("--strict", arguments.strict, R"(
Write nothing where the exit status would be 1: a requested bound is not met, a mesh has self-intersections, or a
component is inverted or inside the wrong component.
)")->group(kOutput);

  command->add_option("-o,--output", arguments.mesh, R"(
The mesh to write; its extension is the format. A name with {level} in it is one file per level; .glb and .vtm hold all
levels, other formats the finest; - is standard output. See FILES.
)")->type_name("MESH")->required()->group(kOutput);
  add_value(*command, kOutput, "--format", "EXT", R"(
With -o -: what is written, one of ply, stl, obj, off, vtp, 3mf, gii and glb. Default: ply.
)", [&](const std::string& text) { arguments.format = stream_format(text); });
  command->add_flag("--glb-per-level", arguments.glb_per_level, R"(
With -o NAME.glb: also NAME-0.glb, NAME-1.glb, ... with one level each, and NAME.json, which lists them.
)")->group(kOutput);
  command->add_option("--report", arguments.report, R"(
Write topology, certificates, metrics, constraints, triangle shapes, timings and memory as JSON
(docs/reference/report.md); - is standard output, if the mesh does not go there.
)")->type_name("FILE")->group(kOutput);
  command->add_option("--html", arguments.page, R"(
Write one page that shows the levels in 3-D, with what is known of them, in any browser and without a network
(docs/report.md).
)")->type_name("FILE")->group(kOutput);
  add_value(*command, kOutput, "--space", "SPACE", R"(
Coordinates of the mesh: lps, the world as ITK has it; ras, the same with x and y negated; voxel, sample indices.
Default: lps.
)", [&](const std::string& text) { set(arguments, "space", text); });

  CLI::Option* measure = command->add_flag_callback("--measure", [&] { options.measure_samples = kMeasureSamples; }, R"(
Measure each level against the isosurface, both ways, with 200,000 samples each.
)")->group(kOutput);
  CLI::Option* samples = add_value(*command, kOutput, "--measure-samples", "N", R"(
The same with N samples.
)", [&](const std::string& text) { set(arguments, "measure-samples", text); });
  measure->excludes(samples);

  add_value(*command, kRunning, "--threads", "N", R"(
Number of threads; 0: as many as the machine has. Default: 0.
)", [&](const std::string& text) { set(arguments, "threads", text); });
  CLI::Option* quiet = command->add_flag("-q,--quiet", arguments.quiet, R"(
Print nothing unless something is wrong; no progress bar.
)");
  CLI::Option* verbose = command->add_flag("-v,--verbose", arguments.verbose, R"(
Also print all levels' metrics, timings, coarser complexes, repairs and memory.
)");
  quiet->excludes(verbose)->group(kRunning);
  verbose->group(kRunning);
  return command;
}
// clang-format on

CLI::App* add_info_command(CLI::App& app, InfoArguments& arguments) {
  CLI::App* command =
      add_command(app, "info", "describe a volume and suggest isovalues", info_page());
  add_volume(*command, arguments.volume);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")
      ->group(kOutput);
  return command;
}

// clang-format off
CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments) {
  CLI::App* command = add_command(app, "check", "count a mesh's topology, measure its shape and distance", check_page());
  MeasureOptions& options = arguments.measure;

  command->add_option("MESH", arguments.mesh, "The mesh to look at. See FILES.")->required()->group(kInput);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")->group(kOutput);

  command->add_flag("--self-intersections", arguments.self_intersections, R"(
Also look for triangles that meet where they should not: anywhere but at the corners and the edge they share. Decided exactly.
)")->group(kMesh);

  CLI::Option* volume = command->add_option("--volume", arguments.volume, R"(
Measure how far the mesh is from the isosurface of this volume: a file or, for a DICOM series, a folder. See FILES.
)")->type_name("VOLUME")->group(kDistance);
  CLI::Option* iso = add_value(*command, kDistance, "--iso", "X", R"(
The isovalue.
)", [&](const std::string& text) { set(options, "iso", text); });
  CLI::Option* inside = add_value(*command, kDistance, "--inside", "SIDE", R"(
Which samples are inside, above or below the isovalue; says which way triangles should face. Default: above.
)", [&](const std::string& text) { set(options, "inside", text); });
  CLI::Option* topology = add_value(*command, kDistance, "--topology", "NAME", R"(
What the surface is inside a cell, trilinear or faces, as for `isoatlas extract`. Default: trilinear.
)", [&](const std::string& text) { set(options, "topology", text); });
  CLI::Option* nan = add_value(*command, kDistance, "--nan", "SIDE", R"(
Where NaN is, below or above the isovalue; NaN and infinite samples are refused without it.
)", [&](const std::string& text) { set(options, "nan", text); });
  CLI::Option* interpolation = add_value(*command, kDistance, "--interpolation", "NAME", R"(
What the isosurface is between samples, trilinear or tricubic, as for `isoatlas extract`. Default: trilinear.
)", [&](const std::string& text) { set(options, "interpolation", text); });
  CLI::Option* space = add_value(*command, kDistance, "--space", "SPACE", R"(
Coordinates of the mesh: lps, ras or voxel, as for `isoatlas extract`. Default: what the file says (SPACE=... in its
header or comments), else lps.
)", [&](const std::string& text) { arguments.space = parse_space(text); });
  CLI::Option* samples = add_value(*command, kDistance, "--samples", "N", R"(
Samples spread over the area of each of the two surfaces; vertices, edge midpoints, centroids and c-vertices come on top.
Default: 200000.
)", [&](const std::string& text) { set(options, "samples", text); });
  add_reading(*command, arguments.read, volume);

  volume->needs(iso);
  for (CLI::Option* option : {iso, inside, topology, nan, interpolation, space, samples}) option->needs(volume);
  return command;
}
// clang-format on

CLI::App* add_levels_command(CLI::App& app, LevelsArguments& arguments) {
  CLI::App* command =
      add_command(app, "levels", "compare the levels of detail in a file", levels_page());
  command
      ->add_option("FILE", arguments.file,
                   "A .glb or .vtm that `extract` wrote, or its report. See FILES.")
      ->required()
      ->group(kInput);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")
      ->group(kOutput);
  return command;
}

CLI::App* add_report_command(CLI::App& app, ReportArguments& arguments) {
  CLI::App* command = add_command(app, "report", "show results in 3-D on one page", report_page());
  command
      ->add_option("RESULT", arguments.results,
                   "What `extract` wrote: a report, a file of levels, or one mesh. See FILES.")
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

/// Names are those of a patient in LPS: x grows to the left, y to the back, z to the head.
Vec3 parse_view(const std::string& text) {
  const std::string word = plain_word(text);
  if (word.empty() || word[0] < 'a' || word[0] > 'z') return parse_direction(text);
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
  CLI::App* command = add_command(app, "picture", "draw a mesh into a PNG or JPEG file", picture_page());
  PictureOptions& options = arguments.options;
  command->add_option("RESULT", arguments.mesh, "A mesh, or a file of levels. See FILES.")->required()->group(kInput);
  add_value(*command, kInput, "--level", "K", R"(
Which level of a file of levels, from 0, the coarsest. Default: the finest.
)", [&](const std::string& text) {
    arguments.level = parse_whole<std::uint32_t>(text);
    if (!arguments.level) refuse_value("a level's number, 0 or more", text);
  });
  command->add_option("-o,--output", arguments.picture, "The picture to write: .png, .jpg or .jpeg.")->type_name("FILE")->required()->group(kOutput);
  add_value(*command, kOutput, "--style", "NAME", R"(
smooth: shaded. hidden-line: visible edges, dark on white. Default: smooth.
)", [&](const std::string& text) {
    const std::string style = plain_word(text);
    if (style != "smooth" && style != "hidden-line") refuse_value("one of smooth, hidden-line", text);
    options.style = style == "smooth" ? PictureStyle::smooth : PictureStyle::hidden_line;
  });
  add_value(*command, kOutput, "--size", "WIDTH,HEIGHT", R"(
Pixels, 16 to 8192 each. Default: 1200,900.
)", [&](const std::string& text) {
    const std::size_t comma = text.find(',');
    const auto width = parse_whole<int>(std::string_view(text).substr(0, comma));
    const auto height = comma == std::string::npos ? std::nullopt : parse_whole<int>(std::string_view(text).substr(comma + 1));
    const auto is_possible = [](std::optional<int> pixels) { return pixels && *pixels >= 16 && *pixels <= 8192; };
    if (!is_possible(width) || !is_possible(height)) refuse_value("two whole numbers from 16 to 8192 like 1200,900", text);
    options.width = *width;
    options.height = *height;
  });
  add_value(*command, kOutput, "--view", "X,Y,Z", R"(
From where the mesh is seen: front, back, left, right, top or bottom of a patient in LPS, or the direction from the mesh
to the eye. Default: 0.45,-1,0.35, the front from a little above.
)", [&](const std::string& text) { options.view = parse_view(text); });
  add_value(*command, kOutput, "--up", "X,Y,Z", R"(
What is up in the picture; 0,0,-1 turns one that is upside down. Default: 0,0,1; seen from top or bottom the front, 0,-1,0.
)", [&](const std::string& text) { options.up = parse_direction(text); });
  add_value(*command, kOutput, "--zoom", "FACTOR", R"(
How much larger than to fit into the picture. Default: 1.
)", [&](const std::string& text) {
    options.zoom = parse_finite(text);
    if (!(options.zoom > 0)) refuse_value("a number above 0", text);
  });
  command->add_flag("-q,--quiet", arguments.quiet, "Print nothing unless something is wrong.")->group(kRunning);
  return command;
}
// clang-format on

CLI::App* add_completion_command(CLI::App& app, CompletionArguments& arguments) {
  CLI::App* command = add_command(app, "completion", "print a script that completes command lines",
                                  completion_page());
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
