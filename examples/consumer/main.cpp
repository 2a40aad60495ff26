// SPDX-License-Identifier: Apache-2.0
// Meshes the sample volume: 68 x 68 x 68 bytes of electron density. Run it in the folder that has samples/.
#include <isoatlas/extract.h>

#include <fstream>
#include <iostream>
#include <vector>

int main() {
  std::vector<char> samples(68 * 68 * 68);
  std::ifstream("samples/protein_iron.raw", std::ios::binary).read(samples.data(), static_cast<std::streamsize>(samples.size()));

  isoatlas::VolumeView volume;
  volume.grid.size = {68, 68, 68};
  volume.type = isoatlas::SampleType::uint8;
  volume.samples = samples.data();

  isoatlas::ExtractOptions options;
  options.isovalue = 100;
  options.refine = {{{isoatlas::Quantity::max_distance, 0.5}}};

  const isoatlas::Extraction result = isoatlas::extract(volume, options);
  const isoatlas::TriangleMesh mesh = result.mesh();
  std::cout << mesh.positions.size() << " vertices, " << mesh.triangles.size() << " triangles, genus " << result.finest().topology.genus
            << '\n';
}
