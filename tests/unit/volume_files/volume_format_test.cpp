// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "isoatlas/length_unit.h"
#include "isoatlas/volume_file.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

TEST(VolumeFormat, IsFoundByTheContentForAnyName) {
  const TempFolder folder;
  fs::copy_file(field_file("v_far.vti"), folder / "scan");
  EXPECT_NO_THROW(read_volume(folder / "scan"));
}

TEST(VolumeFormat, RefusesUnusedOptions) {
  const fs::path path = field_file("r_sp_las.nrrd");
  EXPECT_NO_THROW(read_volume(path, {.channel = "0"}));
  EXPECT_THROW(read_volume(path, {.channel = "1"}), Error);
  EXPECT_THROW(read_volume(path, {.time = 1}), Error);
  EXPECT_THROW(read_volume(path, {.layer = "1"}), Error);
  EXPECT_THROW(read_volume(path, {.array = "density"}), Error);
  EXPECT_THROW(read_volume(path, {.series = "1.2.3"}), Error);
}

TEST(VolumeFormat, TheGivenSpacingReplacesTheFiles) {
  const VolumeFile file = read_volume_file(field_file("r_sp_las.nrrd"), {.spacing = Vec3{1, 2, 3}});
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{1, 2, 3}));
  EXPECT_THROW(read_volume(field_file("r_sp_las.nrrd"), {.spacing = Vec3{1, 0, 3}}), Error);
}

TEST(VolumeFormat, NeverAllocatesMoreThanAllowed) {
  try {
    read_volume(field_file("r_sp_las.nrrd"), {.max_memory = 1000});
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::out_of_memory);
    EXPECT_NE(std::string(error.what()).find("more than the limit of 1000"), std::string::npos)
        << error.what();
  }
}

TEST(VolumeFormat, DigestIsThatOfTheBytes) {
  const std::string bytes = "abcdefgh";  // the digest below is from sha256sum
  const VolumeView view{
      .grid = {.size = {2, 2, 2}}, .type = SampleType::uint8, .samples = bytes.data()};
  EXPECT_EQ(sample_digest(view),
            "9c56cc51b374c3ba189210d5b6d4bf57790d351c96c47c02190ecf1e430635ab");
}

TEST(LengthUnit, HasTheNamesThatProgramsWrite) {
  for (const char* name :
       {"um", "µm", "\xCE\xBCm", "\xB5m", "\\u00B5m", "micron", "microns", "Micrometer", "UM"})
    EXPECT_EQ(length_unit_named(name), LengthUnit::micrometre) << name;
  EXPECT_EQ(length_unit_named("mm"), LengthUnit::millimetre);
  EXPECT_EQ(length_unit_named("inches"), LengthUnit::inch);
  EXPECT_EQ(length_unit_named("A"), LengthUnit::angstrom);
  for (const char* name : {"", "pixel", "a", "s", "meterz"})
    EXPECT_EQ(length_unit_named(name), LengthUnit::unknown) << name;
}

}  // namespace
}  // namespace isoatlas::detail::test
