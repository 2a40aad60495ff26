// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace isoatlas::detail::io {

/// `text` as the content of an XML element or of a quoted attribute. Bytes that are not ASCII
/// become '?': they may not be UTF-8, which an XML file requires.
inline std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 128 ? c : '?';
    }
  }
  return result;
}

}  // namespace isoatlas::detail::io
