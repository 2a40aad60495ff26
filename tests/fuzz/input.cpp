// SPDX-License-Identifier: Apache-2.0
#include "fuzz/input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace isoatlas::detail::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(),
                 kNaN = std::numeric_limits<double>::quiet_NaN();

// Reads bytes; returns zeros after the end, so that every prefix is also a valid input.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}
  std::uint8_t byte() { return next_ == end_ ? std::uint8_t{0} : *next_++; }
  std::size_t below(std::size_t n) { return byte() % n; }
  bool coin() { return byte() & 1; }
  template <class T>
  T raw() {
    T out{};
    const std::size_t n = std::min(sizeof out, static_cast<std::size_t>(end_ - next_));
    if (n > 0) std::memcpy(&out, next_, n);
    next_ += n;
    return out;
  }
  template <class T, std::size_t N>
  T one_of(const std::array<T, N>& choices) {
    return choices[below(N)];
  }

 private:
  const std::uint8_t *next_, *end_;
};

// The kinds of samples: few values, which gives many ties; all values; values at the limits; any
// bits.
template <class T>
T sample(Bytes& bytes, std::size_t kind) {
  using Limits = std::numeric_limits<T>;
  constexpr bool kFloating = !std::is_integral_v<T>;
  const auto small = [&](int n) {
    return static_cast<T>(static_cast<int>(bytes.below(static_cast<std::size_t>(n))) -
                          (Limits::is_signed ? n / 2 : 0));
  };
  switch (kind) {
    case 0:
      return small(2);
    case 1:
      return small(5);
    case 2:
      return small(256);
    case 3:
      if constexpr (kFloating)
        return bytes.one_of(std::array{Limits::lowest(), Limits::max(), Limits::min(),
                                       -Limits::min(), Limits::denorm_min(), -Limits::denorm_min(),
                                       T{0}, -T{0}, T{1}, std::nextafter(T{1}, T{2}),
                                       std::nextafter(Limits::max(), T{0})});
      else
        return bytes.one_of(std::array{
            Limits::lowest(), Limits::max(), static_cast<T>(Limits::max() - 1),
            static_cast<T>(Limits::max() / 2), static_cast<T>(Limits::lowest() + 1), T{0}, T{1}});
    case 4:
      if constexpr (kFloating) {
        const T values[]{Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()};
        const std::size_t k = bytes.byte();
        return k < 3 ? values[k] : static_cast<T>(static_cast<int>(k % 7) - 3);
      }
      return small(3);
    default:
      return bytes.raw<T>();
  }
}

template <class T>
void read_samples(Bytes& bytes, Volume& volume, double& isovalue) {
  auto values = std::make_shared<std::vector<T>>(volume.view.grid.sample_count());
  const std::size_t kind = bytes.below(7);
  const std::size_t way = bytes.below(5);
  const std::size_t which = bytes.byte();
  if (way == 4) isovalue = bytes.raw<double>();
  for (T& v : *values) v = sample<T>(bytes, kind == 6 ? bytes.below(6) : kind);
  const auto there = static_cast<double>((*values)[which % values->size()]);
  if (way == 1) isovalue = there;
  if (way == 2) isovalue = there + 0.5;
  if (way == 3) isovalue = std::nextafter(there, kInfinity);
  volume.view.samples = values->data();
  volume.owner = values;
}

