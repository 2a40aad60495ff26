// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/ids.h"

namespace isoatlas::detail {

/// The c-vertices of each cell of a partition, as linked lists: moving a c-vertex to another cell
/// takes constant time. 8 bytes per c-vertex and 8 per cell.
class CellMembers {
 public:
  CellMembers() = default;
  /// @param cell_of  per c-vertex; kNone: in no cell
  CellMembers(std::span<const CellId> cell_of, std::uint32_t cells)
      : lists_(cells), links_(cell_of.size()) {
    for (auto v = static_cast<CVertexId>(cell_of.size());
         v-- > 0;) {  // backwards, so that each list starts in increasing order
      if (cell_of[v] != kNone) insert(v, cell_of[v]);
    }
  }

  void add_cells(std::size_t count) { lists_.resize(lists_.size() + count); }
  void remove_cells(std::size_t from) {
    lists_.resize(from);
  }  ///< @pre the cells from `from` on are empty
  void add_c_vertices(std::size_t count) {
    links_.resize(links_.size() + count);
  }  ///< in no cell yet

  std::uint32_t cell_count() const { return static_cast<std::uint32_t>(lists_.size()); }
  std::uint32_t count(CellId cell) const { return lists_[cell].count; }
  /// Any c-vertex of the cell; kNone if it is empty.
  CVertexId first(CellId cell) const { return lists_[cell].head; }

  template <class Visit>
  void for_each(CellId cell, Visit visit) const {
    for (CVertexId v = lists_[cell].head; v != kNone; v = links_[v].next) visit(v);
  }

  /// @pre v is in no cell
  void insert(CVertexId v, CellId cell) {
    List& list = lists_[cell];
    links_[v] = {list.head, kNone};
    if (list.head != kNone) links_[list.head].previous = v;
    list.head = v;
    ++list.count;
  }
  void erase(CVertexId v, CellId cell) {
    List& list = lists_[cell];
    const Link link = links_[v];
    (link.previous == kNone ? list.head : links_[link.previous].next) = link.next;
    if (link.next != kNone) links_[link.next].previous = link.previous;
    --list.count;
  }

 private:
  struct List {
    CVertexId head = kNone;
    std::uint32_t count = 0;
  };
  struct Link {
    CVertexId next = kNone, previous = kNone;
  };
  std::vector<List> lists_;
  std::vector<Link> links_;
};

}  // namespace isoatlas::detail
