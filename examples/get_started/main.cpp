// SPDX-License-Identifier: Apache-2.0
// The C++ code of docs/get-started.md; the page shows the code between the marks. Run it in the
// folder that contains samples/.
#include <isoatlas/extract.h>
#include <isoatlas/io.h>
#include <isoatlas/self_intersections.h>

#include <iostream>

int main() {
  // [read]
  const isoatlas::Volume volume = isoatlas::read_volume("samples/protein_iron.nhdr");
  const isoatlas::SampleSummary range = isoatlas::summarize(volume);
  std::cout << "samples from " << range.minimum << " to " << range.maximum << '\n';
  // [extract]
  using namespace isoatlas;
  const Extraction result = extract(volume, 100, {within(0.5 * vx)});
  // [write]
  isoatlas::write_hierarchy(result.hierarchy, "protein.glb");
  // [check]
  const isoatlas::TriangleMesh mesh = result.mesh();
  const isoatlas::MeshTopology topology = isoatlas::mesh_topology(mesh);
  const std::size_t pairs = isoatlas::self_intersections(mesh.positions, mesh.triangles).size();
  std::cout << "manifold " << topology.is_manifold() << " genus " << topology.genus()
            << " self-intersections " << pairs << '\n';
  // [end]
}
