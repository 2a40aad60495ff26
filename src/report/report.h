// SPDX-License-Identifier: Apache-2.0
// What isoatlas found out, as JSON for machines. docs/reference/report.md documents every key.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/self_intersections.h"
#include "isoatlas/volume.h"
#include "isoatlas/volume_source.h"

namespace isoatlas::detail {

/// Pairs of triangles of a mesh that meet where they should not.
struct SelfIntersectionReport {
  struct Place {
    TrianglePair triangles;
    Vec3 position;  ///< near where they meet
  };
  std::size_t pairs = 0;
  std::vector<Place> first;  ///< the first few of them
};

/// A file of meshes that was written.
struct ReportFile {
  std::string path;
  std::vector<std::size_t> levels;  ///< that it holds
  std::size_t bytes = 0;
  bool single_precision = false;  ///< it has positions in float32
  double largest_rounding = 0;    ///< of a position, in the mesh's units
  std::string space = {};  ///< of the stored coordinates: "LPS", "RAS", "voxel"; empty: nobody said
  LengthUnit unit = LengthUnit::unknown;  ///< of the stored coordinates
  std::vector<std::string> notes = {};    ///< what the format changed or had to state, for people
  /// For each level, those of the positions as the file has them; empty: not looked for, the file
  /// has all digits of the positions.
  std::vector<SelfIntersectionReport> self_intersections = {};
};

/// The volume that was meshed or looked at.
struct VolumeReport {
  std::string path;           ///< empty: it came from memory
  VolumeSource source;        ///< how its file was understood
  std::string sample_digest;  ///< SHA-256 of the samples; empty: not computed
  Grid grid;
  SampleType sample_type = SampleType::float32;
};

/// What `info` finds out about a volume file.
struct InfoReport {
  struct Isovalue {
    double value = 0;
    std::string reason;
  };
  VolumeReport volume;  ///< `grid` has size 0 where a choice has to be made first
  std::optional<SampleSummary> samples;
  std::vector<Isovalue> isovalues;  ///< suggested ones
};

/// What a report says besides what extract() found out: where things came from and went to, and
/// what that took.
struct ReportContext {
  VolumeReport volume;
  std::string command;  ///< that made it, as one would type it; empty: it was no command
  std::vector<ReportFile> files;
  ExtractOptions options;
  int threads = 0;  ///< as asked for; 0: as many as the machine has
  double read_seconds = 0, write_seconds = 0;
  std::size_t peak_memory_bytes = 0;
};

/// How far a mesh is from an isosurface, and from which.
struct DistanceReport {
  std::string volume_path;  ///< empty: the volume came from memory
  MeasureOptions options;
  Measurement measured;
};

/// Largest resident size of this process so far.
std::size_t peak_memory_bytes();

/// Looks for them. Throws as self_intersections().
SelfIntersectionReport find_self_intersections(const TriangleMesh& mesh, const RunControl& control);

/// One JSON object, schema "isoatlas-report-2", keys in a fixed order, a newline at the end.
std::string to_json(const ExtractReport& report, const ReportContext& context);

/// One JSON object, schema "isoatlas-info-1". What needs the samples is null where a choice has to
/// be made first.
std::string to_json(const InfoReport& info);

/// What the report says of one level, on one line, without the time it took and the file it went
/// to: for files that carry it with the level. The same input gives the same text.
std::string level_json(const LevelReport& level, std::size_t number);

/// A list of files with one level each, schema "isoatlas-manifest-1": `files` have one level each,
/// in their order; `levels` has the level_json() of each, or nothing. Names are relative to the
/// list, which is beside them.
std::string levels_manifest(const std::vector<ReportFile>& files,
                            const std::vector<std::string>& levels);

/// One JSON object for a mesh that was only looked at, schema "isoatlas-check-1". What only a
/// consistently oriented manifold has (Euler characteristic, genus, loops) is null for anything
/// else.
/// @param mesh_path  empty: the mesh came from memory
/// @param self_intersections  null if nobody looked for them
/// @param distance  null if there was no volume to measure against
std::string to_json(const std::string& mesh_path, const MeshTopology& topology,
                    const MeshQuality& quality,
                    const SelfIntersectionReport* self_intersections = nullptr,
                    const DistanceReport* distance = nullptr);

}  // namespace isoatlas::detail
