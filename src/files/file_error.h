// SPDX-License-Identifier: Apache-2.0
// Errors about files: "<path>: <what is wrong>", on one line.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>

#include "isoatlas/error.h"

namespace isoatlas::detail::io {

/// Text from a file or another library, made fit for a message: control characters and runs of
/// blanks become one blank, and text beyond `limit` bytes is cut.
std::string one_line(std::string_view text, std::size_t limit = 240);

Error bad_file(const std::filesystem::path& path, std::string_view what);
Error unsupported(const std::filesystem::path& path, std::string_view what);
Error out_of_memory(const std::filesystem::path& path, std::uint64_t bytes);

/// The operating system's text for `error` (an errno value), e.g. "No space left on device".
std::string system_text(int error);

/// The size of a non-empty regular file that can be read. Throws Error(bad_file) for anything else.
std::uint64_t readable_file_size(const std::filesystem::path& path);

/// The contents of the whole file. Throws Error(bad_file), Error(out_of_memory).
std::string file_contents(const std::filesystem::path& path);

/// Runs `work` and turns any exception into an Error that names the file.
template <class Work>
auto translate_exceptions(const std::filesystem::path& path, Work work) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, one_line(path.string() + ": not enough memory"));
  } catch (const std::exception& error) {
    throw bad_file(path, one_line(error.what()));
  }
}

}  // namespace isoatlas::detail::io
