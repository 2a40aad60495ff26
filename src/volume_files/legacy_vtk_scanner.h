// SPDX-License-Identifier: Apache-2.0
// Reads words, numbers and arrays of a legacy VTK file in order. The values of arrays are located
// and skipped, not read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "files/file_text.h"
#include "volume_files/vtk_array.h"

namespace isoatlas::detail::io {

struct LegacyVtkArray {
  VtkArray array = {};
  std::uint64_t tuples = 0;
  std::uint64_t begin = 0, end = 0;  ///< range of its values in the file
  bool is_string = false;
  bool is_colour_text = false;  ///< numbers from 0 to 1 that stand for 0 to 255
};

/// Opens the values of `array`, which locate_values() has completed.
std::unique_ptr<VtkValues> open_values(const std::filesystem::path& path, bool is_text,
                                       const LegacyVtkArray& array);

/// The name without its escapes: VTK writes a blank as %20.
std::string decoded_name(std::string_view name);

/// True for words that begin a section, in lower case.
bool is_legacy_vtk_keyword(std::string_view word);

class LegacyVtkScanner {
 public:
  explicit LegacyVtkScanner(const std::filesystem::path& path);

  void set_text(bool is_text) {
    is_text_ = is_text;
  }  ///< true if the values are text, false if they are binary
  bool is_text() const { return is_text_; }

  std::string keyword();  ///< the next word in lower case; empty at the end
  std::string name() { return decoded_name(text_.word()); }
  std::string line() { return text_.line(); }
  std::uint64_t position() const { return text_.position(); }
  std::uint64_t bytes_left() const { return file_bytes_ - text_.position(); }

  /// The next word as a number. @throws Error(bad_file) naming `what` if it is not a number
  std::uint64_t count(const std::string& what);
  std::int64_t integer(const std::string& what);
  Vec3 vector(const std::string& what);

  /// The rest of the line as a number; `otherwise` if it is empty.
  std::uint64_t count_in_line(const std::string& what, std::uint64_t otherwise);

  /// Skips the next line if it begins with `keyword`.
  void skip_line_of(std::string_view keyword);

  /// Completes `array`, whose type is called `type_name`, and moves the scanner behind its values.
  ///
  /// @param begins_in_next_line  for binary values: the scanner is still in the line of the type
  /// @param is_followed_by_array the next word, unless it is METADATA, names another array of a
  /// FIELD
  /// @throws Error(bad_file) for an unknown type, or if the file ends before the values do
  void locate_values(LegacyVtkArray& array, const std::string& type_name,
                     bool begins_in_next_line = true, bool is_followed_by_array = false);

 private:
  void skip_numbers(std::uint64_t values);
  void skip_strings(std::uint64_t values);
  void skip_binary_string();
  bool section_begins_at(std::uint64_t position, bool is_followed_by_array);

  std::filesystem::path path_;
  FileText text_;
  std::uint64_t file_bytes_;
  bool is_text_ = false;
};

}  // namespace isoatlas::detail::io
