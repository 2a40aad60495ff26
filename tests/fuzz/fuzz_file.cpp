// SPDX-License-Identifier: Apache-2.0
// The entry point for libFuzzer for one format, ISOATLAS_FUZZED_FORMAT.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "fuzz/file_formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const std::string wrong =
          isoatlas::detail::test::find_problem_in_file(ISOATLAS_FUZZED_FORMAT, {data, size});
      !wrong.empty()) {
    std::fprintf(stderr, "WRONG: %s\n", wrong.c_str());
    std::abort();
  }
  return 0;
}
