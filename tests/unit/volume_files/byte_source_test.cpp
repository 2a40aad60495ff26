// SPDX-License-Identifier: Apache-2.0
#include "files/byte_source.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "support/file_test_support.h"
#include "support/packed_bytes.h"

namespace isoatlas::detail::io {
namespace {

using test::bzipped;
using test::deflated;
using test::gzipped;
using test::TempFolder;
using test::write_bytes;

std::string content() {
  std::string bytes;
  for (int i = 0; i < 700'000; ++i) bytes += static_cast<char>(i * 7 + i / 1000);
  return bytes;
}

class Packed : public testing::TestWithParam<int> {
 protected:
  std::string pack(const std::string& bytes) const {
    switch (GetParam()) {
      case 0:
        return bytes;
      case 1:
        return gzipped(bytes);
      case 2:
        return deflated(bytes, 15);
      case 3:
        return bzipped(bytes);
      case 4:
        return gzipped(bytes.substr(0, 1000)) + gzipped(bytes.substr(1000));
      default:
        return bzipped(bytes.substr(0, 1000)) + bzipped(bytes.substr(1000));
    }
  }
  Packing packing() const {
    return GetParam() == 0                      ? Packing::none
           : GetParam() == 3 || GetParam() == 5 ? Packing::bzip2
                                                : Packing::deflate;
  }
  TempFolder folder_;
};

TEST_P(Packed, ReadsAllBytesOfTheFile) {
  const std::string bytes = content();
  write_bytes(folder_ / "a", "HEADER" + pack(bytes));
  ByteSource source(folder_ / "a", 6, packing());
  source.skip(10);
  std::string found(bytes.size() - 15, '\0');
  source.read_samples(found.data(), found.size());
  EXPECT_EQ(found, bytes.substr(10, found.size()));
  EXPECT_EQ(source.count_rest(100), 5U);
}

TEST_P(Packed, ReportsAFileThatIsCutOff) {
  const std::string packed = pack(content());
  write_bytes(folder_ / "a", packed.substr(0, packed.size() - 40));
  std::string found(content().size(), '\0');
  ByteSource source(folder_ / "a", 0, packing());
  EXPECT_THROW(
      {
        source.read_samples(found.data(), found.size());
        source.count_rest(1 << 20);
      },
      Error);
}

TEST_P(Packed, ReportsMissingSamples) {
  write_bytes(folder_ / "a", pack(content()));
  std::string found(content().size() + 1, '\0');
  EXPECT_THROW(ByteSource(folder_ / "a", 0, packing()).read_samples(found.data(), found.size()),
               Error);
}

TEST_P(Packed, ReportsADamagedCompressedStream) {
  if (packing() == Packing::none) GTEST_SKIP() << "without a checksum, damage is not detected";
  std::string packed = pack(content());
  for (std::size_t quarter = 1; quarter < 4; ++quarter) packed[packed.size() * quarter / 4] ^= 0x55;
  write_bytes(folder_ / "a", packed);
  std::string found(content().size(), '\0');
  ByteSource source(folder_ / "a", 0, packing());
  EXPECT_THROW(
      {
        source.read_samples(found.data(), found.size());
        source.count_rest(1 << 20);
      },
      Error);
}

INSTANTIATE_TEST_SUITE_P(All, Packed, testing::Range(0, 6));

// Found by fuzzing: after an empty member the reader never reached the next one.
TEST(ByteSource, EmptyMembersAreSkipped) {
  const TempFolder folder;
  for (const auto& [packing, empty, full] :
       {std::tuple{Packing::deflate, gzipped(""), gzipped("abc")},
        {Packing::bzip2, bzipped(""), bzipped("abc")}}) {
    for (const std::string& bytes :
         {empty + full, empty + empty + full, full + empty, empty + full + empty}) {
      write_bytes(folder / "a", bytes);
      std::string read(10, '\0');
      read.resize(ByteSource(folder / "a", 0, packing).read(read.data(), read.size()));
      EXPECT_EQ(read, "abc");
    }
    write_bytes(folder / "a", empty);
    char byte = 0;
    EXPECT_EQ(ByteSource(folder / "a", 0, packing).read(&byte, 1), 0U);
    write_bytes(folder / "a", empty + "garbage");
    EXPECT_EQ(ByteSource(folder / "a", 0, packing).read(&byte, 1), 0U);
  }
}

TEST(ByteSource, ZerosAfterAGzipMemberAreIgnored) {
  const TempFolder folder;
  write_bytes(folder / "a", gzipped("twelve bytes") + std::string(512, '\0'));
  std::string found(12, '\0');
  ByteSource source(folder / "a", 0, Packing::deflate);
  source.read_samples(found.data(), 12);
  EXPECT_EQ(found, "twelve bytes");
  EXPECT_EQ(source.count_rest(100), 0U);
}

TEST(ByteSource, BytesAfterAMemberAreAMemberOnlyWithItsMagic) {
  const TempFolder folder;
  for (const auto& [packing, member] : {std::pair{Packing::deflate, gzipped("abc")},
                                        {Packing::deflate, deflated("abc", 15)},
                                        {Packing::bzip2, bzipped("abc")}}) {
    for (const std::string rest : {"BBBB", "\x1F",
                                   "\x1F"
                                   "x",
                                   "BZ", "x"}) {
      write_bytes(folder / "a", member + rest);
      std::string read(10, '\0');
      read.resize(ByteSource(folder / "a", 0, packing).read(read.data(), read.size()));
      EXPECT_EQ(read, "abc") << rest;
    }
  }
}

TEST(ByteSource, PackingIsFoundByTheContent) {
  const TempFolder folder;
  write_bytes(folder / "a.gz", "plain");
  EXPECT_EQ(packing_of(folder / "a.gz"), Packing::none);
  write_bytes(folder / "b", gzipped("x"));
  EXPECT_EQ(packing_of(folder / "b"), Packing::deflate);
  write_bytes(folder / "c", bzipped("x"));
  EXPECT_EQ(packing_of(folder / "c"), Packing::bzip2);
}

}  // namespace
}  // namespace isoatlas::detail::io
