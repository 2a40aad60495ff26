// SPDX-License-Identifier: Apache-2.0
// A file has one line with its format, the version of isoatlas, the digest of its inputs, the
// digest of its data and their number of bytes; the data follow.
#include "isoatlas/block_file.h"

#include <fstream>
#include <sstream>
#include <utility>

#include "api/resolve_options.h"
#include "core/ranges.h"
#include "field/dense_volume.h"
#include "files/atomic_file.h"
#include "files/file_error.h"
#include "files/sha256.h"
#include "isoatlas/version.h"
#include "stored/archive.h"

namespace isoatlas {
using namespace detail;

namespace fs = std::filesystem;

namespace {

constexpr const char* kFormat = "isoatlas-block-1";
constexpr const char* kBlockData = "the data of the block";

struct Header {
  std::string version, inputs, digest;
  std::size_t bytes = 0;
};

std::string digest_of(std::string_view bytes) {
  io::Sha256 sum;
  sum.add(bytes.data(), bytes.size());
  return sum.digits();
}

Header read_header(std::istream& in, const fs::path& path) {
  std::string line, format;
  Header header;
  if (!std::getline(in, line) || line.size() > 1000 ||
      !(std::istringstream(line) >> format >> header.version >> header.inputs >> header.digest >>
        header.bytes) ||
      format != kFormat)
    throw io::bad_file(path, "is not the file of a block; delete it and make its block again");
  return header;
}

std::ifstream opened(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw io::bad_file(path, "cannot be read; make its block again");
  return in;
}

void require_digestible(const ExtractOptions& options) {
  const auto has_function = [](const LevelGoal& goal) {
    return ranges::any_of(goal, [](const Constraint& c) { return c.custom != nullptr; });
  };
  if (has_function(options.coarse) || ranges::any_of(options.refine, has_function))
    throw Error(ErrorCode::unsupported,
                "a metric that is a function has no digest, so the files of blocks cannot have it");
}

}  // namespace

std::string block_inputs(const VolumeView& samples, const BlockPlan& plan, std::size_t block,
                         const ExtractOptions& any_options) {
  require_digestible(any_options);
  ExtractOptions options = in_world(any_options, plan.grid());
  Grid grid = plan.grid();
  Size3 block_size = plan.block_size();
  SampleType type = samples.type;
  const std::string settings = std::string(ISOATLAS_VERSION) + '\n' + bytes_of(grid) +
                               bytes_of(block_size) + bytes_of(block) + bytes_of(type) +
                               bytes_of(options);
  const Volume dense = dense_volume(samples);
  io::Sha256 sum;
  sum.add(settings.data(), settings.size());
  sum.add(dense.view.samples, dense.view.grid.sample_count() * bytes_per_sample(dense.view.type));
  return sum.digits();
}

void write_block(const BlockFile& file, const fs::path& path) {
  io::translate_exceptions(path, [&] {
    const std::string data = bytes_of(file.mesh);
    io::AtomicFile out(path);
    out.stream() << kFormat << ' ' << ISOATLAS_VERSION << ' ' << file.inputs << ' '
                 << digest_of(data) << ' ' << data.size() << '\n'
                 << data;
    out.commit();
    return 0;
  });
}

BlockFile read_block(const fs::path& path) {
  return io::translate_exceptions(path, [&] {
    std::ifstream in = opened(path);
    Header header = read_header(in, path);
    if (header.version != ISOATLAS_VERSION)
      throw io::bad_file(path, "was made by isoatlas " + header.version + ", expected " +
                                   ISOATLAS_VERSION + "; delete it and make its block again");
    const auto start = in.tellg();
    in.seekg(0, std::ios::end);
    const auto found = static_cast<std::size_t>(in.tellg() - start);
    in.seekg(start);
    std::string data;
    if (found == header.bytes) {
      data.resize(header.bytes);
      in.read(data.data(), static_cast<std::streamsize>(data.size()));
    }
    if (found != header.bytes || !in || digest_of(data) != header.digest)
      throw io::bad_file(path, "is damaged; delete it and make its block again");
    BlockFile out{from_bytes<BlockMesh>(data, kBlockData), std::move(header.inputs)};
    require_corners_in_range(out.mesh.hierarchy, kBlockData);
    return out;
  });
}

std::string inputs_of_block_file(const fs::path& path) {
  return io::translate_exceptions(path, [&]() -> std::string {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return {};
    std::ifstream in = opened(path);
    Header header = read_header(in, path);
    return header.version == ISOATLAS_VERSION ? std::move(header.inputs) : std::string();
  });
}

}  // namespace isoatlas
