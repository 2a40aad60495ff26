// SPDX-License-Identifier: Apache-2.0
// Reports as JSON. docs/reference/report.md documents every key.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/component_extents.h"
#include "isoatlas/extract.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/self_intersections.h"
#include "isoatlas/volume.h"
#include "isoatlas/volume_source.h"

namespace isoatlas::detail {

/// The pairs of intersecting triangles of a mesh.
struct SelfIntersectionReport {
  struct Place {
    TrianglePair triangles;
    Vec3 position;  ///< near the intersection
  };
  std::size_t pairs = 0;
  std::vector<Place> first;  ///< the first ten pairs
};

/// A mesh file that was written.
struct ReportFile {
  std::string path;
  std::vector<std::size_t> levels;  ///< the levels in the file
  std::size_t bytes = 0;
  bool single_precision = false;  ///< whether positions are float32
  double largest_rounding = 0;    ///< largest rounding of a position, in the mesh's units
  std::string space = {};  ///< space of the stored coordinates: "LPS", "RAS", "voxel" or empty
  LengthUnit unit = LengthUnit::unknown;  ///< unit of the stored coordinates
  std::vector<std::string> notes = {};    ///< as StoredPositions::notes
  /// Self-intersections of each level with the positions in the file. Empty if the file does not
  /// round positions, or if they were not counted.
  std::vector<SelfIntersectionReport> self_intersections = {};
};

/// A mesh for Neuroglancer that was written; per level as NeuroglancerMesh.
struct NeuroglancerReport {
  std::string path;  ///< of the folder
  std::size_t fragments = 0, bytes = 0;
  std::vector<double> rounding;
  std::vector<std::size_t> self_intersections;
};

/// A volume and the facts about its file.
struct VolumeReport {
  std::string path;           ///< empty: the volume came from memory
  VolumeSource source;        ///< how its file was interpreted
  std::string sample_digest;  ///< SHA-256 of the samples; empty: not computed
  Grid grid;
  SampleType sample_type = SampleType::float32;
};

/// The result of `isoatlas info`.
struct InfoReport {
  struct Isovalue {
    double value = 0;
    std::string reason;
  };
  VolumeReport volume;  ///< `grid` has size 0 if a volume must be selected first
  std::optional<SampleSummary> samples;
  std::vector<Isovalue> isovalues;  ///< suggested isovalues
};

/// The contents of a report in addition to those of ExtractReport: input, command, options, output
/// files, and the time and memory used.
struct ReportContext {
  VolumeReport volume;
  std::string command;  ///< the command line, quoted for a shell; empty: no command
  std::vector<ReportFile> files;
  std::optional<NeuroglancerReport> neuroglancer = {};
  ExtractOptions options;
  int threads = 0;  ///< the requested number; 0: as many as the machine has
  double read_seconds = 0, write_seconds = 0;
  std::size_t peak_memory_bytes = 0;
};

/// The measured distance of a mesh from an isosurface, and which isosurface it is.
struct DistanceReport {
  std::string volume_path;  ///< empty: the volume came from memory
  MeasureOptions options;
  Measurement measured;
};

/// Largest resident size of this process so far, in bytes.
std::size_t peak_memory_bytes();

/// Finds the intersecting pairs of triangles. Throws as self_intersections().
SelfIntersectionReport find_self_intersections(const TriangleMesh& mesh, const RunControl& control);

/// The report as a JSON object, schema "isoatlas-report-3", with keys in a fixed order and a
/// newline at the end.
std::string to_json(const ExtractReport& report, const ReportContext& context);

/// The result of `isoatlas info` as a JSON object, schema "isoatlas-info-1". Keys that depend on
/// the samples are null if a volume must be selected first.
std::string to_json(const InfoReport& info);

/// The part of the report about one level, on one line, without its time and file. Mesh files store
/// it with the level. The same input gives the same text.
std::string level_json(const LevelReport& level, std::size_t number);

/// A list of files with one level each, schema "isoatlas-manifest-2". It is stored in the folder of
/// the files and contains their names without folders.
/// @param files   one level each, coarse to fine
/// @param levels  the level_json() of each file; or empty
std::string levels_manifest(const std::vector<ReportFile>& files,
                            const std::vector<std::string>& levels);

/// Number of components that the result of `isoatlas check` lists.
constexpr std::size_t kCheckedComponents = 1000;

/// The result of `isoatlas check` as a JSON object, schema "isoatlas-check-1". Euler
/// characteristic, genus, boundary loops and kinds are null unless the mesh is a consistently
/// oriented manifold.
/// @param mesh_path  empty: the mesh came from memory
/// @param self_intersections  null if they were not tested
/// @param distance  null if it was not measured
std::string to_json(const std::string& mesh_path, const MeshTopology& topology,
                    const MeshExtent& extent, const MeshQuality& quality,
                    const SelfIntersectionReport* self_intersections = nullptr,
                    const DistanceReport* distance = nullptr);

}  // namespace isoatlas::detail
