// SPDX-License-Identifier: Apache-2.0
// Invariants of any extraction, for any input. Returns text instead of using a test framework, so
// that fuzzers can use it, too.
#pragma once

#include <string>

#include "isoatlas/extract.h"

namespace isoatlas::detail::test {

/// Levels that were requested to be embedded have no self-intersections. false only counts them,
/// and their number must equal the reported one.
inline constexpr bool kEmbedded = true;

/// @param options  of the extraction
/// @return an empty string, or the first fault and its place: every level must be an oriented,
///         certified manifold of the reference surface's topology, counted here from the triangles;
///         levels must be nested, positions finite, and the report correct
std::string what_is_wrong(const Extraction& extraction, const ExtractOptions& options);

}  // namespace isoatlas::detail::test
