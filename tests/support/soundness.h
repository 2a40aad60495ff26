// SPDX-License-Identifier: Apache-2.0
// What must hold of any extraction, whatever went in: said in words rather than by a test framework, so that fuzzers may ask too.
#pragma once

#include <string>

#include "isoatlas/extract.h"

namespace isoatlas::detail::test {

/// Levels that were asked to be embedded are: no two triangles of a level meet where they should not. false only counts them, and they must
/// be as many as the report says.
inline constexpr bool kEmbedded = true;

/// @param options  what was asked for
/// @return an empty string, or what is wrong and where: every level a manifold, oriented, certified, of the reference surface's topology,
///         counted here from the triangles; levels nested; positions finite; the report true
std::string what_is_wrong(const Extraction& extraction, const ExtractOptions& options);

}  // namespace isoatlas::detail::test
