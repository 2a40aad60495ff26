// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.h"

namespace isoatlas::detail {

/// Rows of items in one array, as in CSR adjacency, that can change: each row has its own capacity,
/// and a row that exceeds it moves to the end of the array. The array is compacted once half of it
/// is unused.
template <class Item>
class SlackRows {
 public:
  /// @param sizes  per row, number of items that can be added without moving the row
  void reserve(std::span<const std::uint32_t> sizes) {
    rows_.resize(sizes.size());
    std::size_t total = 0;
    for (std::size_t r = 0; r < sizes.size(); ++r) {
      rows_[r] = {static_cast<std::uint32_t>(total), 0, sizes[r]};
      total += sizes[r];
    }
    items_.resize(checked_id(total, "items of rows"));
  }

  std::uint32_t row_count() const { return static_cast<std::uint32_t>(rows_.size()); }
  void add_rows(std::size_t count) { rows_.resize(rows_.size() + count); }  ///< empty ones
  /// Removes the last rows, or adds empty ones.
  void resize_rows(std::size_t count) {
    for (std::size_t r = count; r < rows_.size(); ++r) unused_ += rows_[r].capacity;
    rows_.resize(count);
  }

  std::span<const Item> row(std::uint32_t r) const {
    return {items_.data() + rows_[r].first, rows_[r].size};
  }
  std::span<Item> row(std::uint32_t r) { return {items_.data() + rows_[r].first, rows_[r].size}; }

  void push_back(std::uint32_t r, const Item& item) {
    Row& row = rows_[r];
    if (row.size == row.capacity) move_to_end(row, std::max(kMinCapacity, 2 * row.capacity));
    items_[row.first + row.size++] = item;
  }

  /// Replaces a row.
  void assign(std::uint32_t r, std::span<const Item> items) {
    Row& row = rows_[r];
    row.size = 0;
    if (items.size() > row.capacity) move_to_end(row, static_cast<std::uint32_t>(items.size()));
    std::copy(items.begin(), items.end(), items_.begin() + row.first);
    row.size = static_cast<std::uint32_t>(items.size());
  }

  /// Removes the first item equal to `item`; the others keep their order.
  void erase(std::uint32_t r, const Item& item) {
    const std::span<Item> items = row(r);
    const auto found = std::find(items.begin(), items.end(), item);
    if (found == items.end()) return;
    std::copy(found + 1, items.end(), found);
    --rows_[r].size;
  }

 private:
  struct Row {
    std::uint32_t first = 0, size = 0, capacity = 0;
  };
  static constexpr std::uint32_t kMinCapacity = 8;

  void move_to_end(Row& row, std::uint32_t capacity) {
    unused_ += row.capacity;
    if (unused_ > kMinUnusedToCompact && 2 * unused_ > items_.size()) compact(row);
    const std::uint32_t first = checked_id(items_.size(), "items of rows");
    items_.resize(items_.size() + capacity);
    std::copy_n(items_.begin() + row.first, row.size, items_.begin() + first);
    row.first = first;
    row.capacity = capacity;
  }

  // All rows keep their capacities, except `moving`, which shrinks to its items.
  void compact(Row& moving) {
    moving.capacity = moving.size;
    std::vector<Item> items;
    std::size_t total = 0;
    for (const Row& row : rows_) total += row.capacity;
    items.resize(total);
    std::uint32_t first = 0;
    for (Row& row : rows_) {
      std::copy_n(items_.begin() + row.first, row.size, items.begin() + first);
      row.first = std::exchange(first, first + row.capacity);
    }
    items_ = std::move(items);
    unused_ = moving.capacity;
  }

  static constexpr std::size_t kMinUnusedToCompact = 1024;
  std::vector<Item> items_;
  std::vector<Row> rows_;
  std::size_t unused_ = 0;  // number of items that belong to no row
};

}  // namespace isoatlas::detail
