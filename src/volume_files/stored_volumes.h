// SPDX-License-Identifier: Apache-2.0
// Volumes that a file stores in sequence, and reading one of them into memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "files/byte_source.h"
#include "files/stored_data.h"
#include "isoatlas/volume_file.h"

namespace isoatlas::detail::io {

struct StoredVolumes {
  std::filesystem::path file = {};
  std::uint64_t offset = 0;        ///< of the first sample, in the decompressed file
  std::uint64_t volume_bytes = 0;  ///< stored size of one volume
  std::uint64_t count = 1;
  bool has_footer = false;  ///< the format may have more data after the samples
};

/// Checks the size of the file. Call it before memory is allocated or choices are listed. Warns if
/// a file that is not compressed is longer than its header states.
/// @throws Error(bad_file)     if the file cannot hold all volumes
/// @throws Error(unsupported)  if there are more than a million volumes
void require_stored_volumes(const StoredVolumes& stored, VolumeSource& source);

/// Allocates memory for `file.volume`, whose size and type are known, and reads volume `index` into
/// it. `read` is called with a stream at the first sample, from which it must read `volume_bytes`
/// bytes, and with the memory. In a compressed file the rest is read as well, because the checksum
/// is at its end. Warns if there is more data than the header states.
/// @throws Error(bad_file)       if the file is damaged or holds fewer volumes than stated
/// @throws Error(out_of_memory)
void read_stored_volume(const StoredVolumes& stored, std::uint64_t index, VolumeFile& file,
                        const ReadOptions& options,
                        const std::function<void(ByteSource&, std::byte*)>& read);

/// The same for samples stored in the volume's type; `swap` if their byte order is not the
/// machine's.
void read_plain_samples(const StoredVolumes& stored, std::uint64_t index, bool swap,
                        VolumeFile& file, const ReadOptions& options);

/// The same for samples stored as half-precision numbers; the volume has float32.
void read_half_samples(const StoredVolumes& stored, std::uint64_t index, bool swap,
                       VolumeFile& file, const ReadOptions& options);

/// The first bytes of the decompressed file, at most `limit`.
std::string unpacked_start(const std::filesystem::path& file, std::size_t limit);

/// Reads `count` values of type Stored, in the other byte order if `swap`, and stores
/// convert(value) of each in `samples`.
template <class Stored, class Sample, class Convert>
void read_converted(ByteSource& stream, const std::filesystem::path& file, std::uint64_t count,
                    bool swap, Sample* samples, Convert convert) {
  constexpr std::uint64_t kChunk = std::uint64_t{1} << 16;
  std::vector<Stored> values(static_cast<std::size_t>(std::min(count, kChunk)));
  for (std::uint64_t done = 0; done < count;) {
    const auto wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(values.size(), count - done));
    const std::size_t found = stream.read(values.data(), wanted * sizeof(Stored));
    if (found < wanted * sizeof(Stored))
      require_stored_bytes(file, count * sizeof(Stored), done * sizeof(Stored) + found);
    if (swap) swap_byte_order(values.data(), wanted, sizeof(Stored));
    std::transform(values.data(), values.data() + wanted, samples + done, convert);
    done += wanted;
  }
}

/// The value of an IEEE 754 half-precision number.
float float_of_half(std::uint16_t half);

}  // namespace isoatlas::detail::io
