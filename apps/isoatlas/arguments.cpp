// SPDX-License-Identifier: Apache-2.0
#include "arguments.h"

#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "man_page.h"

namespace isoatlas::tool {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kSurface = "Surface";
constexpr const char* kMesh = "Mesh";
constexpr const char* kOutput = "Output";
constexpr const char* kRunning = "Running";

constexpr const char* kExitStatus =
    "0    done\n"
    "2    an argument or a file is not as it should be, or there is no surface;\n"
    "     nothing was written\n"
    "3    isoatlas' own check failed, a bug; nothing was written\n"
    "4    out of memory; nothing was written\n"
    "130  interrupted (Ctrl-C); nothing was written. 143: the same by SIGTERM";

constexpr const char* kVolumeFiles =
    "Volumes: NRRD (.nrrd, .nhdr), NIfTI (.nii, .nii.gz, .hdr, .img), MetaImage\n"
    "(.mha, .mhd), TIFF stacks (.tif, .tiff), VTK (.vtk, .vti), a folder with one\n"
    "DICOM series, and headerless samples (--raw-size, --raw-type).";

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::bad_argument, message); }

std::string in_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

// Numbers are read with from_chars: whole text, no locale.
template <class Number>
std::optional<Number> parse_whole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

double parse_finite(std::string_view text) {
  const auto number = parse_whole<double>(text);
  if (!number || !std::isfinite(*number)) refuse("expected a finite number, got " + in_quotes(text));
  return *number;
}

int parse_threads(std::string_view text) {
  const auto number = parse_whole<int>(text);
  if (!number || *number < 0) refuse("expected a whole number, 0 or more, got " + in_quotes(text));
  return *number;
}

template <class Number, class Accept>
std::array<Number, 3> parse_triple(std::string_view text, const char* expected, Accept accept) {
  std::array<Number, 3> triple{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = rest.find(',');
    const auto number = parse_whole<Number>(rest.substr(0, comma));
    const bool is_last = comma == std::string_view::npos;
    if (!number || !accept(*number) || is_last != (i == 2)) refuse(std::string("expected ") + expected + ", got " + in_quotes(text));
    triple[i] = *number;
    if (!is_last) rest.remove_prefix(comma + 1);
  }
  return triple;
}

/// An option whose text `read` turns into a value; what it throws names the option.
template <class Read>
CLI::Option* add_parsed(CLI::App& app, const std::string& names, Read read, const std::string& description) {
  const std::string name = names.substr(names.rfind(',') + 1);
  return app.add_option_function<std::string>(
      names,
      [read, name](const std::string& text) {
        try {
          read(text);
        } catch (const Error& error) {
          throw CLI::ValidationError(name, error.what());
        }
      },
      description);
}

template <class Value>
using Choices = std::vector<std::pair<std::string, Value>>;

template <class Value>
Value choose(const Choices<Value>& choices, const std::string& text) {
  std::string names;
  for (const auto& [name, value] : choices) {
    if (name == text) return value;
    names += (names.empty() ? "" : ", ") + name;
  }
  refuse("expected one of " + names + ", got " + in_quotes(text));
}

Choices<SampleType> sample_types() {
  Choices<SampleType> choices;
  for (const SampleType type : {SampleType::int8, SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::int32,
                                SampleType::uint32, SampleType::int64, SampleType::uint64, SampleType::float32, SampleType::float64})
    choices.emplace_back(name(type), type);
  return choices;
}

RawLayout& layout(VolumeArguments& volume) { return volume.raw ? *volume.raw : volume.raw.emplace(); }

