// SPDX-License-Identifier: Apache-2.0
// Levels whose triangles are asked not to meet where they should not.
#include <gtest/gtest.h>

#include "isoatlas/extract.h"
#include "isoatlas/self_intersections.h"
#include "support/surfaces.h"

namespace isoatlas {
namespace {

using namespace test;

std::size_t meeting_pairs(const Extraction& e, std::size_t level) {
  const TriangleMesh mesh = e.hierarchy.mesh(level);
  return self_intersections(mesh.positions, mesh.triangles).size();
}

ExtractOptions asking(bool allowed, Placement placement) {
  ExtractOptions options;
  options.allow_self_intersections = allowed;
  options.placement = placement;
  options.max_radius = 40;
  options.refine = {{{Quantity::max_distance, 1.5}}, {{Quantity::max_distance, 0.4}}};
  return options;
}

TEST(Embedded, NothingIsLeftInRefinedLevelsOfSmoothSurfaces) {
  std::size_t before = 0;
  for (const double level : {-0.9, 1.0}) {
    const Volume volume = to_volume(sampled({30, 28, 29}, gyroid(11.3, level)));
    for (const Placement placement : {Placement::surface, Placement::balanced}) {
      const Extraction allowed = extract(volume, asking(true, placement)), asked = extract(volume, asking(false, placement));
      for (std::size_t l = 0; l < 3; ++l) {
        before += meeting_pairs(allowed, l);
        EXPECT_FALSE(allowed.report.levels[l].self_intersections.has_value()) << "nobody looked";
        // Level 0 is on the coarser complex, where cells cannot be as small as it takes.
        const std::size_t left = meeting_pairs(asked, l);
        EXPECT_EQ(asked.report.levels[l].self_intersections, left);
        if (l > 0) {
          EXPECT_EQ(left, 0u) << "level " << l;
        }
        EXPECT_EQ(asked.report.levels[l].topology, asked.report.reference);
        EXPECT_TRUE(asked.report.levels[l].certificate.passed);
      }
    }
  }
  EXPECT_GT(before, 0u) << "else this shows nothing";
}

TEST(Embedded, InNoiseWhatIsLeftIsCounted) {
  std::size_t before = 0, after = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Samples samples = random_samples(Family::white_noise, {9, 10, 8}, seed);
    const Volume volume = to_volume(samples);
    const Extraction allowed = extract(volume, asking(true, Placement::surface)),
                     asked = extract(volume, asking(false, Placement::surface));
    for (std::size_t l = 0; l < 3; ++l) {
      const std::size_t pairs = meeting_pairs(asked, l);
      EXPECT_EQ(asked.report.levels[l].self_intersections, pairs);
      EXPECT_EQ(asked.report.levels[l].topology, asked.report.reference);
      before += meeting_pairs(allowed, l);
      after += pairs;
    }
  }
  EXPECT_LT(after, before);
}

// Turning a component outward lowers radii, so that cells may have to be added though no triangles meet. Found by fuzzing.
TEST(Embedded, CellsAddedAfterAComponentWasTurnedAreMeshed) {
  Samples s = constant({3, 2, 6}, -128);
  s.values[1] = 1;
  s.values[2] = 0;
  s.values[3] = 63;
  ExtractOptions options;
  options.isovalue = -127.5;
  options.allow_self_intersections = false;
  const Extraction e = extract(to_volume(s, SampleType::int8, {1e-6, 1, 1}), options);
  EXPECT_EQ(e.finest().certificate.cells_checked, e.mesh().positions.size());
  EXPECT_EQ(kinds_of(e.mesh()), e.report.reference.kinds);
}

}  // namespace
}  // namespace isoatlas
