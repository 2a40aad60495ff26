// SPDX-License-Identifier: Apache-2.0
// What `isoatlas extract` says of its work.
#pragma once

#include <iosfwd>
#include <string>

#include "isoatlas/extract.h"
#include "report/report.h"

namespace isoatlas::detail::tool {

/// A few lines. `outputs` names what was written.
void print_summary(std::ostream& out, const ExtractReport& report, const ReportContext& context,
                   const std::string& outputs);

/// The rest of it: all metrics, complexes, repairs, timings, memory.
void print_details(std::ostream& out, const ExtractReport& report, const ReportContext& context);

/// One line on standard error for each constraint of each level that was asked for and is not met,
/// for each level with self-intersections or with inverted or misplaced components, and for each
/// file in which rounding causes self-intersections. Returns true if nothing was printed.
bool print_unmet(const ExtractReport& report, const ReportContext& context);

/// One line on standard error if a file's float coordinates are a noticeable part of the error:
/// which file, and what to do.
void print_rounding(const ReportContext& context);

}  // namespace isoatlas::detail::tool
