// SPDX-License-Identifier: Apache-2.0
// Meshes the samples in an array, and an implicit function.
#include <isoatlas/isoatlas.h>

#include <cmath>
#include <iostream>
#include <vector>

int main() {
  using namespace isoatlas;
  const int n = 48;
  std::vector<float> samples;  // a ball; x runs fastest
  for (int i = 0; i < n * n * n; ++i)
    samples.push_back(
        static_cast<float>(16 - std::hypot(i % n - 23.5, i / n % n - 23.5, i / (n * n) - 23.5)));
  const Extraction ball = extract(VolumeView::of(samples, {n, n, n}), 0, {within(0.5 * vx)});

  const auto torus = [](Vec3 p) { return 0.3 - std::hypot(std::hypot(p.x, p.y) - 0.7, p.z); };
  const Extraction ring =
      extract(sample({torus}, {-1.2, -1.2, -0.5}, {1.2, 1.2, 0.5}, 0.05), 0, {within(0.01)});

  for (const Extraction& e : {ball, ring})
    std::cout << e.mesh().triangles.size() << " triangles, genus " << e.finest().topology.genus
              << '\n';
}
