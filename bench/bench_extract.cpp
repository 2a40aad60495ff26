// SPDX-License-Identifier: Apache-2.0
// Measures isoatlas::extract, vtkMarchingCubes and vtkFlyingEdges3D on the same samples in one
// process, in turns, and prints one JSON line. bench/compare.py also builds this file and
// vtk_image.h against old commits, so they use only the public API.
#include <malloc.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "isoatlas/io.h"
#include "isoatlas/self_intersections.h"
#include "vtk_image.h"

namespace {

constexpr const char* kUsage =
    R"(usage: bench_extract VOLUME ISOVALUE [options]
  --refine VOXELS             add a level that is refined to this distance, in smallest spacings;
                              may be repeated (default: only the coarse mesh)
  --by-default                treat the distances as defaults: refine to them, but do not prove them
  --max-vertices N            largest number of vertices of each refined level
  --allow-self-intersections  keep self-intersections in the mesh
  --threads N                 threads of isoatlas; VTK always has one (default 1, 0: all)
  --repeats N                 runs of each program (default 1); none starts after 20 CPU seconds
  --no-vtk                    leave VTK's filters out
  --time-limit SECONDS        cancel an extraction that takes longer (wall time)
)";
constexpr double kEnoughCpuSeconds = 20;

struct Arguments {
  std::filesystem::path volume;
  double isovalue = 0;
  std::vector<double> refine;  // bounds in voxels
  bool by_default = false;     // the bounds are defaults, not requested
  std::optional<std::size_t> max_vertices;
  bool allow_self_intersections = false;
  int threads = 1;
  int repeats = 1;
  bool with_vtk = true;
  std::optional<double> time_limit;
};

template <class T>
T parse_number(std::string_view option, std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw std::invalid_argument(std::string(option) + ": expected a number, got '" +
                                std::string(text) + "'");
  return value;
}

Arguments parse_arguments(int argc, char** argv) {
  Arguments out;
  std::vector<std::string_view> positional;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto value = [&] {
      if (i + 1 >= argc) throw std::invalid_argument(std::string(word) + ": expected a value");
      return std::string_view(argv[++i]);
    };
    if (word == "--refine") {
      out.refine.push_back(parse_number<double>(word, value()));
    } else if (word == "--by-default") {
      out.by_default = true;
    } else if (word == "--max-vertices") {
      out.max_vertices = parse_number<std::size_t>(word, value());
    } else if (word == "--allow-self-intersections") {
      out.allow_self_intersections = true;
    } else if (word == "--threads") {
      out.threads = parse_number<int>(word, value());
    } else if (word == "--repeats") {
      out.repeats = std::max(1, parse_number<int>(word, value()));
    } else if (word == "--no-vtk") {
      out.with_vtk = false;
    } else if (word == "--time-limit") {
      out.time_limit = parse_number<double>(word, value());
    } else if (word.starts_with("--")) {
      throw std::invalid_argument("unknown option " + std::string(word));
    } else {
      positional.push_back(word);
    }
  }
  if (positional.size() != 2) throw std::invalid_argument("expected VOLUME and ISOVALUE");
  if (out.max_vertices && out.refine.empty())
    throw std::invalid_argument("--max-vertices: expected --refine as well");
  out.volume = positional[0];
  out.isovalue = parse_number<double>("ISOVALUE", positional[1]);
  return out;
}

// Text of a JSON document.
std::string json(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}
std::string json(std::size_t value) { return std::to_string(value); }
std::string json(bool value) { return value ? "true" : "false"; }
std::string json(const std::string& value) {  // sufficient for file and stage names
  std::string out = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}
template <class T>
std::string json(const std::optional<T>& value) {
  return value ? json(*value) : "null";
}
template <class T>
std::string json(const std::vector<T>& values) {
  std::string out = "[";
  for (std::size_t i = 0; i < values.size(); ++i) out += (i == 0 ? "" : ", ") + json(values[i]);
  return out + "]";
}

class JsonObject {
 public:
  template <class T>
  JsonObject& add(const std::string& key, const T& value) {
    return add_text(key, json(value));
  }
  JsonObject& add_text(const std::string& key, const std::string& text) {
    text_ += (text_.empty() ? "" : ", ") + json(key) + ": " + text;
    return *this;
  }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

struct Seconds {
  double cpu = 0, wall = 0;  // cpu: of all threads
};

Seconds now() {
  timespec cpu{}, wall{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
  clock_gettime(CLOCK_MONOTONIC, &wall);
  const auto seconds = [](const timespec& t) {
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  return {seconds(cpu), seconds(wall)};
}

Seconds since(const Seconds& start) {
  const Seconds end = now();
  return {end.cpu - start.cpu, end.wall - start.wall};
}

// One program's runs.
struct Runs {
  std::vector<double> cpu, wall;
  void add(const Seconds& seconds) {
    cpu.push_back(seconds.cpu);
    wall.push_back(seconds.wall);
  }
  JsonObject to_json() const { return JsonObject().add("cpu_s", cpu).add("wall_s", wall); }
};

// A value of /proc/self/status in bytes, such as VmRSS.
std::optional<std::size_t> status_bytes(std::string_view key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key) || line[key.size()] != ':') continue;
    return 1024 *
           static_cast<std::size_t>(std::strtoull(line.c_str() + key.size() + 1, nullptr, 10));
  }
  return std::nullopt;
}

