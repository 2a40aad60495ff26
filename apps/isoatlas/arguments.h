// SPDX-License-Identifier: Apache-2.0
// What the commands take from the command line: the options, their help, and nothing of what they
// do.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/io.h"
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
  std::string format;  ///< of a mesh that goes to standard output: an extension without its dot;
                       ///< empty: not said
  std::optional<std::filesystem::path> report, page;
  bool glb_per_level =
      false;            ///< besides `mesh`, which is a .glb, one for each level, and a manifest
  bool coarse = false;  ///< nothing but level 0
  bool strict = false;  ///< write nothing where something is not as asked for or promised
  std::string command;  ///< the whole command line, for people to run again
  bool quiet = false, verbose = false;
};

struct InfoArguments {
  VolumeArguments volume;
  bool json = false;
};

struct CheckArguments {
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> volume;  ///< whose isosurface the mesh is measured against
  ReadOptions read;                             ///< how to read the volume
  MeasureOptions measure;                       ///< all but the space
  std::optional<Space> space;                   ///< none: as the mesh file says
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
  bool quiet = false;
};

struct CompletionArguments {
  std::string shell;
};

/// Each adds one command to `app` that fills `arguments` when it is parsed.
CLI::App* add_extract_command(CLI::App& app, ExtractArguments& arguments);
CLI::App* add_info_command(CLI::App& app, InfoArguments& arguments);
CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments);
CLI::App* add_levels_command(CLI::App& app, LevelsArguments& arguments);
CLI::App* add_report_command(CLI::App& app, ReportArguments& arguments);
CLI::App* add_picture_command(CLI::App& app, PictureArguments& arguments);
CLI::App* add_completion_command(CLI::App& app, CompletionArguments& arguments);

/// Name, version and help page of the tool itself.
void describe_tool(CLI::App& app);

}  // namespace isoatlas::detail::tool
