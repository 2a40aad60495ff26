// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks what a shared isoatlas library exports; all other symbols in it are hidden.
#if defined(__GNUC__)
#define ISOATLAS_API __attribute__((visibility("default")))
#else
#define ISOATLAS_API
#endif
