// SPDX-License-Identifier: Apache-2.0
// Levels as a page keeps them: integers on a grid, compressed.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "isoatlas/hierarchy.h"

namespace isoatlas::detail::page {

/// Appends the levels to `bytes` and says where they are (`geometry` of a result, docs/report.md).
/// Throws as page_html().
nlohmann::ordered_json append_geometry(const Hierarchy& hierarchy,
                                       const std::filesystem::path& path, std::string& bytes);

}  // namespace isoatlas::detail::page
