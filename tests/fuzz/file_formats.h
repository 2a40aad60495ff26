// SPDX-License-Identifier: Apache-2.0
// Any bytes as a file of one format: reading must give an Error, or the same valid volume or mesh
// every time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace isoatlas::detail::test {

/// True for the formats that are fuzzed, by their extension without the dot: "nrrd" ... "json",
/// which is a report.
bool is_fuzzed_format(std::string_view format);

/// Reads the bytes and describes the problem of the result; empty without a problem.
std::string find_problem_in_file(std::string_view format, std::span<const std::uint8_t> bytes);

}  // namespace isoatlas::detail::test