void add_volume(CLI::App& app, VolumeArguments& volume) {
  app.add_option("VOLUME", volume.path, "File or, for a DICOM series, folder with one 3-D scalar image. See FILES.")
      ->required()
      ->group(kInput);
  CLI::Option* size = add_parsed(app, "--raw-size", [&](const std::string& text) {
    layout(volume).size = parse_triple<std::size_t>(text, "three whole numbers like 256,256,94", [](std::size_t n) { return n > 0; });
  }, "The file has no header: samples along x, y and z, x running fastest.");
  CLI::Option* type = add_parsed(app, "--raw-type", [&](const std::string& text) {
    layout(volume).type = choose(sample_types(), text);
  }, "Type of headerless samples: int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32 or float64.");
  CLI::Option* spacing = add_parsed(app, "--raw-spacing", [&](const std::string& text) {
    layout(volume).spacing = parse_triple<double>(text, "three positive numbers like 1,1,2.5",
                                                  [](double s) { return std::isfinite(s) && s > 0; });
  }, "Distance between headerless samples along x, y and z. Default: 1,1,1.");
  CLI::Option* endian = add_parsed(app, "--raw-endian", [&](const std::string& text) {
    layout(volume).big_endian = choose<bool>({{"little", false}, {"big", true}}, text);
  }, "Byte order of headerless samples: little or big. Default: little.");

  size->type_name("NX,NY,NZ")->needs(type)->group(kInput);
  type->type_name("TYPE")->needs(size)->group(kInput);
  spacing->type_name("SX,SY,SZ")->needs(size)->group(kInput);
  endian->type_name("ORDER")->needs(size)->group(kInput);
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description, const char* help_group,
                      ManPage::Text text) {
  CLI::App* command = app.add_subcommand(name, description);
  command->formatter(std::make_shared<ManPage>(std::move(text)));
  command->set_help_flag("-h,--help", "Print this page.")->group(help_group);
  return command;
}

}  // namespace

Length parse_length(std::string_view text) {
  std::string_view number = text;
  const auto strip = [&number](std::string_view unit) {
    if (!number.ends_with(unit)) return false;
    number.remove_suffix(unit.size());
    return true;
  };
  Length length;
  length.in_voxels = strip("vx");
  if (!length.in_voxels) strip("mm");
  const auto value = parse_whole<double>(number);
  if (!value || !std::isfinite(*value) || *value < 0)
    refuse("expected a length like 2.5, 2.5mm or 3vx, got " + in_quotes(text));
  length.value = *value;
  return length;
}

