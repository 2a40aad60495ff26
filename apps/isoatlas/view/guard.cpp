// SPDX-License-Identifier: Apache-2.0
#include "view/guard.h"

#include <sys/random.h>

#include <array>

#include "isoatlas/error.h"

namespace isoatlas::detail::tool {
namespace {

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error(ErrorCode::internal, "the system has no random numbers");
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const unsigned char byte : bytes) {
    out += kDigits[byte / 16];
    out += kDigits[byte % 16];
  }
  return out;
}

/// Takes as long for any text of the same length, so that time reveals no part of a token.
bool begins_with(std::string_view text, std::string_view secret) {
  if (text.size() < secret.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < secret.size(); ++i)
    difference |= static_cast<unsigned char>(text[i] ^ secret[i]);
  return difference == 0;
}

}  // namespace

Guard::Guard(int port) : port_(port), base_("/" + random_token() + "/") {}

std::string Guard::address() const { return "http://127.0.0.1:" + std::to_string(port_) + base_; }

std::string_view Guard::refusal(const RequestOrigin& from) const {
  // Browsers leave the port of HTTP out.
  const std::string port = port_ == 80 ? "" : ":" + std::to_string(port_);
  if (from.host != "127.0.0.1" + port && from.host != "localhost" + port)
    return "the address has another host";
  if (!from.origin.empty() && from.origin != "http://" + from.host)
    return "the request comes from another site";
  const bool is_opened = from.fetch_dest == "document" && from.path == base_;
  if (!is_opened && !from.fetch_site.empty() && from.fetch_site != "same-origin" &&
      from.fetch_site != "none")
    return "the request comes from another site";
  if (!begins_with(from.path, base_)) return "the address has no token, or an old one";
  return "";
}

}  // namespace isoatlas::detail::tool
