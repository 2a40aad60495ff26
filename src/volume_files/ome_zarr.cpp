// SPDX-License-Identifier: Apache-2.0
#include "volume_files/ome_zarr.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "files/file_error.h"
#include "isoatlas/length_unit.h"
#include "volume_files/zarr_array.h"
#include "volume_files/zarr_json.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr int kMostParents = 4;  // between an array and the group that describes it

// The metadata of OME-NGFF: an attribute "ome" since 0.5, the attributes themselves before.
Json ome_attributes(const fs::path& group) {
  Json attributes = zarr_attributes(group);
  return attributes.contains("ome") ? attributes["ome"] : attributes;
}

Json first_multiscales(const Json& ome) {
  const Json list = ome.is_object() ? ome.value("multiscales", Json()) : Json();
  return list.is_array() && !list.empty() && list[0].is_object() ? list[0] : Json();
}

std::vector<std::string> dataset_paths(const Json& multiscales, const fs::path& group) {
  std::vector<std::string> out;
  for (const Json& dataset : multiscales.value("datasets", Json::array())) {
    const std::string path = text_at(dataset, "path");
    const fs::path relative = path;
    if (path.empty() || relative.is_absolute() ||
        std::ranges::find(relative, fs::path("..")) != relative.end())
      throw bad_file(group, "is an image with a dataset '" + one_line(path, 60) +
                                "', expected the path of an array in its folder");
    out.push_back(path);
  }
  if (out.empty()) throw bad_file(group, "is an image without datasets");
  return out;
}

// Applies the transformations of a list to the axes: each scales or moves.
void apply(const Json& transformations, OmeImageLevel& level, const fs::path& group) {
  std::vector<OmeAxis>& axes = level.axes;
  for (const Json& entry : transformations.is_array() ? transformations : Json::array()) {
    const std::string type = text_at(entry, "type");
    if (type == "identity") continue;
    const bool is_scale = type == "scale";
    const auto numbers = numbers_at(entry, type.c_str());
    if ((!is_scale && type != "translation") || !numbers || numbers->size() != axes.size())
      throw unsupported(group, "has the coordinate transformation '" + one_line(type, 40) +
                                   "', expected scales and translations with a number per axis");
    level.has_scale = level.has_scale || is_scale;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const double by = (*numbers)[a];
      if (is_scale) axes[a].scale *= by;
      axes[a].translation = is_scale ? axes[a].translation * by : axes[a].translation + by;
    }
  }
}

// Axes are objects since 0.4 and names before; the oldest files have none, but always t, c, z, y
// and x.
std::vector<OmeAxis> axes_of(const Json& multiscales) {
  std::vector<OmeAxis> out;
  const Json list = multiscales.value("axes", Json::array({"t", "c", "z", "y", "x"}));
  for (const Json& entry : list) {
    OmeAxis& axis = out.emplace_back();
    axis.name = entry.is_string() ? entry.get<std::string>() : text_at(entry, "name");
    axis.type = text_at(entry, "type");
    axis.unit = length_unit_named(text_at(entry, "unit"));
  }
  return out;
}

OmeImageLevel level_of(const fs::path& group, const Json& ome, std::size_t level) {
  const Json multiscales = first_multiscales(ome);
  const std::vector<std::string> paths = dataset_paths(multiscales, group);
  OmeImageLevel out{group / paths[level]};
  out.version = text_at(ome, "version");
  if (out.version.empty()) out.version = text_at(multiscales, "version");
  if (out.version.empty()) out.version = "of no stated version";
  out.level = level;
  out.level_count = paths.size();
  out.axes = axes_of(multiscales);
  const Json& dataset = multiscales["datasets"][level];
  apply(dataset.value("coordinateTransformations", Json()), out, group);
  apply(multiscales.value("coordinateTransformations", Json()), out, group);
  const Json omero = ome.value("omero", Json());
  for (const Json& channel :
       omero.is_object() ? omero.value("channels", Json::array()) : Json::array())
    out.channel_names.push_back(text_at(channel, "label"));
  return out;
}

// The image to which an array belongs, if a group above it states one.
OmeImageLevel level_of_array(const fs::path& array) {
  fs::path group = fs::absolute(array).lexically_normal();
  if (group.filename().empty()) group = group.parent_path();
  const fs::path absolute = group;
  for (int k = 0; k < kMostParents && group.has_relative_path(); ++k) {
    group = group.parent_path();
    if (!is_zarr(group)) continue;
    const Json ome = ome_attributes(group);
    if (first_multiscales(ome).is_null()) continue;
    const std::vector<std::string> paths = dataset_paths(first_multiscales(ome), group);
    for (std::size_t level = 0; level < paths.size(); ++level) {
      if ((group / paths[level]).lexically_normal() != absolute) continue;
      OmeImageLevel out = level_of(group, ome, level);
      out.array = array;
      return out;
    }
  }
  return {array};
}

// The names of the groups and arrays in a group, sorted. bioformats2raw puts a group OME, with
// metadata only, beside the images.
std::vector<std::string> members(const fs::path& group) {
  std::vector<std::string> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(group, error)) {
    if (entry.is_directory(error) && is_zarr(entry.path()) && entry.path().filename() != "OME")
      out.push_back(entry.path().filename().string());
  }
  std::ranges::sort(out);
  return out;
}

}  // namespace

OmeImageLevel find_ome_level(const fs::path& path) {
  if (is_zarr_array(path)) return level_of_array(path);
  const Json ome = ome_attributes(path);
  if (!first_multiscales(ome).is_null()) return level_of(path, ome, 0);
  const std::vector<std::string> inside = members(path);
  if (ome.is_object() && ome.contains("plate"))
    throw unsupported(
        path, "is a plate, expected one of its images, for example " + (path / "A/1/0").string());
  if (inside.size() == 1) return find_ome_level(path / inside[0]);
  if (inside.empty()) throw unsupported(path, "is a Zarr group without arrays");
  std::string list;
  constexpr std::size_t kListed = 8;
  for (std::size_t i = 0; i < std::min(inside.size(), kListed); ++i)
    list += (i > 0 ? ", " : "") + one_line((path / inside[i]).string(), 120);
  if (inside.size() > kListed) list += ", ...";
  throw unsupported(path, "is a Zarr group with several members, expected one of them: " + list);
}

}  // namespace isoatlas::detail::io
