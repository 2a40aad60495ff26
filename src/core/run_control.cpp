// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/run_control.h"

#include "isoatlas/error.h"

namespace isoatlas {

void RunControl::check_cancelled() const {
  if (cancel && cancel->load(std::memory_order_relaxed))
    throw Error(ErrorCode::cancelled, "interrupted");
}

void RunControl::report(std::string_view stage, double fraction) const {
  check_cancelled();
  if (progress) progress(stage, fraction);
}

}  // namespace isoatlas
