// SPDX-License-Identifier: Apache-2.0
#include "view/events.h"

#include <algorithm>
#include <utility>

namespace isoatlas::detail::tool {

void Events::send(std::string message) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(std::move(message));
  if (messages_.size() > kKept) {
    messages_.pop_front();
    ++first_;
  }
  sent_.notify_all();
}

Events::Number Events::open(std::optional<Number> last) {
  const std::lock_guard lock(mutex_);
  ++pages_;
  had_page_ = true;
  const Number end = first_ + messages_.size();
  return last && *last < end ? std::max(*last + 1, first_) : end;
}

void Events::close() {
  const std::lock_guard lock(mutex_);
  --pages_;
  last_closed_ = Clock::now();
}

std::string Events::wait(Number& next, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const auto end = [&] { return first_ + messages_.size(); };
  sent_.wait_for(lock, patience, [&] { return next < end(); });
  std::string out;
  for (Number n = std::max(next, first_); n < end(); ++n)
    out += "id: " + std::to_string(n) + "\ndata: " + messages_[n - first_] + "\n\n";
  next = end();
  return out;
}

bool Events::all_closed_for(Clock::duration time) const {
  const std::lock_guard lock(mutex_);
  return had_page_ && pages_ == 0 && Clock::now() - last_closed_ > time;
}

std::size_t Events::open_pages() const {
  const std::lock_guard lock(mutex_);
  return pages_;
}

}  // namespace isoatlas::detail::tool
