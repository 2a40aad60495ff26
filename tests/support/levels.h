// SPDX-License-Identifier: Apache-2.0
// A surface with a certified covering and its mesh, to test metrics and refinement with.
#pragma once

#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "error/measured_covering.h"
#include "isosurface/parse_surface.h"
#include "support/exact_volume.h"
#include "support/surfaces.h"
#include "voronoi/certified_dual.h"

namespace isoatlas::detail::test {

inline CoveringOptions disks(float max_radius) {
  CoveringOptions out;
  out.max_radius = max_radius;
  out.event_persistence = 1.5f;
  out.first_stage = 4;
  return out;
}

/// In 28^3 samples.
inline Function bumpy_ball() {
  return [](double x, double y, double z) {
    return 9 + 1.5 * std::sin(0.7 * x) * std::cos(0.6 * y) -
           std::hypot(x - 13.4, y - 13.6, z - 13.55);
  };
}

/// From unrounded samples, so that c-vertices are as near the true surface as the trilinear field
/// is.
inline SurfaceComplex exact_surface(Size size, const Function& f, Vec3 spacing = {1, 1, 1}) {
  ParseOptions options;
  options.rule = {0, Inside::above, NonFinite::refuse};
  return parse_surface(exact_volume(size, f, spacing), options);
}

/// A level as stage one creates it, with all cells measured by closest points.
class TestLevel {
 public:
  TestLevel(SurfaceComplex complex, float max_radius)
      : complex_(std::move(complex)),
        surface_data_(complex_),
        covering_(surface_data_.graph, disks(max_radius)) {
    make();
  }
  /// Includes distances from triangles. The surface is where the samples are 0.
  TestLevel(Volume volume, float max_radius)
      : volume_(std::make_unique<Volume>(std::move(volume))),
        complex_(parse_surface(*volume_, parse())),
        isosurface_(std::make_unique<Isosurface>(*volume_, parse().rule, complex_)),
        surface_data_(complex_, isosurface_.get()),
        covering_(surface_data_.graph, disks(max_radius)) {
    make();
  }
  TestLevel(const TestLevel&) = delete;

  const Isosurface& isosurface() const { return *isosurface_; }
  const SurfaceData& surface_data() const { return surface_data_; }
  const Covering& covering() const { return covering_; }
  const Partition& partition() const { return covering_.partition(); }
  const LevelMesh& mesh() const { return mesh_; }
  const std::vector<DualTriangle>& triangles() const { return triangles_; }
  std::span<const ClosestPoint> closest(CellId c) const {
    std::size_t first = 0;
    for (CellId before = 0; before < c; ++before) first += mesh_.c_vertices_of.row(before).size();
    return std::span<const ClosestPoint>(closest_).subspan(first,
                                                           mesh_.c_vertices_of.row(c).size());
  }
  CellView cell(CellId c) const {
    return {surface_data_.surfels,
            surface_data_.graph,
            covering_.distance(),
            partition().cell_of,
            mesh_.normal,
            mesh_.triangles,
            mesh_.triangle_normal,
            partition().site[c],
            mesh_.c_vertices_of.row(c),
            closest(c),
            from_mesh_[c].distance};
  }

 private:
  static ParseOptions parse() {
    ParseOptions options;
    options.rule = {0, Inside::above, NonFinite::refuse};
    return options;
  }

  void make() {
    covering_.cover({});
    CertifiedDual dual(complex_, covering_);
    dual.certify(certificate_, {});
    triangles_ = dual.triangles();
    mesh_ = make_level_mesh(surface_data_.surfels, partition(), triangles_, {partition().site, {}});
    std::vector<CellId> all(mesh_.cell_count());
    std::iota(all.begin(), all.end(), 0u);
    find_closest(surface_data_.measured_surface(), mesh_, all, closest_);
    from_mesh_.resize(all.size());
    if (isosurface_)
      measure_from_mesh(surface_data_.measured_surface(), mesh_, partition().cell_of, all, 0,
                        Evidence::samples, from_mesh_);
  }

  std::unique_ptr<const Volume> volume_;
  SurfaceComplex complex_;
  std::unique_ptr<const Isosurface> isosurface_;
  SurfaceData surface_data_;
  Covering covering_;
  CertificateReport certificate_;
  std::vector<DualTriangle> triangles_;
  LevelMesh mesh_;
  std::vector<ClosestPoint> closest_;
  std::vector<Farthest> from_mesh_;
};

}  // namespace isoatlas::detail::test