// Growth of the resident set from construction to its peak before growth() is called. Memory that
// earlier runs have freed is first returned to the system; reusing it would not count as growth.
class PeakMemory {
 public:
  PeakMemory() {
    malloc_trim(0);
    std::ofstream file("/proc/self/clear_refs");
    file << 5 << std::flush;  // resets VmHWM
    if (file) before_ = status_bytes("VmRSS");
  }
  std::optional<std::size_t> growth() const {
    const auto peak = status_bytes("VmHWM");
    if (!before_ || !peak) return std::nullopt;
    return *peak - std::min(*peak, *before_);
  }

 private:
  std::optional<std::size_t> before_;
};

// Sets `expired` after a time, unless the alarm is destroyed before.
class Alarm {
 public:
  explicit Alarm(std::optional<double> seconds) {
    if (seconds) thread_ = std::thread([this, s = *seconds] { wait(s); });
  }
  ~Alarm() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    condition_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  std::atomic<bool> expired = false;

 private:
  void wait(double seconds) {
    std::unique_lock lock(mutex_);
    if (!condition_.wait_for(lock, std::chrono::duration<double>(seconds),
                             [this] { return is_over_; }))
      expired = true;
  }
  std::mutex mutex_;
  std::condition_variable condition_;
  bool is_over_ = false;
  std::thread thread_;
};

struct FilterRuns {
  Runs runs;
  std::size_t triangles = 0;
  std::string to_json() const { return runs.to_json().add("triangles", triangles).text(); }
};

// Runs a contour filter from the samples to the mesh, without normals and scalars, which isoatlas
// does not compute either.
template <class Filter>
void run_filter(vtkImageData* image, double isovalue, FilterRuns& out) {
  malloc_trim(0);
  const Seconds start = now();
  vtkNew<Filter> filter;
  filter->SetInputData(image);
  filter->SetValue(0, isovalue);
  filter->ComputeNormalsOff();
  filter->ComputeGradientsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  out.runs.add(since(start));
  out.triangles = static_cast<std::size_t>(filter->GetOutput()->GetNumberOfPolys());
}

// For earlier versions of the library, in which a Volume had no member `view`.
template <class Volume>
auto& view_of(Volume& volume) {
  if constexpr (requires { volume.view; }) {
    return volume.view;
  } else {
    return volume;
  }
}

template <class Options>
void set_isovalue(Options& options, double isovalue) {
  if constexpr (requires { options.surface; }) {
    options.surface.isovalue = isovalue;
  } else {
    options.isovalue = isovalue;
  }
}

isoatlas::ExtractOptions extract_options(const Arguments& arguments, const isoatlas::Grid& grid) {
  isoatlas::ExtractOptions options;
  set_isovalue(options, arguments.isovalue);
  options.refine.clear();
  options.allow_self_intersections = arguments.allow_self_intersections;
  for (const double bound : arguments.refine) {
    isoatlas::LevelGoal goal;
    if (arguments.max_vertices)
      goal.push_back(
          {isoatlas::Quantity::max_vertices, static_cast<double>(*arguments.max_vertices)});
    goal.push_back({isoatlas::Quantity::max_distance, bound * grid.smallest_spacing()});
    goal.back().is_default = arguments.by_default;
    options.refine.push_back(std::move(goal));
  }
  return options;
}

struct ExtractRuns {
  Runs runs;
  std::map<std::string, std::vector<double>> stages;  // wall seconds
  std::vector<std::optional<std::size_t>> peak_bytes;
  std::optional<isoatlas::Extraction> last;

  std::string to_json() const {
    JsonObject stage_object;
    for (const auto& [stage, seconds] : stages) stage_object.add(stage, seconds);
    return runs.to_json()
        .add("peak_bytes", peak_bytes)
        .add_text("stages_s", stage_object.text())
        .text();
  }
};

// Returns the elapsed time if the run was cancelled at its time limit, else nothing.
std::optional<Seconds> run_extract(const isoatlas::Volume& volume,
                                   const isoatlas::ExtractOptions& options,
                                   const Arguments& arguments, ExtractRuns& out) {
  out.last.reset();
  Alarm alarm(arguments.time_limit);
  isoatlas::RunControl control;
  control.threads = arguments.threads;
  control.cancel = &alarm.expired;
  const PeakMemory memory;
  const Seconds start = now();
  try {
    out.last = isoatlas::extract(volume, options, control);
  } catch (const isoatlas::Error& error) {
    if (error.code() != isoatlas::ErrorCode::cancelled) throw;
    return since(start);
  }
  out.runs.add(since(start));
  out.peak_bytes.push_back(memory.growth());
  for (const isoatlas::StageTime& stage : out.last->report.seconds)
    out.stages[stage.stage].push_back(stage.seconds);
  return std::nullopt;
}

