// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail {

/// @throws Error(bad_argument) with the message unless the condition holds
inline void require(bool condition, const std::string& message) {
  if (!condition) throw Error(ErrorCode::bad_argument, message);
}

}  // namespace isoatlas::detail
