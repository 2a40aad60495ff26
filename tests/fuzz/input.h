// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "isoatlas/extract.h"

namespace isoatlas::detail::test {

/// A tiny volume and a set of options, some of which nobody may ask for.
struct FuzzInput {
  Volume volume;
  ExtractOptions options;
};

/// Any bytes are one; where there are too few they go on as zeros.
FuzzInput decode(const std::uint8_t* data, std::size_t size);

/// In words, down to the samples, to make a test of.
std::string describe(const FuzzInput& input);

}  // namespace isoatlas::detail::test
