// SPDX-License-Identifier: Apache-2.0
// The kind of an input file, and advice on the command that reads it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace isoatlas::detail::tool {

enum class FileKind {
  unknown,
  volume,
  mesh,     ///< a single mesh
  levels,   ///< levels of detail: .glb, .vtm
  json,     ///< a report, or the list of --glb-per-level
  page,     ///< .html
  picture,  ///< .png, .jpg and other images
  folder,
};

/// The kind according to the name alone.
FileKind kind_of_name(const std::filesystem::path& path);

/// The kind according to the file: a folder, the signature of a volume format; else the name.
FileKind kind_of_file(const std::filesystem::path& path);

/// Advice for the file `path` that `command` cannot read: the right command or option, or, if there
/// is no such file, a file with a similar name. `command` is the name of a command, or
/// "check --volume" for the volume of `check`. Empty if the command reads files of this kind, or
/// the kind is unknown.
std::string advice_for_file(std::string_view command, const std::filesystem::path& path);

/// @throws Error(bad_argument) unless the name ends in .html or .htm
void require_page_name(const std::filesystem::path& path);
/// @throws Error(bad_argument) if the name ends in .html or .htm
void require_report_name(const std::filesystem::path& path);

/// "/scans/head.nii.gz" -> "head"
std::string name_without_extensions(const std::filesystem::path& path);

}  // namespace isoatlas::detail::tool
