// SPDX-License-Identifier: Apache-2.0
#include "progress_bar.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "text.h"

namespace isoatlas::detail::tool {
namespace {

constexpr std::chrono::milliseconds kRedrawInterval{67};  // 15 times a second
constexpr std::chrono::milliseconds kTick{500};           // redrawn at least this often

bool can_redraw_stderr() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

int terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string bar(double fraction, int width, bool utf8) {
  static constexpr std::array<const char*, 8> kEighths{" ", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int eighths = static_cast<int>(fraction * width * 8);
  std::string result;
  for (int i = 0; i < width; ++i) {
    const int filled = std::clamp(eighths - 8 * i, 0, 8);
    if (utf8)
      result += filled == 8 ? "█" : kEighths[static_cast<std::size_t>(filled)];
    else
      result += filled >= 4 ? '#' : '.';
  }
  return result;
}

}  // namespace

ProgressBar::ProgressBar(bool wanted)
    : active_(wanted && can_redraw_stderr()), utf8_(terminal_is_utf8()) {
  if (!active_) return;
  clock_ = std::jthread([this](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!erased_.wait_for(lock, stop, kTick, [this] { return !active_; }) &&
           !stop.stop_requested()) {
      if (!stage_.empty()) draw(Clock::now());
    }
  });
}

void ProgressBar::show(std::string_view stage, std::optional<double> fraction) {
  const std::lock_guard lock(mutex_);
  if (!active_) return;
  const auto now = Clock::now();
  const bool is_new = stage != stage_;
  stage_ = stage;
  fraction_ = fraction;
  if (is_new || now - drawn_ >= kRedrawInterval) draw(now);
}

void ProgressBar::draw(Clock::time_point now) {
  drawn_ = now;
  std::fprintf(stderr, "\r%s\x1b[K", line(now).c_str());
  std::fflush(stderr);
}

void ProgressBar::clear_line() {
  const std::lock_guard lock(mutex_);
  if (!active_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
}

void ProgressBar::erase() {
  ProgressBar::clear_line();
  const std::lock_guard lock(mutex_);
  active_ = false;
  erased_.notify_all();
}

// The remaining time is shown as soon as it can be estimated.
std::string ProgressBar::line(Clock::time_point now) const {
  constexpr int kStageWidth = 10, kNumbersWidth = 40, kWidestBar = 40;
  constexpr double kLeastSeconds = 2, kLeastShare = 0.05;
  std::string result(stage_.substr(0, kStageWidth));
  result.resize(kStageWidth + 1, ' ');
  const double seconds = std::chrono::duration<double>(now - started_).count(),
               share = std::clamp(fraction_.value_or(0), 0.0, 1.0);
  if (fraction_) {
    const int width = std::min(terminal_columns() - kStageWidth - kNumbersWidth, kWidestBar);
    if (width > 4) result += bar(share, width, utf8_) + " ";
    std::array<char, 8> percent{};
    std::snprintf(percent.data(), percent.size(), "%3d %%  ", static_cast<int>(share * 100));
    result += percent.data();
  }
  result += seconds_text(seconds);
  if (seconds >= kLeastSeconds && share >= kLeastShare)
    result += ", about " + seconds_text(std::ceil(seconds * (1 - share) / share)) + " left";
  return result;
}

}  // namespace isoatlas::detail::tool
