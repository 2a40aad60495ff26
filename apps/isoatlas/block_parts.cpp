// SPDX-License-Identifier: Apache-2.0
#include "block_parts.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "files/file_error.h"
#include "isoatlas/block_file.h"
#include "isoatlas/error.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

/// A lock that the operating system releases when its process ends, however it ends.
class BlockLock {
 public:
  explicit BlockLock(const fs::path& path)
      : file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (file_ < 0)
      throw Error(ErrorCode::bad_file,
                  path.string() + ": cannot be made: " + io::system_text(errno));
    has_lock_ = flock(file_, LOCK_EX | LOCK_NB) == 0;
    if (has_lock_) path_ = path;
  }
  ~BlockLock() {
    std::error_code ignored;
    if (has_lock_) fs::remove(path_, ignored);
    close(file_);
  }
  BlockLock(const BlockLock&) = delete;
  BlockLock& operator=(const BlockLock&) = delete;

  bool has_lock() const { return has_lock_; }

 private:
  int file_;
  bool has_lock_ = false;
  fs::path path_;
};

}  // namespace

BlockParts::BlockParts(fs::path folder, const BlockPlan& plan)
    : folder_(std::move(folder)), plan_(plan) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_))
    throw Error(ErrorCode::bad_file,
                folder_.string() + ": cannot be made as a folder for the blocks" +
                    (error ? ": " + error.message() : std::string(", it is a file")));
}

fs::path BlockParts::path_of(std::size_t block) const {
  constexpr std::size_t kDigits = 6;
  std::string number = std::to_string(block);
  number.insert(0, kDigits - std::min(kDigits, number.size()), '0');
  return folder_ / ("block-" + number + ".mesh");
}

std::vector<std::size_t> BlockParts::make(const VolumeReader& volume, const ExtractOptions& options,
                                          const BlockRange& range,
                                          const RunControl& control) const {
  const std::size_t last = std::min(range.last, plan_.block_count());
  std::vector<std::size_t> elsewhere;
  for (std::size_t b = range.first; b < last; ++b) {
    control.check_cancelled();
    RunControl part = control;
    part.progress = [&](std::string_view, double fraction) {
      control.report("blocks", (static_cast<double>(b - range.first) + fraction) /
                                   static_cast<double>(last - range.first));
    };
    const fs::path path = path_of(b);
    const BlockLock lock(fs::path(path).replace_extension(".lock"));
    if (!lock.has_lock()) {
      elsewhere.push_back(b);
      continue;
    }
    const BlockBox box = plan_.block(b);
    const Volume samples = volume.box(box.first, box.last);
    const std::string inputs = block_inputs(samples, plan_, b, options);
    if (inputs_of_block_file(path) != inputs)
      write_block({mesh_block(samples, plan_, b, options, part), inputs}, path);
    volume.drop();
  }
  return elsewhere;
}

std::vector<std::size_t> BlockParts::missing() const {
  std::vector<std::size_t> out;
  for (std::size_t b = 0; b < plan_.block_count(); ++b) {
    if (!fs::exists(path_of(b))) out.push_back(b);
  }
  return out;
}

Extraction BlockParts::merge(const SamplesOfBlock& samples_of, const ExtractOptions& options,
                             const RunControl& control) const {
  std::vector<BlockMesh> meshes;
  for (std::size_t b = 0; b < plan_.block_count(); ++b) {
    control.report("merge", static_cast<double>(b) / static_cast<double>(plan_.block_count()));
    meshes.push_back(read_block(path_of(b)).mesh);
    if (meshes.back().block != b)
      throw Error(ErrorCode::bad_file, path_of(b).string() + ": is the file of block " +
                                           std::to_string(meshes.back().block) +
                                           "; delete it and make its block again");
  }
  RunControl quiet = control;
  quiet.progress = nullptr;
  return merge_blocks(plan_, std::move(meshes), options, quiet, samples_of);
}

}  // namespace isoatlas::detail::tool
