// SPDX-License-Identifier: Apache-2.0
// The messages to the pages of `isoatlas view`: JSON on one line.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "progress_display.h"
#include "view/events.h"

namespace isoatlas::detail::tool {

/// A message with a type and the request that it is about.
std::string message(std::string_view type, std::int64_t request);
std::string failure(std::int64_t request, std::string_view text);
/// @param id  of the mesh, to fetch it with
std::string mesh_message(std::int64_t request, std::uint64_t id, std::size_t reduction,
                         bool is_final);
/// A file that can be fetched.
struct SavedFile {
  std::uint64_t id = 0;
  std::string name;
  std::uintmax_t bytes = 0;
  bool satisfied = true;  ///< all bounds
  std::string summary;    ///< what the command printed
};
std::string saved_message(std::int64_t request, const SavedFile& file);
std::string goodbye(std::string_view text);

/// Sends the progress of a request, at most 20 times a second.
class ProgressMessages {
 public:
  ProgressMessages(Events& events, std::int64_t request) : events_(events), request_(request) {}
  void show(std::string_view stage, std::optional<double> fraction);

 private:
  Events& events_;
  std::int64_t request_;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace isoatlas::detail::tool
