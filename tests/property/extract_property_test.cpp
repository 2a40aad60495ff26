// SPDX-License-Identifier: Apache-2.0
// Invariants of every volume, tested on 100 random ones.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>

#include "complex/coarsen.h"
#include "complex/components.h"
#include "isosurface/parse_surface.h"
#include "property/random_case.h"
#include "support/mesh_counts.h"
#include "support/soundness.h"
#include "support/surfaces.h"

namespace isoatlas::detail {
namespace {

using namespace test;

[[maybe_unused]] const bool kCases = run_cases(100);

SurfaceComplex parsed(const RandomCase& c, const Volume& volume,
                      Topology topology = Topology::trilinear) {
  ParseOptions options;
  options.rule = {c.isovalue(), c.inside(), NonFinite::refuse};
  options.topology = topology;
  return parse_surface(volume, options);
}

RC_GTEST_PROP(AnyVolume, SurfaceIsValidAndHasTheReferenceTopology, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  RC_TAG(name(static_cast<Family>(c.family)));
  const SurfaceComplex surface =
      parsed(c, to_volume(samples, SampleType::int32, c.spacing), Topology::faces);
  RC_ASSERT(validate(surface) == "");
  const TopologySummary want = reference_topology(samples, c.isovalue(), c.inside());
  const MeshCounts counts = count_manifold(surface);
  RC_ASSERT(counts.topology == want);
  const Components components = find_components(surface);
  RC_ASSERT(components.of_c_vertex == counts.component_of_vertex);
  RC_ASSERT(components.topology == counts.components);
  RC_ASSERT(kinds_of(triangles_of(surface)) == want.kinds);
}

RC_GTEST_PROP(AnyVolume, CoarserComplexesPreserveTheTopology, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  const SurfaceComplex surface = parsed(c, to_volume(samples, SampleType::int32, c.spacing));
  const auto want = kinds_of(triangles_of(surface));
  for (const double block : {2.0, 4.0, 8.0}) {
    const Coarsened coarser = coarsen(surface, block);
    RC_ASSERT(coarser.certificate.passed);
    RC_ASSERT(validate(coarser.complex) == "");
    RC_ASSERT(kinds_of(triangles_of(coarser.complex)) == want);
  }
}

RC_GTEST_PROP(AnyVolume, MeshIsAManifoldWithTheReferenceTopology, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  RC_TAG(name(static_cast<Family>(c.family)));
  const Volume volume = c.volume(SampleType::int16);
  ExtractOptions options = coarse_options();
  options.surface.isovalue = c.isovalue();
  options.surface.inside = c.inside();
  options.surface.topology = Topology::faces;  // for which there is an independent reference
  if (c.seed % 3 == 1) options.covering.max_radius = 0.5 + static_cast<double>(c.seed % 7);
  if (c.seed % 3 == 2) {  // large disks, so coarser complexes even for small volumes
    options.covering.max_radius = 1000;
    options.covering.event_persistence = static_cast<double>(c.seed % 5);
  }
  const Extraction first = extract(volume, options);
  const TopologySummary want = reference_topology(samples, c.isovalue(), c.inside());
  const MeshCounts counts = count_mesh(first.mesh());
  RC_ASSERT(counts.fault == "");
  RC_ASSERT(counts.topology == want);
  RC_ASSERT(first.finest().topology == want);
  RC_ASSERT(first.report.reference == want);
  RC_ASSERT(first.finest().certificate.passed);

  // Inside the volume, and no two vertices coincide.
  std::vector<std::array<double, 3>> distinct_positions;
  const double rounding = 8 * c.rounding() / volume.view.grid.smallest_spacing();
  for (const Vec3& p : first.mesh().positions) {
    const Vec3 i = volume.view.grid.to_index(p);
    RC_ASSERT(i.x >= -rounding && i.y >= -rounding && i.z >= -rounding);
    RC_ASSERT(i.x <= (c.nx - 1) + rounding && i.y <= (c.ny - 1) + rounding &&
              i.z <= (c.nz - 1) + rounding);
    distinct_positions.push_back({p.x, p.y, p.z});
  }
  std::sort(distinct_positions.begin(), distinct_positions.end());
  RC_ASSERT(std::adjacent_find(distinct_positions.begin(), distinct_positions.end()) ==
            distinct_positions.end());

  // A second run with another number of threads yields the same bytes.
  RunControl control;
  control.threads = 1 + static_cast<int>(c.seed % 4);
  const Extraction second = extract(volume, options, control);
  RC_ASSERT(first.mesh().triangles == second.mesh().triangles);
  RC_ASSERT(first.mesh().positions.size() == second.mesh().positions.size());
  RC_ASSERT(what_is_wrong(first, options) == "");
  RC_ASSERT(std::memcmp(first.mesh().positions.data(), second.mesh().positions.data(),
                        sizeof(Vec3) * first.mesh().positions.size()) == 0);
}

RC_GTEST_PROP(AnyVolume, ThePapersCoveringPreservesTheTopology, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  ExtractOptions options = coarse_options();
  options.surface.isovalue = c.isovalue();
  options.surface.inside = c.inside();
  options.surface.topology = Topology::faces;  // for which there is an independent reference
  options.covering.strategy = CoveringStrategy::halving;
  if (c.seed % 3 != 0)
    options.covering.max_radius = c.seed % 3 == 1 ? 1000 : 0.5 + static_cast<double>(c.seed % 7);
  if (c.seed % 4 == 0) options.covering.event_persistence = static_cast<double>(c.seed % 5);
  if (c.seed % 16 == 0) options.refine = {{{Quantity::max_distance, 0.5}}};
  const Extraction extraction = extract(c.volume(SampleType::int16), options);
  const TopologySummary want = reference_topology(samples, c.isovalue(), c.inside());
  for (std::size_t l = 0; l < extraction.report.levels.size(); ++l) {
    const LevelReport& level = extraction.report.levels[l];
    RC_ASSERT(count_manifold(extraction.hierarchy.mesh(l)).topology == want);
    RC_ASSERT(level.topology == want);
    RC_ASSERT(level.certificate.passed);
  }
}

RC_GTEST_PROP(AnyVolume, TrilinearTopologyIsPreserved, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  const Volume volume = c.volume(SampleType::int32);
  const SurfaceComplex surface = parsed(c, volume);
  RC_CLASSIFY(surface.tunnels > 0);
  RC_ASSERT(validate(surface) == "");
  const TopologySummary want = count_manifold(surface).topology,
                        faces = reference_topology(samples, c.isovalue(), c.inside());
  RC_ASSERT(kinds_of(triangles_of(surface)) == want.kinds);
  RC_ASSERT(want.boundary_loops == faces.boundary_loops);
  RC_ASSERT(want.euler_characteristic ==
            faces.euler_characteristic - 2 * static_cast<std::int64_t>(surface.tunnels));

  ExtractOptions options = coarse_options();
  options.surface.isovalue = c.isovalue();
  options.surface.inside = c.inside();
  if (c.seed % 3 != 0)
    options.covering.max_radius = c.seed % 3 == 1 ? 1000 : 0.5 + static_cast<double>(c.seed % 7);
  const Extraction extraction = extract(volume, options);
  RC_ASSERT(what_is_wrong(extraction, options) == "");
  RC_ASSERT(extraction.report.tunnels == surface.tunnels);
  RC_ASSERT(extraction.report.reference == want);
  RC_ASSERT(extraction.finest().certificate.passed);
  RC_ASSERT(extraction.finest().topology == want);
  RC_ASSERT(kinds_of(extraction.mesh()) == want.kinds);
}

RC_GTEST_PROP(AnyVolume, AxesMayBeSwappedAndMirrored, (const RandomCase& c)) {
  const Samples samples = c.samples();
  RC_PRE(has_surface(samples, c.isovalue(), c.inside()));
  ExtractOptions options = coarse_options();
  options.surface.isovalue = c.isovalue();
  options.surface.inside = c.inside();
  const auto kinds = [&](const Samples& s) {
    return kinds_of(extract(to_volume(s), options).mesh());
  };
  const auto want = kinds(samples);
  RC_ASSERT(kinds(mirrored(samples, static_cast<int>(c.seed % 3))) == want);
  RC_ASSERT(kinds(permuted(samples, c.seed % 2 ? std::array{1, 2, 0} : std::array{1, 0, 2})) ==
            want);
  options.surface.isovalue = -options.surface.isovalue;
  options.surface.inside = c.below ? Inside::above : Inside::below;
  RC_ASSERT(kinds(negated(samples)) == want);
}

}  // namespace
}  // namespace isoatlas::detail
