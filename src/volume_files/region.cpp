// SPDX-License-Identifier: Apache-2.0
#include "volume_files/region.h"

#include "core/vector_math.h"
#include "files/file_error.h"

namespace isoatlas::detail::io {

SelectedRegion selected_region(const std::filesystem::path& path, const Size3& size,
                               const ReadOptions& options, VolumeSource& source) {
  SelectedRegion out{{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
  if (!options.region) return out;
  const Region& wanted = *options.region;
  std::string text;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    out.first[a] = wanted.first[a];
    if (wanted.last[a] != Region::kEnd) out.last[a] = wanted.last[a];
    if (out.last[a] >= size[a] || out.first[a] >= out.last[a]) {
      throw Error(ErrorCode::bad_argument, one_line(path.string()) + ": the region has samples " +
                                               std::to_string(out.first[a]) + " to " +
                                               std::to_string(out.last[a]) + " along " + axis +
                                               ", expected two or more of 0 to " +
                                               std::to_string(size[a] - 1));
    }
    text += (a == 0 ? "" : ", ") + axis + " " + std::to_string(out.first[a]) + " to " +
            std::to_string(out.last[a]);
  }
  source.decisions.push_back({"region", text});
  return out;
}

Grid grid_of_region(const Grid& whole, const SelectedRegion& region, VolumeSource& source) {
  const Vec3 first{static_cast<double>(region.first[0]), static_cast<double>(region.first[1]),
                   static_cast<double>(region.first[2])};
  Grid out = whole;
  out.size = region.size();
  out.origin = whole.to_world(first);
  source.origin_in_samples = source.origin_in_samples + first;
  return out;
}

}  // namespace isoatlas::detail::io
