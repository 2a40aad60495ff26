// SPDX-License-Identifier: Apache-2.0
// Extracts the isosurface of a small generated volume with one thread. bench/instructions.py and
// bench/stop_gaps.py count the instructions of extract_case() with valgrind.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <vector>

#include "isoatlas/extract.h"

namespace {

struct Case {
  const char* name;
  std::array<std::size_t, 3> size;
  isoatlas::Vec3 spacing;
  // The value at a sample index; the isovalue is 0.
  std::function<double(double x, double y, double z)> value;
  double refine_voxels;   // 0: coarse mesh only
  bool is_proved = true;  // false: a default bound, which is not proved
  std::size_t measure_samples = 0;
};

double square(double x) { return x * x; }

// A torus and a ball above it. Both are polynomials, so the samples are equal on all machines.
double torus_and_ball(double x, double y, double z) {
  const double r2 = square(x - 14.3) + square(y - 15.1);
  const double torus =
      4 * square(8.0) * r2 - square(r2 + square(z - 12.2) + square(8.0) - square(3.6));
  const double ball = square(3.7) - square(x - 15.6) - square(y - 14.8) - square(z - 25.4);
  return std::max(torus / 500, ball);
}

// splitmix64 (Steele, Lea, Flood 2014) of the sample index, in (-0.5, 0.5).
double noise(double x, double y, double z) {
  std::uint64_t bits = 0x9E3779B97F4A7C15u * (1 + static_cast<std::uint64_t>(x + 16 * y + 256 * z));
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  bits ^= bits >> 31;
  return static_cast<double>(bits >> 11) * 0x1p-53 - 0.5;
}

// A saddle and a ball that the volume boundary cuts, with thick slices and noise.
double cut_by_boundary(double x, double y, double z) {
  const double saddle = 40 + square(x - 11.2) - square(y - 10.7) - 6 * square(z - 11.4);
  const double ball = square(6.4) - square(x - 22.1) - square(y - 2.3) - square(2.5 * (z - 20.2));
  return std::max(saddle, ball) + 60 * noise(x, y, z);
}

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"smooth_32_refined", {32, 32, 32}, {1, 1, 1}, torus_and_ball, 0.5},
      {"noise_16_coarse", {16, 16, 16}, {1, 1, 1}, noise, 0},
      {"noise_16_refined", {16, 16, 16}, {1, 1, 1}, noise, 0.5, false},
      {"noise_16_measured", {16, 16, 16}, {1, 1, 1}, noise, 0, false, 20000},
      {"anisotropic_24_refined", {24, 24, 24}, {0.7, 0.7, 1.75}, cut_by_boundary, 1},
  };
  return list;
}

}  // namespace

// The name is not mangled: valgrind's options name this function.
extern "C" __attribute__((noinline)) std::size_t extract_case(
    const isoatlas::VolumeView* volume, const isoatlas::ExtractOptions* options) {
  isoatlas::RunControl control;
  control.threads = 1;
  return isoatlas::extract(*volume, *options, control).finest().triangles;
}

int main(int argc, char** argv) try {
  for (const Case& one : cases()) {
    if (argc != 2 || std::strcmp(argv[1], one.name) != 0) continue;
    std::vector<float> samples;
    samples.reserve(one.size[0] * one.size[1] * one.size[2]);
    for (std::size_t z = 0; z < one.size[2]; ++z)
      for (std::size_t y = 0; y < one.size[1]; ++y)
        for (std::size_t x = 0; x < one.size[0]; ++x)
          samples.push_back(static_cast<float>(
              one.value(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))));
    isoatlas::VolumeView volume;
    volume.grid.size = one.size;
    volume.grid.spacing = one.spacing;
    volume.type = isoatlas::SampleType::float32;
    volume.samples = samples.data();
    isoatlas::ExtractOptions options;
    options.refine.clear();
    if (one.refine_voxels > 0)
      options.refine.push_back(
          {{isoatlas::Quantity::max_distance, one.refine_voxels * volume.grid.smallest_spacing(),
            !one.is_proved}});
    options.measure_samples = one.measure_samples;
    std::printf("%zu triangles\n", extract_case(&volume, &options));
    return 0;
  }
  std::fprintf(stderr, "usage: instruction_cases CASE, one of:\n");
  for (const Case& one : cases()) std::fprintf(stderr, "  %s\n", one.name);
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "instruction_cases: %s\n", error.what());
  return 1;
}
