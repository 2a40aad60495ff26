// SPDX-License-Identifier: Apache-2.0
// What `isoatlas extract` prints about a run.
#pragma once

#include <iosfwd>
#include <string>

#include "isoatlas/extract.h"
#include "report/report.h"

namespace isoatlas::detail::tool {

/// Prints the summary, a few lines. `outputs` names the files that were written.
void print_summary(std::ostream& out, const ExtractReport& report, const ReportContext& context,
                   const std::string& outputs);

/// Prints the lines of --verbose: all metrics, complexes, repairs, timings, memory.
void print_details(std::ostream& out, const ExtractReport& report, const ReportContext& context);

/// Prints one line for each requested constraint that a level violates, for each
/// level with self-intersections or with inverted or misplaced components, and for each file in
/// which rounding causes self-intersections. Returns true if nothing was printed.
bool print_violations(std::ostream& out, const ExtractReport& report, const ReportContext& context);

/// Prints one line if the float32 coordinates of a file are a noticeable part of
/// the error: which file, and what to do.
void print_rounding(std::ostream& out, const ReportContext& context);

}  // namespace isoatlas::detail::tool
