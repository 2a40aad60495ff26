// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

namespace isoatlas::detail::io {

/// How a stream is compressed. deflate: gzip or zlib, as the stream's header states.
enum class Packing { none, deflate, bzip2 };

/// Decompresses a stream of one or more members (the units of gzip and bzip2 files).
class Decompressor {
 public:
  virtual ~Decompressor() = default;
  struct Step {
    std::size_t consumed = 0, produced = 0;  ///< bytes
    bool at_end = false;                     ///< of a member
  };
  /// Decompresses from [from, from + available) into [to, to + room).
  /// @throws const char* if the stream is damaged
  virtual Step step(const char* from, std::size_t available, char* to, std::size_t room) = 0;
  virtual void start_next_member() = 0;
};

/// The decompressor of a packing; null for Packing::none.
std::unique_ptr<Decompressor> decompressor_for(Packing packing);

}  // namespace isoatlas::detail::io
