// SPDX-License-Identifier: Apache-2.0
#include "label_mask.h"

#include <algorithm>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "field/sample_type.h"
#include "isoatlas/error.h"

namespace isoatlas::detail::tool {
namespace {

constexpr std::size_t kMostListed = 12;

/// Calls `f` with a span of the samples, if they are integers.
template <class F>
void with_integers(const VolumeView& volume, const F& f) {
  visit_samples(volume, [&]<class T>(std::span<const T> samples) {
    if constexpr (std::is_integral_v<T>)
      f(samples);
    else
      throw Error(ErrorCode::unsupported,
                  "the volume has samples of type " + std::string(name(volume.type)) +
                      ", expected integers: only a label map has labels; use an isovalue");
  });
}

/// The smallest labels of the volume: "0, 1, 2" or "0, 1, 2, ...".
template <class T>
std::string listed(std::span<const T> samples) {
  std::set<T> labels;
  for (const T sample : samples) {
    labels.insert(sample);
    if (labels.size() > kMostListed + 1) labels.erase(std::prev(labels.end()));
  }
  std::string text;
  for (std::size_t i = 0; const T label : labels) {
    if (i == kMostListed) return text + ", ...";
    text += (i++ == 0 ? "" : ", ") + std::to_string(label);
  }
  return text;
}

}  // namespace

Volume label_mask(const VolumeView& labels, std::int64_t label) {
  auto mask = std::make_shared<std::vector<std::uint8_t>>(labels.grid.sample_count());
  with_integers(labels, [&](const auto& samples) {
    std::ranges::transform(samples, mask->begin(), [label](auto sample) {
      return static_cast<std::uint8_t>(std::cmp_equal(sample, label));
    });
    if (std::ranges::find(*mask, 1) == mask->end())
      throw Error(ErrorCode::empty_surface, "no sample has the label " + std::to_string(label) +
                                                "; the labels are " + listed(samples));
  });
  Volume result;
  result.view.grid = labels.grid;
  result.view.type = SampleType::uint8;
  result.view.samples = mask->data();
  result.owner = std::move(mask);
  return result;
}

}  // namespace isoatlas::detail::tool
