// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace isoatlas::detail::tool {

/// Opens an address in the user's browser, if there is a screen. Other users of the machine see the
/// arguments of programs, so the browser gets a file that leads to the address.
/// @param folder  for the file, readable by this user only
/// @return whether a program was started
bool open_in_browser(const std::string& address, const std::filesystem::path& folder);

}  // namespace isoatlas::detail::tool
