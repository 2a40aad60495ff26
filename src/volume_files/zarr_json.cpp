// SPDX-License-Identifier: Apache-2.0
#include "volume_files/zarr_json.h"

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json zarr_json(const fs::path& folder, const char* file) {
  const fs::path path = folder / file;
  std::error_code error;
  if (!fs::exists(path, error)) return nullptr;
  Json json = Json::parse(file_contents(path), nullptr, false);
  if (!json.is_object()) throw bad_file(path, "is not a JSON object, expected Zarr's metadata");
  return json;
}

Json zarr_attributes(const fs::path& folder) {
  Json out = zarr_json(folder, "zarr.json");
  out = out.is_object() ? out.value("attributes", Json::object()) : zarr_json(folder, ".zattrs");
  return out.is_object() ? out : Json::object();
}

std::string text_at(const Json& object, const char* key) {
  const auto at = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && at != object.end() && at->is_string() ? at->get<std::string>() : "";
}

std::optional<std::vector<double>> numbers_at(const Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_array()) return {};
  std::vector<double> out;
  for (const Json& entry : object[key]) {
    if (!entry.is_number()) return {};
    out.push_back(entry.get<double>());
  }
  return out;
}

std::vector<std::uint64_t> counts_at(const Json& object, const char* key, const fs::path& path) {
  std::vector<std::uint64_t> out;
  const bool is_list = object.is_object() && object.contains(key) && object[key].is_array();
  for (const Json& entry : is_list ? object[key] : Json::array()) {
    if (!entry.is_number_unsigned()) break;
    out.push_back(entry.get<std::uint64_t>());
  }
  if (!is_list || out.size() != object[key].size())
    throw bad_file(path, std::string("has no list of numbers '") + key + "'");
  return out;
}

}  // namespace isoatlas::detail::io
