// SPDX-License-Identifier: Apache-2.0
// The volumes of the data folder have the size, spacing and sample type that the manifest states.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "isoatlas/io.h"
#include "support/file_test_support.h"

namespace isoatlas::detail::test {
namespace {

TEST(RealVolumes, MatchTheManifest) {
  const char* variable = std::getenv("ISOATLAS_TEST_DATA");
  const std::filesystem::path folder = variable != nullptr ? variable : ISOATLAS_DEFAULT_TEST_DATA;
  std::ifstream manifest(folder / "MANIFEST.tsv");
  if (!manifest) {
    GTEST_SKIP() << "no test volumes in " << folder << " (set ISOATLAS_TEST_DATA to their folder)";
  }
  std::string line;
  std::getline(manifest, line);  // column names
  int volumes = 0;
  while (std::getline(manifest, line)) {
    std::istringstream columns(line);
    std::string file, bytes, size, spacing, type;
    std::getline(columns, file, '\t');
    std::getline(columns, bytes, '\t');
    std::getline(columns, size, '\t');
    std::getline(columns, spacing, '\t');
    std::getline(columns, type, '\t');
    SCOPED_TRACE(file);
    const Volume volume = read_volume(folder / file);
    const Grid& grid = volume.view.grid;
    EXPECT_EQ(std::to_string(grid.size[0]) + "x" + std::to_string(grid.size[1]) + "x" +
                  std::to_string(grid.size[2]),
              size);
    EXPECT_TRUE(type == name(volume.view.type) || type.find(" * ") != std::string::npos)
        << type << " " << name(volume.view.type);
    std::istringstream expected(spacing);
    Vec3 s;
    expected >> s.x >> s.y >> s.z;
    EXPECT_NEAR(grid.spacing.x, s.x, 1e-4);
    EXPECT_NEAR(grid.spacing.y, s.y, 1e-4);
    EXPECT_NEAR(grid.spacing.z, s.z, 1e-4);
    for (const Vec3& d : grid.direction) {
      EXPECT_NEAR(std::hypot(d.x, d.y, d.z), 1, 1e-6);
    }
    ++volumes;
  }
  EXPECT_GE(volumes, 16);
}

}  // namespace
}  // namespace isoatlas::detail::test
