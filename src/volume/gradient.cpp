// SPDX-License-Identifier: Apache-2.0
#include "volume/gradient.h"

#include <algorithm>

#include "volume/field.h"

namespace isoatlas {

std::vector<Vec3> outward_directions(const VolumeView& volume, const InsideRule& rule, std::span<const Vec3> points) {
  const auto [nx, ny, nz] = volume.grid.size;
  const Vec3 spacing = volume.grid.spacing;
  std::vector<Vec3> out(points.size());
  visit_sample_type(volume.type, [&, nx = nx, ny = ny, nz = nz]<class T>(const T*) {
    const Field<T> field(volume, rule);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i];
      const auto cell = [](double x, std::size_t n) { return std::min(static_cast<std::size_t>(std::max(x, 0.0)), n - 2); };
      const std::size_t cx = cell(p.x, nx), cy = cell(p.y, ny), cz = cell(p.z, nz);
      std::array<double, 8> f;
      for (std::size_t k = 0; k < 8; ++k) f[k] = field[cx + (k & 1) + nx * (cy + (k >> 1 & 1) + ny * (cz + (k >> 2)))];
      const Vec3 g =
          TrilinearCell(tamed(f)).gradient({p.x - static_cast<double>(cx), p.y - static_cast<double>(cy), p.z - static_cast<double>(cz)});
      out[i] = {-g.x / spacing.x, -g.y / spacing.y, -g.z / spacing.z};
    }
  });
  return out;
}

}  // namespace isoatlas
