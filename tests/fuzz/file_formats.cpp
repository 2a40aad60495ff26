// SPDX-License-Identifier: Apache-2.0
#include "fuzz/file_formats.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "isoatlas/io.h"
#include "page/page.h"

namespace isoatlas::detail::test {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 16> kVolumes{"png", "nrrd", "nhdr", "nii", "mha", "mhd",
                                                    "tif", "dcm",  "vtk",  "vti", "vtr", "pvti",
                                                    "npy", "mrc",  "mgh",  "mgz"};
constexpr std::array<std::string_view, 8> kMeshes{"ply", "stl", "obj", "off",
                                                  "vtp", "glb", "3mf", "gii"};

template <class List>
bool holds(const List& list, std::string_view format) {
  return std::ranges::find(list, format) != list.end();
}

/// A folder with one file or two slices, in memory if the machine has a folder in memory. The
/// extension of the file's name is the format.
class FileInMemory {
 public:
  FileInMemory(std::string_view format, std::span<const std::uint8_t> bytes) {
    const fs::path parent = fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    folder_ = parent / ("isoatlas-fuzz-" + std::to_string(getpid()));
    fs::create_directory(folder_);
    path_ = folder_ / ("s1." + std::string(format));
    write(path_, bytes);
    // A header may name this file as the file with its samples.
    constexpr std::string_view kSamples = "samples.raw";
    if (std::search(bytes.begin(), bytes.end(), kSamples.begin(), kSamples.end()) != bytes.end())
      write(folder_ / kSamples, bytes);
    if (format == "png") {  // a folder of slices
      write(folder_ / "s2.png", bytes);
      path_ = folder_;
    }
  }
  ~FileInMemory() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;

  const fs::path& path() const { return path_; }
  const fs::path& folder() const { return folder_; }

 private:
  static void write(const fs::path& path, std::span<const std::uint8_t> bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }

  fs::path folder_, path_;
};

std::string problem_of_grid(const Grid& grid) {
  const auto finite = [](const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  const bool is_sound = finite(grid.origin) && finite(grid.spacing) && grid.spacing.x > 0 &&
                        grid.spacing.y > 0 && grid.spacing.z > 0 &&
                        std::ranges::all_of(grid.direction, finite) &&
                        std::ranges::all_of(grid.size, [](std::size_t n) { return n >= 2; });
  return is_sound ? "" : "a grid that is not sound";
}

std::string problem_of_volume(const fs::path& path, const ReadOptions& options) {
  mallopt(M_PERTURB, 0x11);  // unwritten memory differs from read to read
  const VolumeFile once = read_volume_file(path, options);
  if (const std::string wrong = problem_of_grid(once.volume.view.grid); !wrong.empty())
    return wrong;
  mallopt(M_PERTURB, 0x22);
  const VolumeFile again = read_volume_file(path, options);
  if (sample_digest(once.volume) != sample_digest(again.volume))
    return "other samples when it is read again";
  for (const std::string& warning : once.source.warnings)
    if (warning.find('\n') != std::string::npos) return "a warning of more than one line";
  return "";
}

void choose(ReadOptions& options, const FileChoice& choice, std::size_t entry) {
  if (choice.name == "channel") options.channel = std::to_string(entry);
  if (choice.name == "time") options.time = entry;
  if (choice.name == "layer") options.layer = std::to_string(entry);
  if (choice.name == "array") options.array = choice.entries[entry];
  if (choice.name == "series") options.series = std::to_string(entry);
}

std::string problem_of_any_choice(const fs::path& path) {
  ReadOptions options;
  options.max_memory = std::uint64_t{1} << 26;
  constexpr int kDeepest = 4;
  for (int depth = 0; depth < kDeepest; ++depth) {
    try {
      return problem_of_volume(path, options);
    } catch (const ChoiceNeeded& needed) {
      if (needed.choice().entries.size() < 2) return "a choice of fewer than two";
      choose(options, needed.choice(), needed.choice().entries.size() - 1);
    }
  }
  return "";
}

std::string problem_of_mesh(const fs::path& path) {
  const HierarchyFile file = read_levels(path);
  for (std::size_t level = 0; level < file.hierarchy.levels.size(); ++level) {
    const TriangleMesh mesh = file.hierarchy.mesh(level);
    for (const auto& triangle : mesh.triangles)
      if (std::ranges::any_of(triangle,
                              [&](std::uint32_t v) { return v >= mesh.positions.size(); }))
        return "a triangle with a vertex that is not there";
    for (const Vec3& p : mesh.positions)
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        return "a position that is not finite";
  }
  entry_of_file(path);
  return "";
}

TriangleMesh octahedron() {
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

/// Reads a report about an octahedron: from memory, and as a file next to its mesh, octahedron.ply.
/// Reports that name other folders are read from memory only: they could name the whole disk as a
/// folder of DICOM slices.
void read_report(const FileInMemory& file, std::span<const std::uint8_t> bytes) {
  const std::string text(bytes.begin(), bytes.end());
  const TriangleMesh mesh = octahedron();
  if (text.find_first_of("/\\~") == std::string::npos && text.find("\"..") == std::string::npos) {
    write_mesh(mesh, file.folder() / "octahedron.ply");
    entry_of_file(file.path());
  }
  entry_of_report(text, "report.json", hierarchy_of({mesh}), std::nullopt);
}

}  // namespace

bool is_fuzzed_format(std::string_view format) {
  return holds(kVolumes, format) || holds(kMeshes, format) || format == "json";
}

std::string find_problem_in_file(std::string_view format, std::span<const std::uint8_t> bytes) {
  const FileInMemory file(format, bytes);
  try {
    if (holds(kVolumes, format)) return problem_of_any_choice(file.path());
    if (holds(kMeshes, format)) return problem_of_mesh(file.path());
    read_report(file, bytes);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::internal || error.code() == ErrorCode::cancelled)
      return error.what();
    if (std::strpbrk(error.what(), "\n\r") != nullptr) return "a message of more than one line";
  }
  return "";
}

}  // namespace isoatlas::detail::test
