// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace isoatlas::detail::python {

/// Registers the translation of each Error that leaves a function of this module into an exception
/// of isoatlas.errors: one class per error code. Call it once, when the module is loaded.
void translate_errors();

}  // namespace isoatlas::detail::python
