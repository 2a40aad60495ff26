// SPDX-License-Identifier: Apache-2.0
// What sort of file somebody gave, for saying which command it is for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace isoatlas::detail::tool {

enum class FileKind {
  unknown,
  volume,
  mesh,     ///< one
  levels,   ///< .glb, .vtm
  json,     ///< a report, or the list of --glb-per-level
  page,     ///< .html
  picture,  ///< .png and the like
  folder,
};

/// By the name alone.
FileKind kind_of_name(const std::filesystem::path& path);

/// By what is there: a folder, the mark of a volume format; else by the name.
FileKind kind_of_file(const std::filesystem::path& path);

/// What to do with the file `path` where `command` ("extract"; for what stands with its --volume
/// "check --volume") does not take it: names the right command or option, or a file with nearly
/// this name where there is none. Empty if the command takes files of its kind, or the kind is not
/// known.
std::string advice_for_file(std::string_view command, const std::filesystem::path& path);

/// Pages and reports are written under names that say what they are.
/// @throws Error(bad_argument) unless the name ends in .html or .htm
void require_page_name(const std::filesystem::path& path);
/// @throws Error(bad_argument) if it does
void require_report_name(const std::filesystem::path& path);

/// "/scans/head.nii.gz" -> "head"
std::string name_without_extensions(const std::filesystem::path& path);

}  // namespace isoatlas::detail::tool
