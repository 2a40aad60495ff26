// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace isoatlas::detail::page {

/// The page's code and its style sheet, built from web/ and compiled in; empty in a build without
/// pages.
std::string_view script();
std::string_view style();

}  // namespace isoatlas::detail::page
