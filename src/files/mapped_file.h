// SPDX-License-Identifier: Apache-2.0
// Bytes of a file as memory: the operating system reads the parts that are used, and can drop them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace isoatlas::detail::io {

/// Maps bytes of a file into memory. They must not be written, and the file must not become shorter
/// while they are used.
/// @throws Error(bad_file) if the file cannot be mapped
std::shared_ptr<std::byte[]> map_file(const std::filesystem::path& path, std::uint64_t offset,
                                      std::uint64_t bytes);

/// Memory in a new file in the folder for temporary files ($TMPDIR, otherwise /tmp), which is
/// deleted at once: the operating system can write parts of it to the disk.
/// @throws Error(out_of_memory) if the file cannot be made or its disk has too little space
std::shared_ptr<std::byte[]> memory_in_temporary_file(std::uint64_t bytes);

/// Drops the parts of such bytes that are in memory, so that they no longer count as memory of this
/// process. They are read again when they are used. Other memory is left as it is.
void drop_mapped_pages(const void* bytes, std::size_t count);

}  // namespace isoatlas::detail::io
