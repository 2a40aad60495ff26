// SPDX-License-Identifier: Apache-2.0
// What isoatlas found out, as JSON for machines. docs/reference/report.md documents every key.
#pragma once

#include <cstddef>
#include <string>

#include "isoatlas/extract.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/volume.h"

namespace isoatlas {

/// What a report says besides what extract() found out: where things came from and went to, and what that took.
struct ReportContext {
  std::string volume_path, mesh_path;
  Grid grid;
  SampleType sample_type = SampleType::float32;
  ExtractOptions options;
  int threads = 0;  ///< as asked for; 0: as many as the machine has
  std::size_t mesh_vertices = 0;
  double read_seconds = 0, write_seconds = 0;
  std::size_t peak_memory_bytes = 0;
};

/// How far a mesh is from an isosurface, and from which.
struct DistanceReport {
  std::string volume_path;
  MeasureOptions options;
  Measurement measured;
};

/// One JSON object, schema "isoatlas-report-1", keys in a fixed order, a newline at the end.
std::string to_json(const ExtractReport& report, const ReportContext& context);

/// The same for a mesh that was only looked at, schema "isoatlas-check-1". What only a consistently oriented manifold
/// has (Euler characteristic, genus, loops) is null for anything else.
/// @param distance  null if there was no volume to measure against
std::string to_json(const std::string& mesh_path, const MeshTopology& topology, const MeshQuality& quality,
                    const DistanceReport* distance = nullptr);

}  // namespace isoatlas
