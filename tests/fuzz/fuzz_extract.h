// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/input.h"

namespace isoatlas::detail::test {

/// Extracts; the input must be refused as the user's fault or give sound levels.
/// @return an empty string, or what is wrong
std::string what_is_wrong_with(const FuzzInput& input);

}  // namespace isoatlas::detail::test

/// What libFuzzer calls; says what is wrong, and aborts.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
