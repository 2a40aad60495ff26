// SPDX-License-Identifier: Apache-2.0
// The distribution of the samples of a volume, and isovalues that it suggests.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas::detail::tool {

/// Bin i counts the finite samples in [lowest + i * width, lowest + (i + 1) * width); the last bin
/// includes its upper end. For integer types `width` is a whole number, so that all bins have the
/// same number of different values.
struct SampleHistogram {
  double lowest = 0, width = 1;
  bool of_integers = false;
  std::vector<std::size_t> counts;
};

/// One pass over the samples. Empty if no sample is finite.
SampleHistogram sample_histogram(const VolumeView& volume, const SampleSummary& summary,
                                 std::size_t most_bins = 4096);

/// The histogram with neighbouring bins merged, for drawing.
SampleHistogram coarsened(const SampleHistogram& histogram, std::size_t most_bins);

struct SuggestedIsovalue {
  double value = 0;
  std::string reason;
  bool is_of_distances = false;  ///< the samples look like a signed distance field
};

/// Suggested isovalues in increasing order: thresholds that split the samples into two and into
/// three classes (Otsu), and zero if the samples look like a signed distance field. For integer
/// types all isovalues are half-way between two integers, so that no sample equals them and the
/// surface passes through no sample.
std::vector<SuggestedIsovalue> suggest_isovalues(const SampleHistogram& histogram,
                                                 const SampleSummary& summary);

}  // namespace isoatlas::detail::tool
