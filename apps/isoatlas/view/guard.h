// SPDX-License-Identifier: Apache-2.0
// Which requests the server of `isoatlas view` accepts.
#pragma once

#include <string>
#include <string_view>

namespace isoatlas::detail::tool {

/// What decides about a request.
struct RequestOrigin {
  std::string path;        ///< without the query
  std::string host;        ///< the header Host
  std::string origin;      ///< the header Origin; empty: absent
  std::string fetch_site;  ///< the header Sec-Fetch-Site; empty: absent
  std::string fetch_dest;  ///< the header Sec-Fetch-Dest; "document": the address was opened
};

/// Accepts requests of the page itself, and of whoever opens its address. The token keeps out other
/// users of the machine and pages of other sites; Host and Origin keep out sites whose name is made
/// to resolve to the loopback address.
class Guard {
 public:
  /// Makes a token of 128 random bits.
  explicit Guard(int port);

  /// "/TOKEN/": how the paths of all requests begin.
  const std::string& base() const { return base_; }
  std::string address() const;

  /// @return why the request is refused; empty if it is accepted
  std::string_view refusal(const RequestOrigin& from) const;

 private:
  int port_;
  std::string base_;
};

}  // namespace isoatlas::detail::tool
