// SPDX-License-Identifier: Apache-2.0
// Boxes of volumes that are mapped, unpacked into a temporary file, or read chunk by chunk.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <array>
#include <csignal>
#include <string>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/volume_bytes.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

const std::string kSamples = bytes_of(ramp<std::uint8_t>(7 * 6 * 5));

void write_gzipped(const fs::path& path, const std::string& bytes) {
  const gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
}

void expect_same(const Grid& a, const Grid& b) {
  EXPECT_EQ(a.size, b.size);
  EXPECT_EQ(a.spacing, b.spacing);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.unit, b.unit);
}

class Boxes : public testing::Test {
 protected:
  TempFolder folder_;

  Boxes() {
    const std::string header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 7 6 5\n";
    write_bytes(folder_ / "raw.nrrd", header + "encoding: raw\n\n" + kSamples);
    write_gzipped(folder_ / "samples.gz", kSamples);
    write_bytes(folder_ / "gzip.nrrd",
                header + "encoding: gzip\n\n" + read_bytes(folder_ / "samples.gz"));
    fs::create_directories(folder_ / "zarr");
    write_bytes(folder_ / "zarr/.zarray",
                R"({"zarr_format": 2, "shape": [5, 6, 7], "chunks": [5, 6, 4], "dtype": "|u1",
                    "order": "C", "fill_value": 0, "filters": null, "compressor": null})");
    std::array<std::string, 2> chunks;
    for (std::size_t i = 0; i < kSamples.size(); ++i) {
      const std::size_t x = i % 7;
      chunks[x / 4] += kSamples[i];
      if (x == 6) chunks[1] += '\0';  // beyond the array
    }
    write_bytes(folder_ / "zarr/0.0.0", chunks[0]);
    write_bytes(folder_ / "zarr/0.0.1", chunks[1]);
  }
};

TEST_F(Boxes, HaveTheSamplesOfTheVolume) {
  for (const char* name : {"raw.nrrd", "gzip.nrrd", "zarr"}) {
    SCOPED_TRACE(name);
    const VolumeFile whole = read_volume_file(folder_ / name);
    for (const bool has_region : {false, true}) {
      ReadOptions options;
      if (has_region) options.region = {{1, 2, 0}, {6, 5, 3}};
      const VolumeReader reader(folder_ / name, options);
      const Volume expected = read_volume(folder_ / name, options);
      expect_same(reader.grid(), expected.view.grid);
      EXPECT_EQ(reader.type(), SampleType::uint8);
      EXPECT_EQ(reader.digest(), sample_digest(expected));
      reader.drop();
      const Size3 size = reader.grid().size;
      for (const auto& [first, last] :
           {std::pair{Size3{0, 0, 0}, Size3{size[0] - 1, size[1] - 1, size[2] - 1}},
            {Size3{2, 1, 1}, Size3{5, 3, 2}}}) {
        const Volume box = reader.box(first, last);
        const VolumeView part = expected.view.box(first, last);
        EXPECT_EQ(sample_digest(box), sample_digest(part));
        expect_same(box.view.grid, part.grid);
      }
      EXPECT_THROW(reader.box({0, 0, 0}, {7, 1, 1}), Error);
      EXPECT_THROW(reader.box({1, 1, 1}, {2, 2, 1}), Error);
    }
  }
}

TEST_F(Boxes, OfAZarrFolderNeedOnlyTheirChunks) {
  fs::remove(folder_ / "zarr/0.0.1");
  fs::create_directory(folder_ / "zarr/0.0.1");  // cannot be read
  const VolumeReader reader(folder_ / "zarr");
  EXPECT_NO_THROW(reader.box({0, 0, 0}, {3, 5, 4}));
  EXPECT_THROW(reader.box({0, 0, 0}, {4, 5, 4}), Error);
}

TEST_F(Boxes, NeedATemporaryFileThatFits) {
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{100, old.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  std::string message;
  try {
    const VolumeReader reader(folder_ / "gzip.nrrd");
  } catch (const Error& error) {
    message = error.what();
    EXPECT_EQ(error.code(), ErrorCode::out_of_memory);
  }
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find("a temporary file of 210 bytes for samples cannot be made: "),
            std::string::npos)
      << message;
  EXPECT_NE(message.find("set TMPDIR to a folder with enough space"), std::string::npos);
}

}  // namespace
}  // namespace isoatlas::detail::test
