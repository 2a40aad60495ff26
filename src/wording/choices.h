// SPDX-License-Identifier: Apache-2.0
// Parses option values that are one of several names.
#pragma once

#include <string_view>

#include "isoatlas/options.h"

namespace isoatlas::detail {

// Each function throws Error(bad_argument), which lists the names, unless `text` is one of them.
// Case and surrounding blanks are ignored, and "_" equals "-".
Inside parse_inside(std::string_view text);                ///< above, below
Topology parse_topology(std::string_view text);            ///< trilinear, faces
Interpolation parse_interpolation(std::string_view text);  ///< trilinear, tricubic
NonFinite parse_non_finite(std::string_view text);         ///< below, above; not `refuse`
Space parse_space(std::string_view text);                  ///< lps, ras, voxel
CoveringStrategy parse_covering(std::string_view text);    ///< sizing-field, halving
Placement parse_placement(std::string_view text);          ///< surface, balanced
Border parse_border(std::string_view text);                ///< open, closed
SampleType parse_sample_type(std::string_view text);       ///< int8 ... float64
bool parse_is_big_endian(std::string_view text);           ///< little, big

}  // namespace isoatlas::detail
