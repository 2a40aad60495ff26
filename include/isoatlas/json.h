// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/export.h"
#include "isoatlas/report.h"

namespace isoatlas {

/// A report as JSON text in UTF-8, schema "isoatlas-report-3", which docs/reference/report.md
/// documents. Values that extract() does not know are null: `command`, `input`, `surface`,
/// `parameters`, `levels[].path`, the seconds of reading and writing, and `peak_memory_bytes`.
/// `files` is empty. The text depends only on the report. O(size of the report)
ISOATLAS_API std::string to_json(const ExtractReport& report);

}  // namespace isoatlas
