// SPDX-License-Identifier: Apache-2.0
#include "view/viewed_volume.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "field/sample_type.h"
#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "sample_histogram.h"
#include "text.h"
#include "wording/choices.h"

namespace isoatlas::detail::tool {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "slices are sent as they are in memory");

constexpr std::size_t kDrawnBins = 512;

/// Rows of the matrix from (i, j, k, 1) to world coordinates.
Json index_to_world(const Grid& grid) {
  const Vec3 origin = grid.to_world({0, 0, 0});
  const std::array<Vec3, 3> ends{grid.to_world({1, 0, 0}), grid.to_world({0, 1, 0}),
                                 grid.to_world({0, 0, 1})};
  Json x = Json::array(), y = Json::array(), z = Json::array();
  for (const Vec3& end : ends) {
    x.push_back(end.x - origin.x);
    y.push_back(end.y - origin.y);
    z.push_back(end.z - origin.z);
  }
  x.push_back(origin.x);
  y.push_back(origin.y);
  z.push_back(origin.z);
  return Json::array({x, y, z});
}

/// As `input` of a report: from it the page knows whether coordinates are those of a patient.
Json input_value(const VolumeSource& source) {
  Json decisions = Json::array();
  for (const ReadDecision& decision : source.decisions)
    decisions.push_back({{"key", decision.key}, {"value", decision.value}});
  return {{"format", source.format}, {"decisions", decisions}};
}

Json suggestions_value(const std::vector<SuggestedIsovalue>& suggestions) {
  Json out = Json::array();
  for (const SuggestedIsovalue& s : suggestions)
    out.push_back({{"isovalue", s.value}, {"reason", s.reason}});
  return out;
}

/// The suggestion to show first: that for distances, or the lowest; null without suggestions.
const SuggestedIsovalue* first_of(const std::vector<SuggestedIsovalue>& suggestions) {
  for (const SuggestedIsovalue& suggestion : suggestions)
    if (suggestion.is_of_distances) return &suggestion;
  return suggestions.empty() ? nullptr : &suggestions.front();
}

template <class Sample>
void append_slice(const VolumeView& volume, std::size_t axis, std::size_t index, std::string& out) {
  const Size3& size = volume.grid.size;
  const std::array<std::size_t, 3> strides{1, size[0], size[0] * size[1]};
  const std::size_t fast = axis == 0 ? 1 : 0, slow = axis == 2 ? 1 : 2;
  const auto* samples = static_cast<const Sample*>(volume.samples) + index * strides[axis];
  std::vector<float> row(size[fast]);
  for (std::size_t j = 0; j < size[slow]; ++j) {
    for (std::size_t i = 0; i < size[fast]; ++i)
      row[i] = static_cast<float>(samples[i * strides[fast] + j * strides[slow]]);
    out.append(reinterpret_cast<const char*>(row.data()), row.size() * sizeof(float));
  }
}

}  // namespace

std::string describe_for_page(const ViewArguments& arguments, const VolumeFile& file) {
  const VolumeView& volume = file.volume.view;
  const Grid& grid = volume.grid;
  const SampleSummary summary = summarize(volume);
  if (summary.finite_count == 0)
    throw Error(ErrorCode::unsupported, arguments.volume.path.string() +
                                            ": no sample is finite, expected a volume with values");
  const SampleHistogram histogram = sample_histogram(volume, summary);
  const SampleHistogram drawn = coarsened(histogram, kDrawnBins);
  const auto suggestions = suggest_isovalues(histogram, summary);
  const SuggestedIsovalue* first = first_of(suggestions);
  const double isovalue = arguments.isovalue.value_or(
      first != nullptr ? first->value : summary.minimum / 2 + summary.maximum / 2);
  // Distances are usually negative inside.
  const Inside inside = arguments.inside.value_or(
      first != nullptr && first->is_of_distances ? Inside::below : Inside::above);
  return Json{{"schema", "isoatlas-view-1"},
              {"version", ISOATLAS_VERSION},
              {"title", arguments.volume.path.filename().string()},
              {"path", arguments.volume.path.string()},
              {"size", {grid.size[0], grid.size[1], grid.size[2]}},
              {"sample_type", name(volume.type)},
              {"samples_text", size_text(grid.size) + ", " + std::string(name(volume.type))},
              {"minimum", summary.minimum},
              {"maximum", summary.maximum},
              {"not_finite", summary.nan_count + summary.infinity_count},
              {"spacing", {grid.spacing.x, grid.spacing.y, grid.spacing.z}},
              {"unit", symbol(grid.unit)},
              {"index_to_world", index_to_world(grid)},
              {"input", input_value(file.source)},
              {"histogram",
               {{"lowest", drawn.lowest},
                {"width", drawn.width},
                {"of_integers", drawn.of_integers},
                {"counts", drawn.counts}}},
              {"suggested", suggestions_value(suggestions)},
              {"isovalue", isovalue},
              {"inside", inside == Inside::above ? "above" : "below"},
              {"roi", nullptr},
              {"warnings", file.source.warnings},
              {"formats", {"ply", "stl", "3mf", "glb", "obj", "off", "vtp", "gii"}},
              {"defaults", {{"max-distance", "0.5vx"}}}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string slice_samples(const VolumeView& volume, std::size_t axis, std::size_t index) {
  if (axis > 2 || index >= volume.grid.size[axis])
    throw Error(ErrorCode::bad_argument, "there is no slice " + std::to_string(index) +
                                             " across axis " + std::to_string(axis) +
                                             " of a volume of " + size_text(volume.grid.size));
  std::string out;
  visit_sample_type(volume.type, [&]<class Sample>(const Sample*) {
    append_slice<Sample>(volume, axis, index, out);
  });
  return out;
}

}  // namespace isoatlas::detail::tool
