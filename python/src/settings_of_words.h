// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "levels.h"
#include "wording/settings.h"

namespace isoatlas::detail::python {

/// The settings that texts state.
/// @throws Error(bad_argument) with the name of the option in Python
ExtractSettings settings_of(const ExtractWords& words);

}  // namespace isoatlas::detail::python
