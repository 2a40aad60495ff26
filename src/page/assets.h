// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace isoatlas::detail::page {

/// The script and the style sheet of the page, built from web/ and compiled into the library. Empty
/// in a build without pages.
std::string_view script();
std::string_view style();

}  // namespace isoatlas::detail::page
