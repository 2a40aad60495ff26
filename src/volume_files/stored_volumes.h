// SPDX-License-Identifier: Apache-2.0
// Volumes of samples that a file stores one after the other, and the way from there to memory.
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
  std::uint64_t offset = 0;        ///< of the first sample, in the unpacked file
  std::uint64_t volume_bytes = 0;  ///< of one volume as it is stored
  std::uint64_t count = 1;
  bool has_footer = false;  ///< the format has more after the samples
};

/// To call before memory is allocated or choices are listed. Warns where a file that is not packed
/// is longer than its header states.
/// @throws Error(bad_file)     the file cannot hold all volumes
/// @throws Error(unsupported)  more than a million volumes
void require_stored_volumes(const StoredVolumes& stored, VolumeSource& source);

/// Reads volume `index` into new memory for `file.volume`, whose grid's size and type are known:
/// `read` gets a stream at the first sample, of which it takes `volume_bytes` bytes, and the
/// memory. The rest of a packed file is read as well, as its checksum is at its end. Warns where
/// there is more than the header states.
/// @throws Error(bad_file)       the file is damaged or holds less than all volumes
/// @throws Error(out_of_memory)
void read_stored_volume(const StoredVolumes& stored, std::uint64_t index, VolumeFile& file,
                        const ReadOptions& options,
                        const std::function<void(ByteSource&, std::byte*)>& read);

/// The same for samples that are stored in the volume's type; `swap`: in the other byte order.
void read_plain_samples(const StoredVolumes& stored, std::uint64_t index, bool swap,
                        VolumeFile& file, const ReadOptions& options);

/// The same for samples that are stored as half-precision numbers; the volume's are float32.
void read_half_samples(const StoredVolumes& stored, std::uint64_t index, bool swap,
                       VolumeFile& file, const ReadOptions& options);

/// The first bytes of the unpacked file, at most `limit`.
std::string unpacked_start(const std::filesystem::path& file, std::size_t limit);

/// Reads `count` values of type Stored, in the other byte order if `swap`, and puts convert(value)
/// of each into `samples`.
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
