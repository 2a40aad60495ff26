// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/input.h"

namespace isoatlas::detail::test {

/// Extracts; the input must be refused with a user's error or give sound levels.
/// @return an empty string, or a description of the problem
std::string find_problem(const FuzzInput& input);

}  // namespace isoatlas::detail::test

/// The entry point for libFuzzer; prints the problem and aborts.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
