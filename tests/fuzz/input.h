// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "isoatlas/extract.h"

namespace isoatlas::detail::test {

/// A tiny volume and a set of options, some of which may be invalid.
struct FuzzInput {
  Volume volume;
  ExtractOptions options;
};

/// Decodes any bytes; missing bytes count as zeros.
FuzzInput decode(const std::uint8_t* data, std::size_t size);

/// Describes the input including its samples, so that a test can be written from the text.
std::string describe(const FuzzInput& input);

}  // namespace isoatlas::detail::test
