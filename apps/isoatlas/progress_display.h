// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace isoatlas::detail::tool {

/// Where a run shows its progress.
class ProgressDisplay {
 public:
  virtual ~ProgressDisplay() = default;

  /// Shows the stage and the `fraction` of the whole in [0, 1]; none: it is unknown.
  virtual void show(std::string_view stage, std::optional<double> fraction) = 0;
  /// Called before a message is printed.
  virtual void clear_line() = 0;
  /// Ends the display; nothing is shown afterwards. May be called from another thread.
  virtual void erase() = 0;
  /// erase() when the run has succeeded.
  virtual void finish() { erase(); }
};

}  // namespace isoatlas::detail::tool
