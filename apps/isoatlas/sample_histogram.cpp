// SPDX-License-Identifier: Apache-2.0
// Based on: N. Otsu, A threshold selection method from gray-level histograms, IEEE Trans. SMC 9(1),
// 1979.
#include "sample_histogram.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>

#include "field/sample_type.h"

namespace isoatlas::detail::tool {
namespace {

bool is_integer(SampleType type) {
  return type != SampleType::float32 && type != SampleType::float64;
}

/// Cumulative sums over the bins. Weight and mean of any class follow from two look-ups.
struct Moments {
  std::vector<double> weight{0}, sum{0};

  explicit Moments(const std::vector<std::size_t>& counts) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto count = static_cast<double>(counts[i]);
      weight.push_back(weight.back() + count);
      sum.push_back(sum.back() + count * static_cast<double>(i));
    }
  }

  /// The contribution of the class of bins [first, last) to the between-class variance, up to a
  /// constant.
  double spread(std::size_t first, std::size_t last) const {
    const double w = weight[last] - weight[first], s = sum[last] - sum[first];
    return w > 0 ? s * s / w : 0;
  }
};

/// The split before bin `split`, moved to the middle of the empty bins around it.
double centred(const std::vector<std::size_t>& counts, std::size_t split) {
  std::size_t first = split, last = split;
  while (first > 1 && counts[first - 1] == 0) --first;
  while (last + 1 < counts.size() && counts[last] == 0) ++last;
  return static_cast<double>(first + last) / 2;
}

std::vector<double> two_classes(const std::vector<std::size_t>& counts, const Moments& moments) {
  double best = -1;
  std::size_t split = 0;
  for (std::size_t i = 1; i < counts.size(); ++i) {
    const double spread = moments.spread(0, i) + moments.spread(i, counts.size());
    if (spread > best) best = spread, split = i;
  }
  return {centred(counts, split)};
}

std::vector<double> three_classes(const std::vector<std::size_t>& counts, const Moments& moments) {
  double best = -1;
  std::size_t lower = 0, upper = 0;
  for (std::size_t i = 1; i + 1 < counts.size(); ++i) {
    for (std::size_t j = i + 1; j < counts.size(); ++j) {
      const double spread =
          moments.spread(0, i) + moments.spread(i, j) + moments.spread(j, counts.size());
      if (spread > best) best = spread, lower = i, upper = j;
    }
  }
  return {centred(counts, lower), centred(counts, upper)};
}

/// The sample value at a position in bins, rounded to the digits that the bins resolve.
double value_at(const SampleHistogram& histogram, double position) {
  const double value = histogram.lowest + position * histogram.width;
  if (histogram.of_integers) return std::ceil(value) - 0.5;
  const double step = std::pow(10, std::floor(std::log10(histogram.width)));
  return std::round(value / step) * step;
}

bool looks_like_distances(const SampleSummary& summary) {
  // Distance fields are often clamped to a band that is symmetric about 0.
  return summary.minimum < 0 && summary.maximum > 0 &&
         std::abs(summary.minimum + summary.maximum) <= 0.01 * (summary.maximum - summary.minimum);
}

}  // namespace

SampleHistogram sample_histogram(const VolumeView& volume, const SampleSummary& summary,
                                 std::size_t most_bins) {
  SampleHistogram histogram;
  if (summary.finite_count == 0) return histogram;
  histogram.of_integers = is_integer(volume.type);
  histogram.lowest = summary.minimum;
  const auto most = static_cast<double>(most_bins);
  double bins = most;
  if (histogram.of_integers) {
    const double values = summary.maximum - summary.minimum + 1;
    histogram.width = std::ceil(values / most);
    bins = std::ceil(values / histogram.width);
  } else if (summary.maximum > summary.minimum) {
    histogram.width = summary.maximum / most - summary.minimum / most;
  }
  histogram.counts.assign(static_cast<std::size_t>(bins), 0);
  const double last = bins - 1;
  visit_samples(volume, [&]<class Sample>(std::span<const Sample> samples) {
    for (const Sample sample : samples) {
      const auto value = static_cast<double>(sample);
      if constexpr (std::is_floating_point_v<Sample>)
        if (!std::isfinite(value)) continue;
      const double bin = (value - histogram.lowest) / histogram.width;
      ++histogram.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, last))];
    }
  });
  return histogram;
}

SampleHistogram coarsened(const SampleHistogram& histogram, std::size_t most_bins) {
  SampleHistogram result = histogram;
  const std::size_t merged = (histogram.counts.size() + most_bins - 1) / most_bins;
  if (merged <= 1) return result;
  result.width *= static_cast<double>(merged);
  result.counts.assign((histogram.counts.size() + merged - 1) / merged, 0);
  for (std::size_t i = 0; i < histogram.counts.size(); ++i)
    result.counts[i / merged] += histogram.counts[i];
  return result;
}

std::vector<SuggestedIsovalue> suggest_isovalues(const SampleHistogram& histogram,
                                                 const SampleSummary& summary) {
  std::vector<SuggestedIsovalue> suggestions;
  const auto suggest = [&](double value, const std::string& reason, bool is_of_distances = false) {
    if (value <= summary.minimum || value >= summary.maximum) return;
    for (SuggestedIsovalue& other : suggestions) {
      if (other.value != value) continue;
      other.reason += "; " + reason;
      return;
    }
    suggestions.push_back({value, reason, is_of_distances});
  };
  if (looks_like_distances(summary)) {
    const std::string reason = "the range is symmetric about 0, as in a signed distance field";
    if (histogram.of_integers)
      suggest(-0.5, reason + " (0 with no ties)", true);
    else
      suggest(0, reason, true);
  }
  const auto occupied = std::count_if(histogram.counts.begin(), histogram.counts.end(),
                                      [](std::size_t n) { return n > 0; });
  const Moments moments(histogram.counts);
  if (occupied >= 2)
    for (const double split : two_classes(histogram.counts, moments))
      suggest(value_at(histogram, split), "splits the samples into two classes (Otsu)");
  if (occupied >= 3)
    for (const double split : three_classes(histogram.counts, moments))
      suggest(value_at(histogram, split),
              "one of two that split the samples into three classes (Otsu)");
  std::sort(suggestions.begin(), suggestions.end(),
            [](const auto& a, const auto& b) { return a.value < b.value; });
  return suggestions;
}

}  // namespace isoatlas::detail::tool
