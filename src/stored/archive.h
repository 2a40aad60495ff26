// SPDX-License-Identifier: Apache-2.0
// Stores values of the library's types as bytes: for pickles and for the files of blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "isoatlas/error.h"
#include "stored/fields.h"

namespace isoatlas::detail {

/// Types that are stored as their bytes. They have no padding.
template <class T>
struct IsPlain : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>> {};
template <>
struct IsPlain<Vec3> : std::true_type {};
template <>
struct IsPlain<Size3> : std::true_type {};
template <class T, std::size_t N>
struct IsPlain<std::array<T, N>> : IsPlain<T> {};

template <class T>
concept List = requires {
  typename T::allocator_type;
};
template <class T>
concept Optional = requires(T it) {
  it.has_value();
};
template <class T>
concept FixedSize = requires {
  std::tuple_size<T>::value;
};

template <class Archive, class T>
void transfer(Archive& archive, T& it) {
  if constexpr (IsPlain<T>::value) {
    archive.bytes(&it, sizeof it);
  } else if constexpr (List<T>) {
    archive.resize(it);
    if constexpr (IsPlain<typename T::value_type>::value)
      archive.bytes(it.data(), it.size() * sizeof *it.data());
    else
      for (auto& item : it) transfer(archive, item);
  } else if constexpr (Optional<T>) {
    bool has_value = it.has_value();
    transfer(archive, has_value);
    if (has_value && !it) it.emplace();
    if (has_value) transfer(archive, *it);
  } else if constexpr (FixedSize<T>) {
    for (auto& item : it) transfer(archive, item);
  } else {
    std::apply([&](auto&... field) { (transfer(archive, field), ...); }, fields(it));
  }
}

class ArchiveWriter {
 public:
  void bytes(const void* from, std::size_t count) {
    out_.append(static_cast<const char*>(from), count);
  }
  template <class List>
  void resize(const List& list) {
    const std::size_t size = list.size();
    bytes(&size, sizeof size);
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

class ArchiveReader {
 public:
  /// @param name  of the data in messages
  ArchiveReader(std::string_view bytes, std::string_view name) : rest_(bytes), name_(name) {}

  void bytes(void* to, std::size_t count) {
    require(count <= rest_.size());
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_.remove_prefix(count);
  }
  template <class List>
  void resize(List& list) {
    std::size_t size = 0;
    bytes(&size, sizeof size);
    require(size <= rest_.size());  // an item has at least one byte
    list.resize(size);
  }
  void require_end() const { require(rest_.empty()); }
  void require(bool is_complete) const {
    if (!is_complete)
      throw Error(ErrorCode::bad_argument, std::string(name_) + " are incomplete or damaged");
  }

 private:
  std::string_view rest_, name_;
};

/// The same value gives the same bytes on the same kind of machine.
/// @cost O(size) time and memory
template <class T>
std::string bytes_of(const T& it) {
  ArchiveWriter writer;
  transfer(writer, const_cast<T&>(it));  // a writer only reads
  return writer.take();
}

/// The inverse of bytes_of().
/// @param name  of the data in messages: "the pickled data"
/// @throws Error(bad_argument) if the bytes are incomplete or too many
template <class T>
T from_bytes(std::string_view bytes, std::string_view name) {
  ArchiveReader reader(bytes, name);
  T it;
  transfer(reader, it);
  reader.require_end();
  return it;
}

/// Checks what others index with: corners and numbers of vertices.
/// @throws Error(bad_argument)
void require_corners_in_range(const Hierarchy& hierarchy, std::string_view name);

}  // namespace isoatlas::detail