Volume read_volume(Bytes& bytes, double& isovalue) {
  Volume volume;
  Grid& grid = volume.view.grid;
  volume.view.type = static_cast<SampleType>(bytes.below(10));
  for (std::size_t& n : grid.size) n = 2 + bytes.below(5);
  grid.spacing = bytes.one_of(std::array<Vec3, 12>{{{1, 1, 1},
                                                    {1, 1, 20},
                                                    {20, 1, 1},
                                                    {0.3, 1, 0.7},
                                                    {1, 1e6, 1},
                                                    {1e-6, 1, 1},
                                                    {1e-300, 1e-300, 2e-300},
                                                    {1e300, 2e300, 1e300},
                                                    {1e308, 1e308, 1e308},
                                                    {5e-324, 5e-324, 5e-324},
                                                    {0, 1, 1},
                                                    {1, 1, kNaN}}});
  if (bytes.below(4) == 1) {
    grid.direction = bytes.one_of(
        std::array<std::array<Vec3, 3>, 4>{{{{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}},
                                            {{{0.8, 0.6, 0}, {-0.6, 0.8, 0}, {0, 0, -1}}},
                                            {{{1, 0, 0}, {0.5, 1, 0}, {0, 0, 1}}},
                                            {{{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}}}});
    grid.origin = bytes.one_of(
        std::array<Vec3, 4>{{{0, 0, 0}, {-120, 31.5, 1e9}, {1e300, 0, -1e300}, {0, kInfinity, 0}}});
  }
  switch (volume.view.type) {
    case SampleType::int8:
      read_samples<std::int8_t>(bytes, volume, isovalue);
      break;
    case SampleType::uint8:
      read_samples<std::uint8_t>(bytes, volume, isovalue);
      break;
    case SampleType::int16:
      read_samples<std::int16_t>(bytes, volume, isovalue);
      break;
    case SampleType::uint16:
      read_samples<std::uint16_t>(bytes, volume, isovalue);
      break;
    case SampleType::int32:
      read_samples<std::int32_t>(bytes, volume, isovalue);
      break;
    case SampleType::uint32:
      read_samples<std::uint32_t>(bytes, volume, isovalue);
      break;
    case SampleType::int64:
      read_samples<std::int64_t>(bytes, volume, isovalue);
      break;
    case SampleType::uint64:
      read_samples<std::uint64_t>(bytes, volume, isovalue);
      break;
    case SampleType::float32:
      read_samples<float>(bytes, volume, isovalue);
      break;
    case SampleType::float64:
      read_samples<double>(bytes, volume, isovalue);
      break;
  }
  return volume;
}

double read_length(Bytes& bytes, double voxel) {
  return bytes.one_of(std::array{voxel, 0.5 * voxel, 0.1 * voxel, 3 * voxel, 1000 * voxel, 1e-300,
                                 1e300, 0.0, -1.0, kNaN, kInfinity});
}

LevelGoal read_goal(Bytes& bytes, double voxel) {
  LevelGoal goal;
  for (std::size_t count = bytes.below(4); count > 0; --count) {
    const auto quantity = static_cast<Quantity>(bytes.below(kQuantityCount));
    double bound = 0;
    switch (unit(quantity)) {
      case Unit::length:
        bound = read_length(bytes, voxel);
        break;
      case Unit::ratio:
        bound = bytes.one_of(std::array{1.01, 1.1, 2.0, 0.3, 0.5, 0.9, 1.0, 1e300, 1e-300, kNaN});
        break;
      case Unit::degrees:
        bound = bytes.one_of(std::array{20.0, 5.0, 90.0, 1e-9, 1e9, -1.0});
        break;
      case Unit::count:
        bound = bytes.one_of(std::array{4.0, 20.0, 100.0, 1.0, 0.5, 1e9, 1e300, 0.0});
        break;
      case Unit::number:
        break;
    }
    goal.push_back({quantity, bound});
  }
  return goal;
}

ExtractOptions read_options(Bytes& bytes, double voxel) {
  ExtractOptions out;
  out.refine.clear();
  out.surface.interpolation = bytes.coin() ? Interpolation::tricubic : Interpolation::trilinear;
  out.supersample = bytes.one_of(std::array<std::uint32_t, 8>{1, 1, 1, 1, 1, 2, 3, 0});
  out.covering.strategy = bytes.coin() ? CoveringStrategy::halving : CoveringStrategy::sizing_field;
  out.surface.inside = bytes.coin() ? Inside::below : Inside::above;
  out.surface.non_finite =
      bytes.one_of(std::array{NonFinite::refuse, NonFinite::below, NonFinite::above});
  out.surface.topology = bytes.coin() ? Topology::faces : Topology::trilinear;
  out.space = bytes.one_of(std::array{Space::lps, Space::ras, Space::voxel});
  out.placement = bytes.coin() ? Placement::balanced : Placement::surface;
  out.allow_self_intersections = bytes.coin();
  out.vertices_on_surface = bytes.below(4) != 1;
  if (bytes.coin()) out.covering.max_radius = read_length(bytes, voxel);
  if (bytes.coin()) out.covering.event_persistence = read_length(bytes, voxel);
  if (bytes.below(4) == 1)
    out.components.min_size = bytes.one_of(
        std::array{voxel * voxel * voxel, 5 * voxel * voxel * voxel, 1e300, 1e-300, -1.0, kNaN});
  out.components.keep_largest = bytes.below(8) < 6 ? 0 : 1 + bytes.below(2);
  if (bytes.below(4) == 1) out.measure_samples = 1 + bytes.below(50);
  if (bytes.below(4) == 1) out.coarse = read_goal(bytes, voxel);
  for (std::size_t levels = bytes.below(3); levels > 0; --levels)
    out.refine.push_back(read_goal(bytes, voxel));
  return out;
}

// ---- text

std::ostream& operator<<(std::ostream& out, const Vec3& v) {
  return out << '(' << v.x << ", " << v.y << ", " << v.z << ')';
}

std::ostream& operator<<(std::ostream& out, const LevelGoal& goal) {
  for (const Constraint& c : goal) out << ' ' << name(c.quantity) << ':' << c.bound;
  return out;
}

template <class T>
void write_samples(std::ostream& out, const VolumeView& volume) {
  const auto* values = static_cast<const T*>(volume.samples);
  const auto& size = volume.grid.size;
  for (std::size_t i = 0; i < volume.grid.sample_count(); ++i) {
    out << (i % size[0] > 0                         ? " "
            : i > 0 && i % (size[0] * size[1]) == 0 ? "\n\n  "
                                                    : "\n  ")
        << +values[i];
  }
}

void write_samples(std::ostream& out, const VolumeView& volume) {
  switch (volume.type) {
    case SampleType::int8:
      return write_samples<std::int8_t>(out, volume);
    case SampleType::uint8:
      return write_samples<std::uint8_t>(out, volume);
    case SampleType::int16:
      return write_samples<std::int16_t>(out, volume);
    case SampleType::uint16:
      return write_samples<std::uint16_t>(out, volume);
    case SampleType::int32:
      return write_samples<std::int32_t>(out, volume);
    case SampleType::uint32:
      return write_samples<std::uint32_t>(out, volume);
    case SampleType::int64:
      return write_samples<std::int64_t>(out, volume);
    case SampleType::uint64:
      return write_samples<std::uint64_t>(out, volume);
    case SampleType::float32:
      return write_samples<float>(out, volume);
    case SampleType::float64:
      return write_samples<double>(out, volume);
  }
}

}  // namespace

