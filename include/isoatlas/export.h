// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks the symbols that a shared isoatlas library exports. All other symbols are hidden.
#if defined(__GNUC__)
#define ISOATLAS_API __attribute__((visibility("default")))
#else
#define ISOATLAS_API
#endif
