// SPDX-License-Identifier: Apache-2.0
// One way to say what is wrong with a file: "<path>: <what>", on one line.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>

#include "isoatlas/error.h"

namespace isoatlas::detail::io {

/// Text from a file or from another library, made fit for a message: control characters and runs of
/// blanks become one blank, the end is cut at `limit` bytes.
std::string one_line(std::string_view text, std::size_t limit = 240);

Error bad_file(const std::filesystem::path& path, std::string_view what);
Error unsupported(const std::filesystem::path& path, std::string_view what);
Error out_of_memory(const std::filesystem::path& path, std::uint64_t bytes);

/// What the operating system says about `error` (an errno value), e.g. "No space left on device".
std::string system_text(int error);

/// Size of an existing, readable, non-empty regular file. Throws Error(bad_file) for anything else.
std::uint64_t readable_file_size(const std::filesystem::path& path);

/// The whole file. Throws Error(bad_file), Error(out_of_memory).
std::string file_contents(const std::filesystem::path& path);

/// Runs `work`; whatever a reader or a writer lets out, the caller gets an Error that names the
/// file.
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
