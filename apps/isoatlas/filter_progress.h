// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "progress_display.h"

namespace isoatlas::detail::tool {

/// As the first word of a command line: `isoatlas extract` shows its progress as FilterProgress.
inline constexpr const char* kFilterProgressFlag = "--filter-progress";

/// True for a line that FilterProgress prints.
bool is_filter_line(std::string_view line);
/// The text of an element in a line of FilterProgress; none if the line does not contain it.
std::optional<std::string> filter_value(std::string_view line, std::string_view element);

/// Progress as XML elements on standard output, which 3D Slicer and other hosts of command-line
/// modules read: <filter-start>, <filter-progress>, <filter-comment> (the stage), <filter-end>.
class FilterProgress : public ProgressDisplay {
 public:
  /// Prints <filter-start>.
  /// @param name  the name of the module, without characters that XML reserves
  explicit FilterProgress(std::string name);
  ~FilterProgress() override { FilterProgress::erase(); }
  FilterProgress(const FilterProgress&) = delete;
  FilterProgress& operator=(const FilterProgress&) = delete;

  void show(std::string_view stage, std::optional<double> fraction) override;
  void clear_line() override {}
  void erase() override;   ///< prints <filter-end>
  void finish() override;  ///< erase() after the progress 1

 private:
  using Clock = std::chrono::steady_clock;
  void end(bool is_complete);

  std::string name_;
  Clock::time_point started_ = Clock::now();
  std::mutex mutex_;  // erase() may come from another thread
  bool active_ = true;
  std::string stage_;
  double printed_ = 0;  // the fraction that was printed last
};

}  // namespace isoatlas::detail::tool
