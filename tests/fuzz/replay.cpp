// SPDX-License-Identifier: Apache-2.0
// Replays fuzzed inputs from files and folders, without a fuzzer:
//   replay_fuzz_extract [--describe] FILE|FOLDER...
// The exit status is 1 if an input has a problem. --describe only describes the inputs.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_extract.h"

namespace fs = std::filesystem;
using namespace isoatlas;
using namespace isoatlas::detail;
using namespace isoatlas::detail::test;

int main(int argc, char** argv) {
  std::vector<fs::path> files;
  bool only_describe = false;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--describe") {
      only_describe = true;
    } else if (fs::is_directory(argv[i])) {
      for (const fs::directory_entry& entry : fs::directory_iterator(argv[i]))
        files.push_back(entry.path());
    } else {
      files.emplace_back(argv[i]);
    }
  }
  std::sort(files.begin(), files.end());
  std::size_t wrong_files = 0;
  for (const fs::path& file : files) {
    std::fprintf(stderr, "%s\n", file.c_str());  // the last name before a crash is the cause
    std::ifstream in(file, std::ios::binary);
    if (!in) {
      std::fprintf(stderr, "cannot be read\n");
      return 1;
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(in)),
                                  std::istreambuf_iterator<char>());
    const FuzzInput input =
        decode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    if (only_describe) {
      std::printf("%s\n", describe(input).c_str());
    } else if (const std::string wrong = find_problem(input); !wrong.empty()) {
      std::fprintf(stderr, "WRONG: %s\n%s\n", wrong.c_str(), describe(input).c_str());
      ++wrong_files;
    }
  }
  std::fprintf(stderr, "%zu files, %zu wrong\n", files.size(), wrong_files);
  return files.empty() || wrong_files > 0 ? 1 : 0;
}
