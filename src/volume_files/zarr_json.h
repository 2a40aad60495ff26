// SPDX-License-Identifier: Apache-2.0
// Zarr's metadata as JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isoatlas::detail::io {

/// The JSON object in a file of the folder; null if there is no such file.
/// @throws Error(bad_file) if it is no JSON object
nlohmann::json zarr_json(const std::filesystem::path& folder, const char* file);

/// The user's attributes of a group or array, of either version; an empty object if it has none.
nlohmann::json zarr_attributes(const std::filesystem::path& folder);

/// The text of a key of an object; empty if it is missing or no text.
std::string text_at(const nlohmann::json& object, const char* key);

/// The numbers of a list; nothing if it is missing or has another entry.
std::optional<std::vector<double>> numbers_at(const nlohmann::json& object, const char* key);

/// The list of integers from 0 on with this key.
/// @throws Error(bad_file) if it is missing or has another entry
std::vector<std::uint64_t> counts_at(const nlohmann::json& object, const char* key,
                                     const std::filesystem::path& path);

}  // namespace isoatlas::detail::io
