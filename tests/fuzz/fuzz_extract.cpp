// SPDX-License-Identifier: Apache-2.0
#include "fuzz/fuzz_extract.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "isoatlas/error.h"
#include "support/soundness.h"

namespace isoatlas::detail::test {
namespace {

// Internal errors are ours, and nobody cancelled.
bool is_a_users_fault(ErrorCode code) {
  return code == ErrorCode::bad_argument || code == ErrorCode::unsupported ||
         code == ErrorCode::empty_surface;
}

}  // namespace

std::string what_is_wrong_with(const FuzzInput& input) {
  RunControl control;
  control.threads = 1;
  try {
    return what_is_wrong(extract(input.volume, input.options, control), input.options);
  } catch (const Error& error) {
    if (!is_a_users_fault(error.code())) return error.what();
    if (std::strchr(error.what(), '\n') != nullptr) return "a message of more than one line";
  }
  return "";
}

}  // namespace isoatlas::detail::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isoatlas;
  using namespace isoatlas::detail;
  using namespace isoatlas::detail::test;
  const FuzzInput input = decode(data, size);
  if (const std::string wrong = what_is_wrong_with(input); !wrong.empty()) {
    std::fprintf(stderr, "%s\n%s", wrong.c_str(), describe(input).c_str());
    std::abort();
  }
  return 0;
}
