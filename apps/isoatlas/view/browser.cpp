// SPDX-License-Identifier: Apache-2.0
#include "view/browser.h"

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "view/start_process.h"

namespace isoatlas::detail::tool {
namespace {

bool has_screen() {
#ifdef __APPLE__
  return true;
#else
  return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
#endif
}

#ifdef __APPLE__
constexpr const char* kOpener = "open";
#else
constexpr const char* kOpener = "xdg-open";
#endif

}  // namespace

bool open_in_browser(const std::string& address, const std::filesystem::path& folder) {
  if (!has_screen()) return false;
  const std::filesystem::path leads = folder / "open.html";
  std::ofstream(leads) << "<!doctype html><meta http-equiv=\"refresh\" content=\"0;url=" << address
                       << "\"><a href=\"" << address << "\">isoatlas view</a>\n";
  const pid_t process = start_process(kOpener, {kOpener, leads.string()});
  if (process < 0) return false;
  std::thread([process] { waitpid(process, nullptr, 0); }).detach();
  return true;
}

}  // namespace isoatlas::detail::tool
