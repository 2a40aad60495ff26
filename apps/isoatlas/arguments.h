// SPDX-License-Identifier: Apache-2.0
// The arguments of the commands: their options, with help texts, and the values after parsing.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "block_parts.h"
#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "isoatlas/mask_field.h"
#include "isoatlas/measure.h"
#include "picture/picture.h"
#include "wording/settings.h"

namespace isoatlas::detail::tool {

struct VolumeArguments {
  std::filesystem::path path;
  ReadOptions read;
};

struct ExtractArguments : ExtractSettings {
  VolumeArguments volume;
  std::filesystem::path mesh;
  std::string format;  ///< of a mesh on standard output: an extension without its dot; empty: not
                       ///< given
  std::optional<std::filesystem::path> report, page;
  std::optional<std::filesystem::path> neuroglancer;  ///< a folder
  /// All levels as files of their own as well, for 3D Slicer: a name with {level}.
  std::optional<std::filesystem::path> level_files;
  bool glb_per_level = false;  ///< also write one .glb per level, and a manifest
  bool coarse = false;         ///< only level 0
  bool strict = false;         ///< write nothing if the exit status would be kUnsatisfied
  std::string command;         ///< the whole command line, quoted for a shell
  bool quiet = false, verbose = false;
  /// Mesh the samples with one of these values of a label map, instead of an isosurface.
  std::vector<std::int64_t> labels;
  MaskFieldOptions mask;                       ///< of the labels' field
  std::optional<std::filesystem::path> field;  ///< write the labels' field to this .nrrd
  /// Write numbers about the finest level to this file, for 3D Slicer.
  std::optional<std::filesystem::path> returned_values;
  // Blocks: present if the volume is meshed in blocks.
  std::optional<std::uint64_t> memory;  ///< largest memory of a block in bytes
  std::optional<Size3> block_size;      ///< grid cells of a block; in place of `memory`
  /// Folder for the meshes of the blocks; a run continues with those that are there.
  std::optional<std::filesystem::path> parts;

  bool only_merges = false;  ///< merge the blocks in `parts` without making any

  bool is_in_blocks() const { return memory || block_size || parts; }
};

/// Of `isoatlas blocks run` and `isoatlas blocks merge`.
struct BlocksArguments {
  std::filesystem::path folder;
  BlockRange range;
  int threads = 0;
  bool quiet = false, verbose = false;
};

struct InfoArguments {
  VolumeArguments volume;
  bool json = false;
};

struct ViewArguments {
  VolumeArguments volume;
  std::vector<std::string> reading;  ///< the options of `volume.read` and their values, as typed
  std::optional<double> isovalue;    ///< the first; none: a suggested one
  std::optional<Inside> inside;      ///< none: below for distances, else above
  bool opens_browser = true;
  int port = 0;  ///< 0: any
  bool quiet = false;
};

struct CheckArguments {
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> volume;  ///< the distance to its isosurface is measured
  ReadOptions read;                             ///< how to read the volume
  MeasureOptions measure;                       ///< everything except the space
  std::optional<Space> space;                   ///< none: the space that the mesh file states
  bool self_intersections = false;
  bool json = false;
};

struct LevelsArguments {
  std::filesystem::path file;
  bool json = false;
};

struct ReportArguments {
  std::vector<std::filesystem::path> results;
  std::filesystem::path page;
  bool quiet = false;
};

struct PictureArguments {
  std::filesystem::path mesh, picture;
  std::optional<std::size_t> level;  ///< none: the finest
  PictureOptions options;
  bool view_is_in_lps = true;  ///< false: `options.view` is in the coordinates of the mesh
  bool quiet = false;
};

struct CompletionArguments {
  std::string shell;
};

/// Each function adds one command to `app`. Parsing the command fills `arguments`.
CLI::App* add_extract_command(CLI::App& app, ExtractArguments& arguments);
/// `isoatlas blocks plan`; the options are those of `extract`, with `parts`.
CLI::App* add_blocks_plan_command(CLI::App& app, ExtractArguments& arguments);
CLI::App* add_blocks_run_command(CLI::App& app, BlocksArguments& arguments);
CLI::App* add_blocks_merge_command(CLI::App& app, BlocksArguments& arguments);
CLI::App* add_info_command(CLI::App& app, InfoArguments& arguments);
CLI::App* add_view_command(CLI::App& app, ViewArguments& arguments);
CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments);
CLI::App* add_levels_command(CLI::App& app, LevelsArguments& arguments);
CLI::App* add_report_command(CLI::App& app, ReportArguments& arguments);
CLI::App* add_picture_command(CLI::App& app, PictureArguments& arguments);
CLI::App* add_completion_command(CLI::App& app, CompletionArguments& arguments);

/// Sets name, version and help page of the tool itself.
void describe_tool(CLI::App& app);

}  // namespace isoatlas::detail::tool
