// SPDX-License-Identifier: Apache-2.0
#include "filter_progress.h"

#include <cstdio>

namespace isoatlas::detail::tool {
namespace {

constexpr double kStep = 0.01;  // smaller steps are not printed

}  // namespace

bool is_filter_line(std::string_view line) {
  return line.starts_with("<filter-") || line.starts_with("</filter-");
}

std::optional<std::string> filter_value(std::string_view line, std::string_view element) {
  const std::string begin = "<" + std::string(element) + ">";
  if (!line.starts_with(begin)) return std::nullopt;
  return std::string(line.substr(begin.size(), line.find("</") - begin.size()));
}

FilterProgress::FilterProgress(std::string name) : name_(std::move(name)) {
  std::printf(
      "<filter-start>\n<filter-name>%s</filter-name>\n"
      "<filter-comment>start</filter-comment>\n</filter-start>\n",
      name_.c_str());
  std::fflush(stdout);
}

void FilterProgress::show(std::string_view stage, std::optional<double> fraction) {
  const std::lock_guard lock(mutex_);
  if (!active_) return;
  const bool is_new = stage != stage_;
  if (!is_new && fraction.value_or(0) < printed_ + kStep) return;
  if (is_new)
    std::printf("<filter-comment>%.*s</filter-comment>\n", static_cast<int>(stage.size()),
                stage.data());
  stage_ = stage;
  if (fraction) {
    printed_ = *fraction;
    std::printf("<filter-progress>%.3f</filter-progress>\n", printed_);
  }
  std::fflush(stdout);
}

void FilterProgress::erase() { end(false); }
void FilterProgress::finish() { end(true); }

void FilterProgress::end(bool is_complete) {
  const std::lock_guard lock(mutex_);
  if (!active_) return;
  active_ = false;
  if (is_complete) std::puts("<filter-progress>1</filter-progress>");
  const double seconds = std::chrono::duration<double>(Clock::now() - started_).count();
  std::printf(
      "<filter-end>\n<filter-name>%s</filter-name>\n<filter-time>%.3f</filter-time>\n"
      "</filter-end>\n",
      name_.c_str(), seconds);
  std::fflush(stdout);
}

}  // namespace isoatlas::detail::tool
