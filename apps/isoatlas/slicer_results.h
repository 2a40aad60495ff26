// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/report.h"

namespace isoatlas::detail::tool {

/// The file of --returnparameterfile: one line "name = value" for each of slicer_results().
/// @param unit  the unit of the volume
std::string slicer_result_file(const ExtractReport& report, LengthUnit unit);

}  // namespace isoatlas::detail::tool
