// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace isoatlas::detail::python {

/// Makes an exception of isoatlas.errors of each Error that leaves a function of this module: one
/// class per code.
void translate_errors();

}  // namespace isoatlas::detail::python
