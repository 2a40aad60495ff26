// SPDX-License-Identifier: Apache-2.0
// Adaptive supersampling of surface complexes of all kinds: still the same surface, and in pieces that stay in their grid cells.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "isoatlas/self_intersections.h"
#include "property/random_case.h"
#include "subdivide/crowded_cells.h"
#include "support/surfaces.h"
#include "surface/components.h"
#include "surface/parse_surface.h"

namespace isoatlas {
namespace {

using namespace test;

struct Parsed {
  Volume volume;
  InsideRule rule;
  SurfaceComplex surface;
};

Parsed parsed(const RandomCase& c) {
  Parsed out;
  out.volume = to_volume(c.samples(), SampleType::int32, c.spacing);
  out.rule = {c.isovalue(), c.inside(), NonFinite::refuse};
  ParseOptions options;
  options.rule = out.rule;
  options.topology = c.seed % 2 ? Topology::trilinear : Topology::faces;
  out.surface = parse_surface(out.volume, options);
  return out;
}

RC_GTEST_PROP(AnySurface, StaysItselfWhereverItIsDivided, (const RandomCase& c)) {
  const Parsed p = parsed(c);
  RC_PRE(!p.surface.positions.empty());
  const TrilinearField field(p.volume, p.rule);
  const TopologySummary want = summarize(find_components(p.surface).topology);
  Random random(c.seed + 11);
  SurfaceComplex complex = p.surface;
  for (int round = 0; round < 3; ++round) {
    std::vector<CVertexId> wanted;
    const auto share = random.between(1, 4);
    for (CVertexId v = 0; v < complex.c_vertex_count(); ++v) {
      if (random.between(0, 3) < share) wanted.push_back(v);
    }
    const std::vector<std::uint8_t> stayed = stays_in_cells(complex);
    const Subdivision divided = subdivide(complex, wanted, field);
    RC_ASSERT(validate(divided.complex) == "");
    const std::uint32_t before = complex.c_vertex_count(), after = divided.complex.c_vertex_count();
    RC_ASSERT(divided.origin.size() == after - before);
    for (CVertexId v = 0; v < before; ++v) RC_ASSERT(divided.complex.positions[v] == complex.positions[v]);
    const Components components = find_components(divided.complex);
    RC_ASSERT(summarize(components.topology) == want);
    for (CVertexId v = before; v < after; ++v) RC_ASSERT(components.of_c_vertex[v] == components.of_c_vertex[divided.origin[v - before]]);
    const std::vector<std::uint8_t> stays = stays_in_cells(divided.complex);
    for (const CVertexId v : wanted) RC_ASSERT(stays[v]);
    for (CVertexId v = 0; v < before; ++v) RC_ASSERT(!stayed[v] || stays[v]);
    complex = divided.complex;
  }
}

RC_GTEST_PROP(AnySurface, InPiecesThatStayInTheirCellsDoesNotMeetItself, (const RandomCase& c)) {
  Parsed p = parsed(c);
  RC_PRE(!p.surface.positions.empty());
  const TrilinearField field(p.volume, p.rule);
  RC_ASSERT(CrowdedCells(p.surface, field).separate(p.surface) == 0u);
  const std::vector<std::uint8_t> stays = stays_in_cells(p.surface);
  std::vector<CVertexId> wanted;
  for (CVertexId v = 0; v < stays.size(); ++v) {
    if (!stays[v]) wanted.push_back(v);
  }
  const SurfaceComplex complex = subdivide(p.surface, wanted, field).complex;
  RC_ASSERT(self_intersections(complex.positions, triangles_of(complex).triangles).empty());
}

}  // namespace
}  // namespace isoatlas
