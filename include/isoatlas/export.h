// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks the symbols that a shared isoatlas library exports. All other symbols are hidden.
#if defined(__GNUC__)
#define ISOATLAS_API __attribute__((visibility("default")))
#else
#define ISOATLAS_API
#endif

/// Marks a result that refers to the object of a member function: clang then warns where the result
/// outlives a temporary object.
#if defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::lifetimebound)
#define ISOATLAS_LIFETIMEBOUND [[clang::lifetimebound]]
#endif
#endif
#ifndef ISOATLAS_LIFETIMEBOUND
#define ISOATLAS_LIFETIMEBOUND
#endif
