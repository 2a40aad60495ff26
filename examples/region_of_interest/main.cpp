// SPDX-License-Identifier: Apache-2.0
// Meshes a region of interest of an image with padded rows. The image is not copied.
#include <isoatlas/isoatlas.h>

#include <cmath>
#include <iostream>
#include <vector>

int main() {
  using namespace isoatlas;
  const int nx = 50, ny = 40, nz = 30, pitch = 64;  // pitch: bytes per row
  std::vector<std::uint8_t> image(static_cast<std::size_t>(pitch * ny * nz));
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        image[static_cast<std::size_t>(x + pitch * (y + ny * z))] = static_cast<std::uint8_t>(
            std::fmax(0, 250 - 20 * std::fmin(std::hypot(x - 12, y - 20, z - 15),
                                              std::hypot(x - 37, y - 20, z - 15))));

  VolumeView volume =
      VolumeView::of(std::span<const std::uint8_t>(image), {nx, ny, nz}, {1, pitch, pitch * ny});
  volume.grid.spacing = {0.5, 0.5, 0.8};
  const Extraction all = extract(volume, 127.5),
                   left = extract(volume.box({0, 0, 0}, {24, ny - 1, nz - 1}), 127.5);
  std::cout << all.finest().topology.components << " components, "
            << left.finest().topology.components << " in the region of interest\n";
}
