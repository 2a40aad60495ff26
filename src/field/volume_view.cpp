// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "field/dense_volume.h"
#include "field/sample_type.h"
#include "isoatlas/error.h"
#include "isoatlas/volume.h"

namespace isoatlas {
namespace {

Strides dense_strides(const std::array<std::size_t, 3>& size) {
  const auto nx = static_cast<std::ptrdiff_t>(size[0]), ny = static_cast<std::ptrdiff_t>(size[1]);
  return {1, nx, nx * ny};
}

Strides strides_of(const VolumeView& view) {
  return view.strides == Strides{} ? dense_strides(view.grid.size) : view.strides;
}

const void* sample_at(const VolumeView& view, const std::array<std::size_t, 3>& index) {
  const Strides strides = strides_of(view);
  std::ptrdiff_t offset = 0;
  for (std::size_t a = 0; a < 3; ++a) offset += static_cast<std::ptrdiff_t>(index[a]) * strides[a];
  return static_cast<const char*>(view.samples) +
         offset * static_cast<std::ptrdiff_t>(bytes_per_sample(view.type));
}

}  // namespace

bool VolumeView::is_dense() const {
  return strides == Strides{} || strides == dense_strides(grid.size);
}

VolumeView VolumeView::box(const Size3& first, const Size3& last) const {
  VolumeView out = *this;
  for (std::size_t a = 0; a < 3; ++a) {
    if (first[a] > last[a] || last[a] >= grid.size[a]) {
      throw Error(ErrorCode::bad_argument,
                  "the box reaches from sample " + std::to_string(first[a]) + " to " +
                      std::to_string(last[a]) + " along " + "xyz"[a] +
                      ", expected a part of 0 to " + std::to_string(grid.size[a] - 1));
    }
    out.grid.size[a] = last[a] - first[a] + 1;
  }
  out.strides = strides_of(*this);
  out.samples = sample_at(*this, first);
  out.grid.origin = grid.to_world({static_cast<double>(first[0]), static_cast<double>(first[1]),
                                   static_cast<double>(first[2])});
  return out;
}

std::size_t VolumeView::offset_of_first(std::size_t count, const Size3& size,
                                        const Strides& strides) {
  const Strides steps = strides == Strides{} ? dense_strides(size) : strides;
  std::ptrdiff_t least = 0, most = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::ptrdiff_t reach = (static_cast<std::ptrdiff_t>(size[a]) - 1) * steps[a];
    least += std::min<std::ptrdiff_t>(reach, 0);
    most += std::max<std::ptrdiff_t>(reach, 0);
  }
  const bool is_empty = std::count(size.begin(), size.end(), std::size_t{0}) > 0;
  const std::size_t needed = is_empty ? 0 : static_cast<std::size_t>(most - least) + 1;
  const bool is_exact = strides == Strides{};
  if (is_exact ? count != needed : count < needed) {
    throw Error(ErrorCode::bad_argument,
                std::to_string(count) + " samples for " + std::to_string(size[0]) + " x " +
                    std::to_string(size[1]) + " x " + std::to_string(size[2]) + ", expected " +
                    (is_exact ? "" : "at least ") + std::to_string(needed));
  }
  return static_cast<std::size_t>(-least);
}

}  // namespace isoatlas

namespace isoatlas::detail {

Volume dense_volume(const VolumeView& view, std::shared_ptr<const void> owner) {
  if (view.is_dense() || view.samples == nullptr) return {view, std::move(owner)};
  Volume out{view, nullptr};
  visit_sample_type(view.type, [&]<class T>(const T*) {
    const std::shared_ptr<T[]> samples(new T[view.grid.sample_count()]);
    const auto [nx, ny, nz] = view.grid.size;
    T* to = samples.get();
    for (std::size_t z = 0; z < nz; ++z) {
      for (std::size_t y = 0; y < ny; ++y) {
        const T* from = static_cast<const T*>(sample_at(view, {0, y, z}));
        for (std::size_t x = 0; x < nx; ++x, from += view.strides[0]) *to++ = *from;
      }
    }
    out.view.samples = samples.get();
    out.owner = samples;
  });
  out.view.strides = {};
  return out;
}

}  // namespace isoatlas::detail
