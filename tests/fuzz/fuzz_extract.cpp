// SPDX-License-Identifier: Apache-2.0
#include "fuzz/fuzz_extract.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "isoatlas/error.h"
#include "support/soundness.h"

namespace isoatlas::detail::test {
namespace {

// True for errors that the input may cause. Internal errors are bugs, and nothing cancels the run.
bool is_users_error(ErrorCode code) {
  return code == ErrorCode::bad_argument || code == ErrorCode::unsupported ||
         code == ErrorCode::empty_surface;
}

}  // namespace

std::string find_problem(const FuzzInput& input) {
  RunControl control;
  control.threads = 1;
  try {
    return what_is_wrong(extract(input.volume, input.options, control), input.options);
  } catch (const Error& error) {
    if (!is_users_error(error.code())) return error.what();
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
  if (const std::string wrong = find_problem(input); !wrong.empty()) {
    std::fprintf(stderr, "%s\n%s", wrong.c_str(), describe(input).c_str());
    std::abort();
  }
  return 0;
}
