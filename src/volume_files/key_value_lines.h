// SPDX-License-Identifier: Apache-2.0
// Lines of key=value, as ImageJ writes them into TIFF files.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace isoatlas::detail::io {

/// `text` as a number, the same in any locale; blanks around it are ignored. Nothing if it is not a
/// finite number.
std::optional<double> finite_number(std::string_view text);

/// `text` as a number of channels, slices or times. Nothing if it is not a number from 1 to a
/// million.
std::optional<std::size_t> count_of_pages(std::string_view text);

/// The lines "key=value" of a text.
class KeyValueLines {
 public:
  explicit KeyValueLines(std::string_view text);
  bool has(const std::string& key) const { return values_.contains(key); }
  std::string text(const std::string& key) const;  ///< empty if the key is missing
  std::optional<double> number(const std::string& key) const { return finite_number(text(key)); }
  std::optional<std::size_t> count(const std::string& key) const {
    return count_of_pages(text(key));
  }

 private:
  std::map<std::string, std::string> values_;
};

}  // namespace isoatlas::detail::io
