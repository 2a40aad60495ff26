// SPDX-License-Identifier: Apache-2.0
// Any bytes as a file of one format: reading must give an Error, or the same sound volume or mesh
// every time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace isoatlas::detail::test {

/// Formats that are fuzzed, by the extension without its dot: "nrrd" ... "json", which is a report.
bool is_fuzzed_format(std::string_view format);

/// What is wrong with what reading makes of these bytes; empty if nothing is.
std::string what_is_wrong_with_file(std::string_view format, std::span<const std::uint8_t> bytes);

}  // namespace isoatlas::detail::test
