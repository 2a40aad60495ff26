// SPDX-License-Identifier: Apache-2.0
// Generated volumes. All samples are whole numbers, so that every sample type can hold them and a
// reference for their topology (reference_topology.h) can be exact.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/volume.h"

namespace isoatlas::detail::test {

/// Whether tests that take many seconds are wanted: the test api.thorough, of `scripts/test.sh
/// --all`, sets ISOATLAS_THOROUGH.
inline bool is_thorough() { return std::getenv("ISOATLAS_THOROUGH") != nullptr; }
inline constexpr const char* kThoroughOnly = "takes many seconds: set ISOATLAS_THOROUGH";

/// Options for the coarse mesh alone.
inline ExtractOptions coarse_options(double isovalue = 0) {
  ExtractOptions options;
  options.surface.isovalue = isovalue;
  options.refine.clear();
  return options;
}

/// splitmix64 (Steele, Lea, Flood 2014): the same numbers on every machine, unlike the
/// distributions of <random>.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  std::int64_t between(std::int64_t low, std::int64_t high) {  // both included
    return low + static_cast<std::int64_t>(bits() % static_cast<std::uint64_t>(high - low + 1));
  }
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  // [0, 1)

 private:
  std::uint64_t state_;
};

using Size = std::array<std::size_t, 3>;
using Function = std::function<double(double x, double y, double z)>;

struct Samples {
  Size size{};
  std::vector<std::int64_t> values;  // x fastest

  std::int64_t& at(std::size_t x, std::size_t y, std::size_t z) {
    return values[x + size[0] * (y + size[1] * z)];
  }
  std::int64_t at(std::size_t x, std::size_t y, std::size_t z) const {
    return values[x + size[0] * (y + size[1] * z)];
  }
};

inline constexpr std::array kAllTypes{SampleType::int8,   SampleType::uint8,  SampleType::int16,
                                      SampleType::uint16, SampleType::int32,  SampleType::uint32,
                                      SampleType::int64,  SampleType::uint64, SampleType::float32,
                                      SampleType::float64};

Samples constant(Size size, std::int64_t value);
/// The function at the sample positions, times `scale`, rounded.
Samples sampled(Size size, const Function& f, double scale = 1000);

Samples negated(Samples s);
Samples mirrored(const Samples& s, int axis);
/// Axis a of the result is axis `from[a]` of the input.
Samples permuted(const Samples& s, std::array<int, 3> from);
Samples plus(Samples s, std::int64_t offset);

/// A volume that owns its samples. They must fit the type.
Volume to_volume(const Samples& s, SampleType type = SampleType::int32, Vec3 spacing = {1, 1, 1});
template <class T>
Volume own(const Grid& grid, SampleType type, std::vector<T> values) {
  auto kept = std::make_shared<std::vector<T>>(std::move(values));
  Volume out;
  out.view.grid = grid;
  out.view.type = type;
  out.view.samples = kept->data();
  out.owner = kept;
  return out;
}

// Functions that are positive inside.
Function sphere(Vec3 centre, double radius);
Function torus(Vec3 centre, double ring, double tube, int axis = 2);
Function unite(Function a, Function b);
/// Spheres about one centre, inside between every other two: k closed surfaces.
Function nested_shells(Vec3 centre, std::vector<double> radii);
Function gyroid(double period, double level);
Function half_space(Vec3 normal, double offset);  ///< inside: normal . p <= offset

/// A volume, an isovalue, and what its surface is, known from outside.
struct KnownVolume {
  std::string name;
  Samples samples;
  double isovalue = 0;
  std::vector<TopologySummary::Kind> kinds;  ///< the multiset of (genus, loops, count), sorted
  std::vector<TopologySummary::Kind> faces_kinds;  ///< the same with Topology::faces
};

/// Shapes whose topology is known without counting.
std::vector<KnownVolume> known_volumes();

// Random volumes, each hard in its own way. All of them cross isovalue 0 unless they are too small
// to.
enum class Family {
  white_noise,    ///< every sample its own
  few_values,     ///< samples in -2..2: most ambiguous faces tie, many samples equal the isovalue
  signs_only,     ///< -1 or 1: every ambiguous face ties
  smooth_blobs,   ///< sums of bumps
  sparse_specks,  ///< single samples and short strips
  gyroid_cut,     ///< gyroid cut by the boundary, plus noise
  plateaus,       ///< smooth, clamped so that whole regions equal the isovalue
  checkerboard,   ///< as many ambiguous faces as there can be, random magnitudes
};
inline constexpr int kFamilies = 8;
const char* name(Family family);
Samples random_samples(Family family, Size size, std::uint64_t seed);
/// 40 x 22 x 22: shells in each other, three deep, beside two others, with specks in and around
/// them.
Samples random_shells(std::uint64_t seed);

}  // namespace isoatlas::detail::test
