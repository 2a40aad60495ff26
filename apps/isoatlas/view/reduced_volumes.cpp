// SPDX-License-Identifier: Apache-2.0
#include "view/reduced_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

#include "field/sample_type.h"

namespace isoatlas::detail::tool {
namespace {

constexpr std::size_t kLeastSamples = 8;     // along an axis that is reduced
constexpr std::size_t kSmallVolume = 40000;  // samples of a volume that is not reduced further

/// Samples addressed by their strides.
template <class Sample>
struct Samples {
  const Sample* first;
  Strides strides;

  explicit Samples(const VolumeView& volume)
      : first(static_cast<const Sample*>(volume.samples)), strides(volume.strides) {
    const auto& size = volume.grid.size;
    if (volume.is_dense())
      strides = {1, static_cast<std::ptrdiff_t>(size[0]),
                 static_cast<std::ptrdiff_t>(size[0] * size[1])};
  }
  const Sample* row(std::size_t y, std::size_t z) const {
    return first + static_cast<std::ptrdiff_t>(y) * strides[1] +
           static_cast<std::ptrdiff_t>(z) * strides[2];
  }
};

/// The mean of the finite samples of a block that begins at `block`.
template <class Sample>
float block_mean(const Sample* block, const std::array<std::size_t, 3>& step,
                 const Strides& strides) {
  double sum = 0;
  int count = 0;
  for (std::size_t z = 0; z < step[2]; ++z) {
    for (std::size_t y = 0; y < step[1]; ++y) {
      for (std::size_t x = 0; x < step[0]; ++x) {
        const auto value = static_cast<double>(block[static_cast<std::ptrdiff_t>(x) * strides[0] +
                                                     static_cast<std::ptrdiff_t>(y) * strides[1] +
                                                     static_cast<std::ptrdiff_t>(z) * strides[2]]);
        if (!std::isfinite(value)) continue;
        sum += value;
        ++count;
      }
    }
  }
  return count > 0 ? static_cast<float>(sum / count) : std::numeric_limits<float>::quiet_NaN();
}

/// The samples along each axis that become one.
std::array<std::size_t, 3> steps_of(const Size3& size) {
  std::array<std::size_t, 3> out{};
  for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = size[axis] >= kLeastSamples ? 2 : 1;
  return out;
}

Grid halved_grid(const Grid& grid, const std::array<std::size_t, 3>& step) {
  const auto centre = [&](std::size_t axis) { return step[axis] == 2 ? 0.5 : 0.0; };
  const auto wider = [&](double spacing, std::size_t axis) {
    return spacing * static_cast<double>(step[axis]);
  };
  Grid out = grid;
  out.origin = grid.to_world({centre(0), centre(1), centre(2)});
  out.spacing = {wider(grid.spacing.x, 0), wider(grid.spacing.y, 1), wider(grid.spacing.z, 2)};
  for (std::size_t axis = 0; axis < 3; ++axis) out.size[axis] = grid.size[axis] / step[axis];
  return out;
}

Volume halved(const VolumeView& volume) {
  const auto step = steps_of(volume.grid.size);
  Volume out;
  out.view.grid = halved_grid(volume.grid, step);
  out.view.type = SampleType::float32;
  const auto means = std::make_shared<std::vector<float>>(out.view.grid.sample_count());
  const Size3 size = out.view.grid.size;
  visit_sample_type(volume.type, [&]<class Sample>(const Sample*) {
    const Samples<Sample> samples(volume);
    float* mean = means->data();
    for (std::size_t z = 0; z < size[2]; ++z)
      for (std::size_t y = 0; y < size[1]; ++y) {
        const Sample* row = samples.row(y * step[1], z * step[2]);
        for (std::size_t x = 0; x < size[0]; ++x)
          *mean++ = block_mean(row + static_cast<std::ptrdiff_t>(x * step[0]) * samples.strides[0],
                               step, samples.strides);
      }
  });
  out.view.samples = means->data();
  out.owner = means;
  return out;
}

template <class Sample>
std::size_t crossings(const VolumeView& volume, double isovalue, std::size_t every) {
  const Samples<Sample> samples(volume);
  const Size3 size = volume.grid.size;
  const auto is_inside = [&](const Sample& sample) {
    return static_cast<double>(sample) >= isovalue;
  };
  std::size_t count = 0;
  for (std::size_t z = 0; z + 1 < size[2]; z += every) {
    for (std::size_t y = 0; y + 1 < size[1]; ++y) {
      const Sample* sample = samples.row(y, z);
      for (std::size_t x = 0; x + 1 < size[0]; ++x, sample += samples.strides[0]) {
        const bool here = is_inside(*sample);
        for (std::size_t axis = 0; axis < 3; ++axis)
          count += here != is_inside(sample[samples.strides[axis]]) ? 1 : 0;
      }
    }
  }
  return count * every;
}

}  // namespace

ReducedVolumes::ReducedVolumes(const VolumeView& whole) : whole_(whole) {
  while (true) {
    const VolumeView& last = reduced_.empty() ? whole_ : reduced_.back().view;
    const auto step = steps_of(last.grid.size);
    if (last.grid.sample_count() <= kSmallVolume || step == std::array<std::size_t, 3>{1, 1, 1})
      return;
    reduced_.push_back(halved(last));
  }
}

std::optional<VolumeView> ReducedVolumes::at(std::size_t halvings, const Region& region) const {
  const VolumeView& volume = halvings == 0 ? whole_ : reduced_[halvings - 1].view;
  Size3 first, last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t whole = whole_.grid.size[axis], size = volume.grid.size[axis];
    std::size_t step = 1;
    while (whole / step > size) step *= 2;
    first[axis] = std::min(region.first[axis] / step, size - 1);
    last[axis] = std::min(std::min(region.last[axis], whole - 1) / step, size - 1);
    if (first[axis] >= last[axis]) return std::nullopt;
  }
  return volume.box(first, last);
}

std::size_t count_crossings(const VolumeView& volume, double isovalue, std::size_t every) {
  std::size_t count = 0;
  visit_sample_type(volume.type, [&]<class Sample>(const Sample*) {
    count = crossings<Sample>(volume, isovalue, every);
  });
  return count;
}

}  // namespace isoatlas::detail::tool
