// SPDX-License-Identifier: Apache-2.0
// Leaves the folders of files out of a page. Pages are passed on, and folders often name a patient,
// a person or a project.
#pragma once

#include <string>

namespace isoatlas::detail::page {

/// The last part of a path: "scan.nrrd" of "/data/scan.nrrd", "series" of "/data/series/".
std::string file_name(const std::string& path);

/// A command line of `isoatlas extract` with file names in place of paths.
/// @param command  quoted for a shell, as in a report
/// @param volume   the path of the volume in it
std::string with_file_names(const std::string& command, const std::string& volume);

}  // namespace isoatlas::detail::page
