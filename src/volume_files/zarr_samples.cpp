// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "files/byte_source.h"
#include "files/file_error.h"
#include "volume_files/stored_volumes.h"
#include "volume_files/zarr_array.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

using Index = std::vector<std::uint64_t>;  // per axis

constexpr bool kIsBigEndian = std::endian::native == std::endian::big;

std::string text(const Index& index) {
  std::string out;
  for (const std::uint64_t i : index) out += (out.empty() ? "" : ", ") + std::to_string(i);
  return "(" + out + ")";
}

// Calls visit(index) for all indices from `first` to `last`, both included.
template <class Visit>
void for_each_index(const Index& first, const Index& last, Visit visit) {
  for (Index index = first;;) {
    visit(std::as_const(index));
    std::size_t a = index.size();
    while (a > 0 && index[a - 1] == last[a - 1]) {
      --a;
      index[a] = first[a];
    }
    if (a == 0) return;
    ++index[a - 1];
  }
}

class ZarrSampleReader {
 public:
  ZarrSampleReader(const ZarrArray& array, const ZarrSelection& selection, std::byte* samples)
      : array_(array),
        samples_(samples),
        sample_bytes_(array.fill_value.size()),
        first_(selection.first),
        end_(selection.first),
        step_(first_.size(), 0) {
    for (std::uint64_t& end : end_) ++end;
    std::uint64_t step = sample_bytes_;
    for (const auto& [axis, count] : {std::pair{selection.x_axis, selection.size[0]},
                                      {selection.y_axis, selection.size[1]},
                                      {selection.z_axis, selection.size[2]}}) {
      axes_.push_back(axis);
      end_[axis] = first_[axis] + count;
      step_[axis] = step;
      step *= count;
    }
  }

  ZarrChunkCount read() {
    const auto [first, last] = chunks_in(array_.chunk, Index(first_.size(), 0), array_.size);
    for_each_index(first, last, [&](const Index& index) { read_file(index); });
    return count_;
  }

 private:
  // The first and the last chunk with a part of the selection, in a range of the array.
  std::pair<Index, Index> chunks_in(const ZarrChunk& chunk, const Index& begin,
                                    const Index& size) const {
    std::pair<Index, Index> out;
    for (std::size_t a = 0; a < first_.size(); ++a) {
      const std::uint64_t low = std::max(first_[a], begin[a]),
                          high = std::min(end_[a], begin[a] + size[a]) - 1;
      out.first.push_back((low - begin[a]) / chunk.size[a]);
      out.second.push_back((high - begin[a]) / chunk.size[a]);
    }
    return out;
  }

  fs::path path_of(const Index& index) const {
    std::string name = array_.has_prefix ? "c" : "";
    for (const std::uint64_t i : index)
      name += (name.empty() ? "" : std::string(1, array_.separator)) + std::to_string(i);
    return array_.folder / name;
  }

  // A chunk, or a shard with several.
  void read_file(const Index& index) {
    const fs::path path = path_of(index);
    const Index begin = times(index, array_.chunk.size);
    std::error_code error;
    const bool is_stored = fs::exists(path, error);
    if (!is_stored && error) throw bad_file(path, "cannot be read: " + error.message());
    if (!is_stored) {
      ++count_.all;
      return fill(begin, array_.chunk.size);
    }
    if (array_.sharding) return read_shard(path, index, begin);
    take(file_contents(path), path, index, array_.chunk, begin);
  }

  static Index times(const Index& a, const Index& b) {
    Index out(a.size());
    std::transform(a.begin(), a.end(), b.begin(), out.begin(), std::multiplies<>());
    return out;
  }

  void read_shard(const fs::path& path, const Index& shard, const Index& begin) {
    const ZarrArray::Sharding& sharding = *array_.sharding;
    Index counts(shard.size());
    std::uint64_t chunks = 1;
    for (std::size_t a = 0; a < shard.size(); ++a) {
      counts[a] = array_.chunk.size[a] / sharding.chunk.size[a];
      chunks *= counts[a];
    }
    std::ifstream file(path, std::ios::binary);
    const std::uint64_t size = readable_file_size(path);
    const std::string index = read_index(file, path, size, chunks);
    const auto number = [&](std::uint64_t at) {
      std::uint64_t value = 0;
      std::memcpy(&value, index.data() + 8 * at, sizeof value);
      return value;
    };
    const auto [first, last] = chunks_in(sharding.chunk, begin, array_.chunk.size);
    for_each_index(first, last, [&](const Index& in_shard) {
      std::uint64_t at = 0;
      Index chunk(shard.size()), from(shard.size());
      for (std::size_t a = 0; a < shard.size(); ++a) {
        at = at * counts[a] + in_shard[a];
        chunk[a] = shard[a] * counts[a] + in_shard[a];
        from[a] = begin[a] + in_shard[a] * sharding.chunk.size[a];
      }
      const std::uint64_t offset = number(2 * at), bytes = number(2 * at + 1);
      if (offset == ~std::uint64_t{0} && bytes == offset) {
        ++count_.all;
        return fill(from, sharding.chunk.size);
      }
      if (offset > size || bytes > size - offset) throw damaged(path, chunk, "it is cut off");
      take(bytes_at(file, path, offset, bytes), path, chunk, sharding.chunk, from);
    });
  }

