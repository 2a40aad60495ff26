// SPDX-License-Identifier: Apache-2.0
// The geometry of a page: integers on a grid, compressed.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "isoatlas/hierarchy.h"

namespace isoatlas::detail::page {

/// Appends the encoded levels to `bytes`.
/// @return their offsets and sizes: `geometry` of a result (docs/report.md)
/// @throws Error as page_html()
nlohmann::ordered_json append_geometry(const Hierarchy& hierarchy,
                                       const std::filesystem::path& path, std::string& bytes);

}  // namespace isoatlas::detail::page