FuzzInput decode(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  // Options are decoded first, because samples use all remaining bytes.
  const double voxel = bytes.one_of(std::array{1.0, 0.3, 1e-6, 1e300});
  FuzzInput out;
  out.options = read_options(bytes, voxel);
  out.volume = read_volume(bytes, out.options.surface.isovalue);
  return out;
}

std::string describe(const FuzzInput& input) {
  const ExtractOptions& o = input.options;
  const Grid& grid = input.volume.view.grid;
  constexpr std::array kNonFinite{"refuse", "below", "above"}, kSpace{"lps", "ras", "voxel"};
  std::ostringstream out;
  out.precision(17);
  out << "isovalue " << o.surface.isovalue
      << (o.surface.inside == Inside::above ? ", inside above" : ", inside below")
      << ", non-finite " << kNonFinite[static_cast<std::size_t>(o.surface.non_finite)]
      << (o.surface.topology == Topology::faces ? ", faces" : ", trilinear")
      << (o.surface.interpolation == Interpolation::tricubic ? ", tricubic" : "") << ", space "
      << kSpace[static_cast<std::size_t>(o.space)]
      << (o.placement == Placement::balanced ? ", balanced" : ", on surface");
  if (o.allow_self_intersections) out << ", self-intersections allowed";
  if (!o.vertices_on_surface) out << ", c-vertices at averages";
  if (o.supersample != 1) out << ", supersample " << o.supersample;
  if (o.covering.strategy == CoveringStrategy::halving) out << ", halving";
  if (o.covering.max_radius) out << ", max radius " << o.covering.max_radius->value;
  if (o.covering.event_persistence)
    out << ", event persistence " << o.covering.event_persistence->value;
  if (o.components.min_size != 0) out << ", min component size " << o.components.min_size;
  if (o.components.keep_largest > 0) out << ", keep components " << o.components.keep_largest;
  if (o.measure_samples > 0) out << ", measure samples " << o.measure_samples;
  out << '\n';
  if (!o.coarse.empty()) out << "coarse:" << o.coarse << '\n';
  for (const LevelGoal& goal : o.refine) out << "refine:" << goal << '\n';
  out << name(input.volume.view.type) << ' ' << grid.size[0] << " x " << grid.size[1] << " x "
      << grid.size[2] << ", spacing " << grid.spacing;
  if (grid.direction != Grid{}.direction || grid.origin != Vec3{})
    out << ", origin " << grid.origin << ", direction " << grid.direction[0] << ' '
        << grid.direction[1] << ' ' << grid.direction[2];
  write_samples(out, input.volume);
  out << '\n';
  return out.str();
}

}  // namespace isoatlas::detail::test