// The levels as JSON. Self-intersections are counted here again, by the public function, outside of
// the measured time.
std::string levels_json(const isoatlas::Extraction& result, double voxel) {
  std::string out = "[";
  for (std::size_t k = 0; k < result.report.levels.size(); ++k) {
    const isoatlas::LevelReport& level = result.report.levels[k];
    const isoatlas::TriangleMesh mesh = result.hierarchy.mesh(k);
    JsonObject object;
    object.add("vertices", level.vertices)
        .add("triangles", level.triangles)
        .add("share_below_third", level.quality.aspect_share_below_third)
        .add("aspect_min", level.quality.aspect_min)
        .add("self_intersections",
             isoatlas::self_intersections(mesh.positions, mesh.triangles).size())
        .add("seconds", level.seconds);
    std::optional<double> distance;
    if (level.metrics)
      distance =
          (*level.metrics)[static_cast<std::size_t>(isoatlas::Quantity::max_distance)].maximum /
          voxel;
    object.add("max_distance_voxels", distance);
    out += (k == 0 ? "" : ", ") + object.text();
  }
  return out + "]";
}

// Loads libraries, starts threads and fills caches. Otherwise the first measurement would include
// these costs.
void warm_up(const Arguments& arguments) {
  constexpr std::size_t kSize = 12;
  std::vector<float> samples(kSize * kSize * kSize);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto squared = [](std::size_t coordinate) {
      const float d = static_cast<float>(coordinate) - 5.5F;
      return d * d;
    };
    samples[i] =
        16.1F - squared(i % kSize) - squared(i / kSize % kSize) - squared(i / kSize / kSize);
  }
  isoatlas::Volume volume;
  view_of(volume).grid.size = {kSize, kSize, kSize};
  view_of(volume).type = isoatlas::SampleType::float32;
  view_of(volume).samples = samples.data();
  isoatlas::RunControl control;
  control.threads = arguments.threads;
  Arguments tiny = arguments;
  tiny.isovalue = 0;
  isoatlas::extract(volume, extract_options(tiny, view_of(volume).grid), control);
  if (!arguments.with_vtk) return;
  const auto image = isoatlas::detail::bench::vtk_image(volume);
  FilterRuns ignored;
  run_filter<vtkMarchingCubes>(image, 0, ignored);
  run_filter<vtkFlyingEdges3D>(image, 0, ignored);
}

}  // namespace

int main(int argc, char** argv) try {
  setenv("VTK_SMP_MAX_THREADS", "1", 1);  // vtkSMPTools.h of VTK 9.1 does not compile as C++20
  const Arguments arguments = parse_arguments(argc, argv);
  const isoatlas::Volume volume = isoatlas::read_volume(arguments.volume);
  const isoatlas::ExtractOptions options = extract_options(arguments, view_of(volume).grid);
  const auto image = isoatlas::detail::bench::vtk_image(volume);
  warm_up(arguments);

  ExtractRuns ours;
  FilterRuns marching_cubes, flying_edges;
  std::optional<Seconds> cancelled_after;
  const double began = now().cpu;
  for (int k = 0; k < arguments.repeats && (k == 0 || now().cpu - began < kEnoughCpuSeconds); ++k) {
    // isoatlas runs first, so that the heap is unused when the memory of its first run is measured.
    if (!cancelled_after) cancelled_after = run_extract(volume, options, arguments, ours);
    if (arguments.with_vtk) {
      run_filter<vtkMarchingCubes>(image, arguments.isovalue, marching_cubes);
      run_filter<vtkFlyingEdges3D>(image, arguments.isovalue, flying_edges);
    }
  }

  JsonObject out;
  out.add("volume", arguments.volume.filename().string())
      .add("isovalue", arguments.isovalue)
      .add("size", std::vector<std::size_t>(view_of(volume).grid.size.begin(),
                                            view_of(volume).grid.size.end()))
      .add("threads", static_cast<std::size_t>(arguments.threads))
      .add("refine_voxels", arguments.refine)
      .add("max_vertices", arguments.max_vertices)
      .add("allow_self_intersections", arguments.allow_self_intersections);
  if (cancelled_after) {
    out.add_text("cancelled_after", JsonObject()
                                        .add("cpu_s", cancelled_after->cpu)
                                        .add("wall_s", cancelled_after->wall)
                                        .text());
  } else {
    out.add("c_vertices", ours.last->report.c_vertices)
        .add_text("isoatlas", ours.to_json())
        .add_text("levels", levels_json(*ours.last, view_of(volume).grid.smallest_spacing()));
  }
  if (arguments.with_vtk) {
    out.add_text("marching_cubes", marching_cubes.to_json())
        .add_text("flying_edges", flying_edges.to_json());
  }
  std::printf("%s\n", out.text().c_str());
  return 0;
} catch (const std::invalid_argument& error) {
  std::fprintf(stderr, "bench_extract: %s\n%s", error.what(), kUsage);
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_extract: %s\n", error.what());
  return 1;
}
