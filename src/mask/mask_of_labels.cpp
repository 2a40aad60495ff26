// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/ranges.h"
#include "core/require.h"
#include "field/dense_volume.h"
#include "field/sample_type.h"
#include "isoatlas/mask_field.h"

namespace isoatlas {
using namespace detail;
namespace {

constexpr std::size_t kLabelsPerChunk = 1 << 16, kMostListed = 12;

// The smallest labels of the volume: "0, 1, 2" or "0, 1, 2, ...".
template <class T>
std::string listed(std::span<const T> samples) {
  std::set<T> labels;
  for (const T sample : samples) {
    labels.insert(sample);
    if (labels.size() > kMostListed + 1) labels.erase(std::prev(labels.end()));
  }
  std::string text;
  std::size_t i = 0;
  for (const T label : labels) {
    if (i == kMostListed) return text + ", ...";
    text += (i++ == 0 ? "" : ", ");
    if constexpr (std::is_floating_point_v<T>)
      text += std::to_string(static_cast<std::int64_t>(label));
    else
      text += std::to_string(label);
  }
  return text;
}

// Floating-point labels must be whole; the first that is not is named.
template <class T>
void require_whole(std::span<const T> samples, const Size3& size) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i] == std::floor(samples[i]) && std::isfinite(samples[i])) continue;
    const std::size_t row = i / size[0];
    throw Error(ErrorCode::unsupported,
                "sample (" + std::to_string(i % size[0]) + ", " + std::to_string(row % size[1]) +
                    ", " + std::to_string(row / size[1]) + ") is " + std::to_string(samples[i]) +
                    ", expected whole numbers: only a label map has labels; use an isovalue");
  }
}

}  // namespace

Volume mask_of_labels(const VolumeView& labels, std::span<const std::int64_t> wanted) {
  require(!wanted.empty(), "no label is given; expected at least one");
  const Volume dense = dense_volume(labels);
  auto mask = std::make_shared<std::vector<std::uint8_t>>(labels.grid.sample_count());
  visit_samples(dense.view, [&]<class T>(std::span<const T> samples) {
    if constexpr (std::is_floating_point_v<T>) require_whole(samples, labels.grid.size);
    const auto is = [](T sample, std::int64_t label) {
      if constexpr (std::is_floating_point_v<T>)
        return sample == static_cast<T>(label);
      else
        return std::cmp_equal(sample, label);
    };
    for_each_index(samples.size(), kLabelsPerChunk, [&](std::size_t i) {
      (*mask)[i] = ranges::any_of(wanted, [&](std::int64_t l) { return is(samples[i], l); });
    });
    for (const std::int64_t label : wanted) {
      if (ranges::any_of(samples, [&](T sample) { return is(sample, label); })) continue;
      throw Error(ErrorCode::empty_surface, "no sample has the label " + std::to_string(label) +
                                                "; the labels are " + listed(samples));
    }
  });
  Volume out;
  out.view = VolumeView::of(*mask, labels.grid.size);
  out.view.grid = labels.grid;
  out.owner = std::move(mask);
  return out;
}

}  // namespace isoatlas