CLI::App* add_extract_command(CLI::App& app, ExtractArguments& arguments) {
  CLI::App* command = add_command(app, "extract", "mesh an isosurface of a volume, with its topology certified", kRunning, {
      .synopsis = "isoatlas extract VOLUME --iso X -o MESH [options]",
      .description =
          "Reads a volume, meshes the surface on which it has the value X, checks the mesh and writes it. The mesh is coarse and "
          "adaptive: few triangles of good shape where the surface is tame, more where its topology asks for them. It is a "
          "manifold (with boundary where the surface leaves the volume), consistently oriented, and has component by component "
          "the topology of the full-resolution surface; that is checked before anything is written.\n"
          "Lengths are world units, as the volume's spacing: 2.5 or 2.5mm; or voxels: 3vx is three times the volume's smallest "
          "spacing.\n"
          "The same input gives the same bytes, whatever the number of threads.",
      .groups = {kInput, kSurface, kMesh, kOutput, kRunning},
      .sections = {
          {"Examples",
           "isoatlas extract head.nrrd --iso 80.5 -o head.ply\n"
           "    The surface at 80.5, in the world coordinates of the file.\n\n"
           "isoatlas extract dragon_sdf.nii.gz --iso 0 --inside below -o dragon.stl\n"
           "    A signed distance field, negative inside.\n\n"
           "isoatlas extract ct.mha --iso 300.5 --max-radius 20mm -o a.vtp --report a.json\n"
           "    No disk larger than 20 mm; all numbers in a.json.\n\n"
           "isoatlas extract fuel.raw --raw-size 64,64,64 --raw-type uint8 --iso 70.5 \\\n"
           "    -o fuel.off\n"
           "    Headerless samples."},
          {"Exit status", kExitStatus},
          {"Files", std::string(kVolumeFiles) +
                        "\n"
                        "Meshes: .ply and .stl (binary), .obj, .off, .vtp; the extension decides.\n"
                        "Outputs appear whole, mesh and report together, or not at all. They are\n"
                        "prepared in a hidden folder .isoatlas-* beside the destination; one that a\n"
                        "killed process left behind can be deleted."}}});

  add_volume(*command, arguments.volume);
  add_parsed(*command, "--nan", [&](const std::string& text) {
    arguments.options.non_finite = choose<NonFinite>({{"below", NonFinite::below}, {"above", NonFinite::above}}, text);
  }, "NaN and infinite samples are refused unless this says where NaN is: below or above the isovalue. Infinities are then "
     "on the side of their sign.")
      ->type_name("SIDE")->group(kInput);

  add_parsed(*command, "--iso", [&](const std::string& text) { arguments.options.isovalue = parse_finite(text); },
             "The isovalue. `isoatlas info` suggests some. For integer samples a value between two integers, like 80.5, is best: "
             "no sample equals it.")
      ->type_name("X")->required()->group(kSurface);
  add_parsed(*command, "--inside", [&](const std::string& text) {
    arguments.options.inside = choose<Inside>({{"above", Inside::above}, {"below", Inside::below}}, text);
  }, "Which samples are inside: those above or those below the isovalue. Triangles face outwards. A sample equal to the "
     "isovalue is inside either way. Default: above.")
      ->type_name("SIDE")->group(kSurface);

  command->add_flag("--coarse", arguments.coarse,
                    "The coarsest mesh that keeps the topology and the shape of the triangles. This version has no refinement "
                    "yet: it makes this mesh with or without the flag.")
      ->group(kMesh);
  add_parsed(*command, "--max-radius", [&](const std::string& text) {
    arguments.max_radius = parse_length(text);
    if (arguments.max_radius->value == 0) refuse("expected a length above 0, got " + in_quotes(text));
  }, "Largest radius of the disks that cover the surface; smaller means more triangles. Default: half the longest side of "
             "the volume.")
      ->type_name("LENGTH")->group(kMesh);
  add_parsed(*command, "--event-persistence", [&](const std::string& text) { arguments.event_persistence = parse_length(text); },
             "Holes in a growing disk that close again within this length do not limit it. Larger ignores more noise in the "
             "choice of triangle sizes; topology is kept whatever the value. Default: 1.5vx.")
      ->type_name("LENGTH")->group(kMesh);

  command->add_option("-o,--output", arguments.mesh, "The mesh to write; its extension is the format. See FILES.")
      ->type_name("MESH")->required()->group(kOutput);
  command->add_option("--report", arguments.report, "Write topology, certificate, triangle shapes, timings and memory as JSON "
                                                    "(docs/reference/report.md).")
      ->type_name("FILE")->group(kOutput);
  add_parsed(*command, "--space", [&](const std::string& text) {
    arguments.options.space = choose<Space>({{"lps", Space::lps}, {"ras", Space::ras}, {"voxel", Space::voxel}}, text);
  }, "Coordinates of the mesh: lps, the world as ITK has it; ras, the same with x and y negated; voxel, sample indices. "
     "Default: lps.")
      ->type_name("SPACE")->group(kOutput);

  add_parsed(*command, "--threads", [&](const std::string& text) { arguments.threads = parse_threads(text); },
             "Number of threads; 0: as many as the machine has. Default: 0.")
      ->type_name("N")->group(kRunning);
  CLI::Option* quiet = command->add_flag("-q,--quiet", arguments.quiet, "Print nothing unless something is wrong; no progress bar.");
  CLI::Option* verbose = command->add_flag("-v,--verbose", arguments.verbose,
                                           "Also print timings, coarser complexes, repairs and memory.");
  quiet->group(kRunning)->excludes(verbose);
  verbose->group(kRunning);
  return command;
}