  // The offset and the size of each chunk of a shard.
  std::string read_index(std::ifstream& file, const fs::path& path, std::uint64_t size,
                         std::uint64_t chunks) const {
    const ZarrArray::Sharding& sharding = *array_.sharding;
    const std::uint64_t numbers = 2 * chunks,
                        bytes = 8 * numbers + 4 * sharding.index_codecs.size();
    if (chunks > size || bytes > size) throw bad_file(path, "is a shard without its index");
    std::string index = bytes_at(file, path, sharding.is_index_first ? 0 : size - bytes, bytes);
    try {
      index = decode_chunk(std::move(index), sharding.index_codecs, 8 * numbers);
    } catch (const char* what) {
      throw bad_file(path, std::string("is a shard with a damaged index: ") + what);
    }
    if (sharding.is_index_big_endian != kIsBigEndian) swap_byte_order(index.data(), numbers, 8);
    return index;
  }

  static std::string bytes_at(std::ifstream& file, const fs::path& path, std::uint64_t offset,
                              std::uint64_t bytes) {
    std::string out(bytes, '\0');
    file.seekg(static_cast<std::streamoff>(offset));
    file.read(out.data(), static_cast<std::streamsize>(bytes));
    if (!file) throw bad_file(path, "cannot be read at byte " + std::to_string(offset));
    return out;
  }

  static Error damaged(const fs::path& path, const Index& chunk, const char* what) {
    return bad_file(path, "chunk " + text(chunk) + " is damaged: " + what +
                              "; expected it as the program wrote it");
  }

  void take(std::string stored, const fs::path& path, const Index& index, const ZarrChunk& chunk,
            const Index& begin) {
    std::uint64_t values = 1;
    for (const std::uint64_t n : chunk.size) values *= n;
    try {
      stored = decode_chunk(std::move(stored), chunk.codecs, values * array_.value_bytes);
    } catch (const char* what) {
      throw damaged(path, index, what);
    }
    if (chunk.is_big_endian != kIsBigEndian)
      swap_byte_order(stored.data(), values, array_.value_bytes);
    if (array_.is_half) stored = float_values(stored);
    Index step(chunk.size.size());
    std::uint64_t next = sample_bytes_;
    for (std::size_t k = step.size(); k-- > 0;) {
      step[chunk.order[k]] = next;
      next *= chunk.size[chunk.order[k]];
    }
    copy(stored.data(), step, begin, chunk.size);
    ++count_.all;
    ++count_.stored;
  }

  static std::string float_values(const std::string& halves) {
    std::string out(2 * halves.size(), '\0');
    for (std::size_t i = 0; i < halves.size(); i += 2) {
      std::uint16_t half = 0;
      std::memcpy(&half, halves.data() + i, sizeof half);
      const float value = float_of_half(half);
      std::memcpy(out.data() + 2 * i, &value, sizeof value);
    }
    return out;
  }

  void fill(const Index& begin, const Index& size) {
    copy(array_.fill_value.data(), Index(size.size(), 0), begin, size);
  }

  // Copies the part of a chunk that is selected. `step` is the distance of values along each axis,
  // in bytes.
  void copy(const char* values, const Index& step, const Index& begin, const Index& size) {
    std::array<std::uint64_t, 3> count{}, from_step{}, to_step{};
    const char* from = values;
    std::byte* to = samples_;
    for (std::size_t a = 0; a < begin.size(); ++a) {
      const std::uint64_t low = std::max(first_[a], begin[a]);
      from += (low - begin[a]) * step[a];
      to += (low - first_[a]) * step_[a];
      for (std::size_t k = 0; k < 3; ++k) {
        if (axes_[k] != a) continue;
        count[k] = std::min(end_[a], begin[a] + size[a]) - low;
        from_step[k] = step[a];
        to_step[k] = step_[a];
      }
    }
    for (std::uint64_t z = 0; z < count[2]; ++z) {
      for (std::uint64_t y = 0; y < count[1]; ++y) {
        const char* const row = from + z * from_step[2] + y * from_step[1];
        std::byte* const out = to + z * to_step[2] + y * to_step[1];
        if (from_step[0] == sample_bytes_) {
          std::memcpy(out, row, count[0] * sample_bytes_);
          continue;
        }
        for (std::uint64_t x = 0; x < count[0]; ++x)
          std::memcpy(out + x * sample_bytes_, row + x * from_step[0], sample_bytes_);
      }
    }
  }

  const ZarrArray& array_;
  std::byte* samples_;
  std::size_t sample_bytes_;
  Index first_, end_;              // the selection
  Index step_;                     // distance of samples along each axis, in bytes
  std::vector<std::size_t> axes_;  // x, y and z
  ZarrChunkCount count_;
};

}  // namespace

ZarrChunkCount read_zarr_samples(const ZarrArray& array, const ZarrSelection& selection,
                                 std::byte* samples) {
  return ZarrSampleReader(array, selection, samples).read();
}

}  // namespace isoatlas::detail::io
