// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace isoatlas::detail::page {

/// The script and the style sheet of the report page, built from web/ and compiled into the
/// library. Empty in a build without pages.
std::string_view script();
std::string_view style();

/// The same of the page of `isoatlas view`.
std::string_view view_script();
std::string_view view_style();

}  // namespace isoatlas::detail::page
