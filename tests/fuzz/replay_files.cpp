// SPDX-License-Identifier: Apache-2.0
// Reads every file of a corpus without a fuzzer: replay_fuzz_files FOLDER. The folder has an
// archive for each format (nrrd.zip).
#include <zip.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz/file_formats.h"

namespace fs = std::filesystem;

namespace {

struct Counts {
  std::size_t files = 0, wrong = 0;
};

class Archive {
 public:
  explicit Archive(const fs::path& path)
      : zip_(zip_open(path.c_str(), ZIP_RDONLY, nullptr), zip_discard) {
    if (!zip_) throw std::runtime_error(path.string() + ": is not a readable archive");
  }

  std::uint64_t size() const {
    return static_cast<std::uint64_t>(zip_get_num_entries(zip_.get(), 0));
  }
  std::string name(std::uint64_t entry) const { return zip_get_name(zip_.get(), entry, 0); }

  std::vector<std::uint8_t> bytes(std::uint64_t entry) const {
    zip_stat_t about{};
    zip_stat_index(zip_.get(), entry, 0, &about);
    std::vector<std::uint8_t> bytes(about.size);
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
        zip_fopen_index(zip_.get(), entry, 0), zip_fclose);
    if (!file ||
        zip_fread(file.get(), bytes.data(), bytes.size()) != static_cast<zip_int64_t>(bytes.size()))
      throw std::runtime_error(name(entry) + ": cannot be unpacked");
    return bytes;
  }

 private:
  std::unique_ptr<zip_t, void (*)(zip_t*)> zip_;
};

Counts replay(const fs::path& path) {
  const std::string format = path.stem().string();
  if (path.extension() != ".zip" || !isoatlas::detail::test::is_fuzzed_format(format))
    throw std::runtime_error(path.string() + ": expected the archive of a format that is fuzzed");
  const Archive archive(path);
  Counts counts;
  for (std::uint64_t entry = 0; entry < archive.size(); ++entry) {
    std::fprintf(stderr, "%s %s\n", path.filename().c_str(),
                 archive.name(entry).c_str());  // the last name before a crash is the cause
    const std::string wrong =
        isoatlas::detail::test::find_problem_in_file(format, archive.bytes(entry));
    if (!wrong.empty()) std::fprintf(stderr, "WRONG: %s\n", wrong.c_str());
    ++counts.files;
    counts.wrong += wrong.empty() ? 0 : 1;
  }
  return counts;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::vector<fs::path> archives(fs::directory_iterator(argv[1]), {});
  std::ranges::sort(archives);
  Counts all;
  for (const fs::path& path : archives) {
    const Counts counts = replay(path);
    all.files += counts.files;
    all.wrong += counts.wrong;
  }
  std::fprintf(stderr, "%zu files, %zu wrong\n", all.files, all.wrong);
  return all.files == 0 || all.wrong > 0 ? 1 : 0;
}
