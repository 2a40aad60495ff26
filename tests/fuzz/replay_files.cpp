// SPDX-License-Identifier: Apache-2.0
// Reads every file of a corpus without a fuzzer: replay_fuzz_files FOLDER, which has one folder for each format.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/file_formats.h"

namespace fs = std::filesystem;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::size_t files = 0, wrong_files = 0;
  std::vector<fs::path> formats(fs::directory_iterator(argv[1]), {});
  std::ranges::sort(formats);
  for (const fs::path& folder : formats) {
    const std::string format = folder.filename().string();
    if (!isoatlas::test::is_fuzzed_format(format)) {
      std::fprintf(stderr, "%s: no format that is fuzzed\n", folder.c_str());
      return 1;
    }
    std::vector<fs::path> paths(fs::directory_iterator(folder), {});
    std::ranges::sort(paths);
    for (const fs::path& path : paths) {
      std::fprintf(stderr, "%s\n", path.c_str());  // the last one before a crash is the one
      std::ifstream in(path, std::ios::binary);
      const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
      const std::string wrong =
          isoatlas::test::what_is_wrong_with_file(format, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
      if (!wrong.empty()) {
        std::fprintf(stderr, "WRONG: %s\n", wrong.c_str());
        ++wrong_files;
      }
      ++files;
    }
  }
  std::fprintf(stderr, "%zu files, %zu wrong\n", files, wrong_files);
  return files == 0 || wrong_files > 0 ? 1 : 0;
}
