// SPDX-License-Identifier: Apache-2.0
// Headerless samples: an offset, compressed files, and sizes that do not agree.
#include <gtest/gtest.h>

#include <string>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/one_file.h"

namespace isoatlas::detail::test {
namespace {

constexpr ErrorCode kBad = ErrorCode::bad_file;

ReadOptions layout(std::uint64_t offset = 0, SampleType type = SampleType::uint8,
                   bool big_endian = false) {
  return {.raw = RawLayout{.size = {2, 3, 4},
                           .type = type,
                           .spacing = {0.5, 1, 2},
                           .big_endian = big_endian,
                           .offset = offset}};
}

TEST(Raw, Offset) {
  const OneFile file("head" + counted(24));
  EXPECT_EQ(file.samples(layout(4)), counted(24));
  EXPECT_EQ(file.file(layout(4)).volume.view.grid.spacing, (Vec3{0.5, 1, 2}));
  ReadOptions in_micrometres = layout(4);
  in_micrometres.raw->unit = LengthUnit::micrometre;
  EXPECT_EQ(file.file(in_micrometres).volume.view.grid.unit, LengthUnit::micrometre);
  file.expect_refused(kBad, "has 28 bytes, but 2 x 3 x 4 samples of uint8 are 24 bytes", layout());
  file.expect_refused(kBad, "has 28 bytes, but after an offset of 5 2 x 3 x 4 samples", layout(5));
  file.expect_refused(kBad, "has 28 bytes, but after an offset of 18446744073709551615",
                      layout(~std::uint64_t{0}));
  std::string swapped = "odd";
  for (std::size_t i = 0; i < 48; i += 2) {
    swapped += {static_cast<char>(i + 1), static_cast<char>(i)};
  }
  EXPECT_EQ(OneFile(swapped).samples(layout(3, SampleType::uint16, true)), counted(48));
}

TEST(Raw, Packed) {
  for (const std::string& packed : {gzipped("head" + counted(24)), bzipped("head" + counted(24))}) {
    const OneFile file(packed, "a.raw.gz");
    EXPECT_EQ(file.samples(layout(4)), counted(24));
    file.expect_refused(kBad, "has 28 bytes when decompressed, but 2 x 3 x 4 samples", layout());
    file.expect_refused(
        kBad, "has 28 bytes when decompressed, but after an offset of 5 2 x 3 x 4 samples",
        layout(5));
    OneFile(packed.substr(0, packed.size() - 5)).expect_refused(kBad, "is cut off", layout(4));
  }
  OneFile(gzipped(counted(20))).expect_refused(kBad, "has 20 bytes when decompressed", layout());
  OneFile(gzipped(counted(20))).expect_refused(kBad, "is cut off", layout(21));
}

TEST(Raw, AFileOfTheExactSizeIsNotCompressed) {  // even if the first samples look like gzip
  EXPECT_EQ(OneFile("\x1F\x8B" + counted(22)).samples(layout()), "\x1F\x8B" + counted(22));
}

TEST(Raw, MoreThanAPackedFileCanHold) {
  ReadOptions options = layout();
  options.raw->size = {100000, 100000, 100000};
  OneFile(gzipped(counted(24))).expect_refused(kBad, "far more than a file of", options);
  OneFile(bzipped(counted(24)))
      .expect_refused(ErrorCode::out_of_memory, "more than the limit of", options);
}

}  // namespace
}  // namespace isoatlas::detail::test