CLI::App* add_info_command(CLI::App& app, InfoArguments& arguments) {
  CLI::App* command = add_command(app, "info", "describe a volume and suggest isovalues", kRunning, {
      .synopsis = "isoatlas info VOLUME [options]",
      .description =
          "Prints size, sample type, spacing, origin, orientation, extent, range and memory of a volume, counts samples that are "
          "not finite, draws a histogram (heights are logarithmic) and suggests isovalues: thresholds that split the samples "
          "into two and into three classes (Otsu's method), and 0 for what looks like a signed distance field.\n"
          "The three letters of the orientation say where the x, y and z axes point, taking the world as LPS: Left or Right, "
          "Posterior or Anterior, Superior or Inferior.",
      .groups = {kInput, kRunning},
      .sections = {{"Examples",
                    "isoatlas info head.nrrd\n"
                    "isoatlas info fuel.raw --raw-size 64,64,64 --raw-type uint8"},
                   {"Exit status", kExitStatus},
                   {"Files", kVolumeFiles}}});
  add_volume(*command, arguments.volume);
  return command;
}

CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments) {
  CLI::App* command = add_command(app, "check", "count a mesh's topology and measure its triangles", kRunning, {
      .synopsis = "isoatlas check MESH [--json]",
      .description =
          "Reads any triangle mesh and says whether it is a manifold (every edge in one or two triangles, the triangles of every "
          "vertex one fan) and consistently oriented, and if so its components, Euler characteristic, genus and boundary loops; "
          "then the shape of its triangles. The aspect ratio of a triangle is its shortest edge over its longest.",
      .groups = {kInput, kOutput, kRunning},
      .sections = {{"Examples",
                    "isoatlas check head.ply\n"
                    "isoatlas check head.ply --json | jq .quality.aspect_ratio.minimum"},
                   {"Exit status",
                    "0    a manifold, consistently oriented, with at least one triangle\n"
                    "1    not so\n"
                    "2    an argument or the file is not as it should be\n"
                    "3    a bug of isoatlas\n"
                    "4    out of memory\n"
                    "130  interrupted (Ctrl-C). 143: the same by SIGTERM"},
                   {"Files", "Meshes: .ply, .stl, .obj, .off, .vtp. Polygons are cut into triangles; corners\n"
                             "of an STL file at equal positions are one vertex."}}});
  command->add_option("MESH", arguments.mesh, "The mesh to look at. See FILES.")->required()->group(kInput);
  command->add_flag("--json", arguments.json, "Print JSON (docs/reference/report.md).")->group(kOutput);
  return command;
}

void describe_tool(CLI::App& app) {
  constexpr const char* kOptions = "Options";
  app.description("isosurfaces of volumes as adaptive triangle meshes, with certified topology");
  app.name("isoatlas");
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "Print this page.")->group(kOptions);
  app.set_version_flag("--version", "isoatlas " ISOATLAS_VERSION, "Print the version.")->group(kOptions);
  app.formatter(std::make_shared<ManPage>(ManPage::Text{
      .synopsis = "isoatlas COMMAND [options]\nisoatlas COMMAND --help",
      .description =
          "Turns scalar volumes (CT, MRI, microscopy, distance fields, simulations) into triangle meshes. Every mesh that is written "
          "is a manifold with the topology of the full-resolution surface, component by component; that is checked, not assumed.",
      .groups = {kOptions},
      .sections = {{"Examples",
                    "isoatlas info head.nrrd\n"
                    "isoatlas extract head.nrrd --iso 80.5 -o head.ply\n"
                    "isoatlas check head.ply"},
                   {"Exit status",
                    std::string(kExitStatus).insert(std::string_view(kExitStatus).find("2    "),
                                                    "1    isoatlas check: not a consistently oriented manifold\n")},
                   {"Files", kVolumeFiles}}}));
}

}  // namespace isoatlas::tool
