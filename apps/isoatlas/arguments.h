// SPDX-License-Identifier: Apache-2.0
// What the commands take from the command line: the options, their help, and nothing of what they do.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string_view>

#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "isoatlas/measure.h"
#include "wording/settings.h"

namespace isoatlas::tool {

struct VolumeArguments {
  std::filesystem::path path;
  std::optional<RawLayout> raw;
};

struct ExtractArguments : ExtractSettings {
  VolumeArguments volume;
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> report;
  bool glb_per_level = false;  ///< besides `mesh`, which is a .glb, one for each level, and a manifest
  bool coarse = false;         ///< nothing but level 0
  bool quiet = false, verbose = false;
};

struct InfoArguments {
  VolumeArguments volume;
};

struct CheckArguments {
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> volume;  ///< whose isosurface the mesh is measured against
  std::optional<RawLayout> raw;                 ///< of the volume
  MeasureOptions measure;                       ///< all but the space
  std::optional<Space> space;                   ///< none: as the mesh file says
  bool self_intersections = false;
  bool json = false;
};

struct LevelsArguments {
  std::filesystem::path file;
  bool json = false;
};

/// Each adds one command to `app` that fills `arguments` when it is parsed.
CLI::App* add_extract_command(CLI::App& app, ExtractArguments& arguments);
CLI::App* add_info_command(CLI::App& app, InfoArguments& arguments);
CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments);
CLI::App* add_levels_command(CLI::App& app, LevelsArguments& arguments);

/// Name, version and help page of the tool itself.
void describe_tool(CLI::App& app);

}  // namespace isoatlas::tool
