// SPDX-License-Identifier: Apache-2.0
#include "view/mesh_maker.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "error_text.h"
#include "isoatlas/error.h"
#include "text.h"
#include "view/messages.h"
#include "view/shown_mesh.h"

namespace isoatlas::detail::tool {
namespace {

constexpr double kFirstSeconds = 5e-6;  // per c-vertex, before any is measured
constexpr double kMoment = 0.3;         // seconds; a mesh that takes longer gets a preview
constexpr std::size_t kSampledSlices = 8;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Hundreds of meshes of different sizes are made one after the other. Without this, the free
/// memory between what is kept would grow.
void return_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

/// The options of a coarse mesh. Those that change nothing in it are set to their defaults.
ExtractOptions coarse_options(const ExtractArguments& arguments, const Grid& grid, bool is_final) {
  ExtractOptions options = in_world(arguments, grid);
  options.refine.clear();
  options.coarse.clear();
  options.levels = 0;
  options.measure_samples = 0;
  if (!is_final) {
    options.supersample = 1;
    options.allow_self_intersections = options.border == Border::open;
  }
  return options;
}

}  // namespace

struct MeshMaker::Job {
  std::int64_t number;
  const ExtractArguments& arguments;
  Region region;
};

MeshMaker::MeshMaker(const VolumeView& volume, Events& events)
    : volume_(volume),
      events_(events),
      seconds_per_c_vertex_(kFirstSeconds),
      thread_([this] { run(); }) {}

MeshMaker::~MeshMaker() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    stops_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void MeshMaker::make(std::int64_t request, ExtractArguments arguments) {
  const std::lock_guard lock(mutex_);
  if (next_) events_.send(message("cancelled", next_->number));
  next_ = Request{request, std::move(arguments)};
  stops_ = true;
  changed_.notify_all();
}

void MeshMaker::cancel(std::int64_t request) {
  const std::lock_guard lock(mutex_);
  if (next_ && next_->number == request) {
    next_.reset();
    events_.send(message("cancelled", request));
  } else if (current_ == request) {
    stops_ = true;
  }
}

MeshMaker::Bytes MeshMaker::mesh(std::uint64_t id) const {
  return meshes_.get(id).value_or(nullptr);
}

void MeshMaker::run() {
  while (true) {
    Request request;
    {
      std::unique_lock lock(mutex_);
      current_ = 0;
      changed_.wait(lock, [this] { return ends_ || next_; });
      if (ends_) return;
      request = *std::exchange(next_, std::nullopt);
      current_ = request.number;
      stops_ = false;
    }
    try {
      make_meshes(request);
    } catch (const Error& error) {
      events_.send(error.code() == ErrorCode::cancelled
                       ? message("cancelled", request.number)
                       : failure(request.number, error_text(error)));
    } catch (const std::bad_alloc&) {
      events_.send(failure(request.number, "out of memory; choose a region of interest"));
    }
    return_memory();
  }
}

void MeshMaker::make_meshes(const Request& request) {
  if (!reduced_) reduced_.emplace(volume_);
  Job job{request.number, request.arguments,
          request.arguments.volume.read.region.value_or(Region{})};
  const std::size_t halvings = halvings_for(job);
  if (halvings > 0) {
    try {
      make_mesh(job, halvings, false);
    } catch (const Error& error) {
      // The whole volume decides whether there is a mesh.
      if (error.code() == ErrorCode::cancelled) throw;
    }
  }
  make_mesh(job, 0, true);
}

/// The least reduction with which a mesh is expected in a moment.
std::size_t MeshMaker::halvings_for(const Job& job) const {
  const double isovalue = job.arguments.options.surface.isovalue;
  std::size_t halvings = 0;
  for (; halvings + 1 < reduced_->count(); ++halvings) {
    const auto volume = reduced_->at(halvings, job.region);
    if (!volume) break;
    const std::size_t crossings =
        count_crossings(*volume, isovalue, halvings == 0 ? kSampledSlices : 1);
    if (static_cast<double>(crossings) * seconds_per_c_vertex_ < kMoment) return halvings;
  }
  return reduced_->at(halvings, job.region) ? halvings : 0;
}

void MeshMaker::make_mesh(const Job& job, std::size_t halvings, bool is_final) {
  const auto volume = reduced_->at(halvings, job.region);
  if (!volume)
    throw Error(ErrorCode::bad_argument,
                "roi: the region has a single sample along an axis, expected two or more");
  const ExtractOptions options = coarse_options(job.arguments, volume_.grid, is_final);
  ProgressMessages progress(events_, job.number);
  const RunControl control{.progress =
                               [&](std::string_view stage, double fraction) {
                                 if (is_final) progress.show(stage, fraction);
                               },
                           .cancel = &stops_};
  const auto start = std::chrono::steady_clock::now();
  const Extraction extraction = extract(*volume, options, control);
  const double seconds = seconds_since(start);
  // Half of the earlier measurements, because isosurfaces of one volume differ.
  const auto c_vertices =
      static_cast<double>(std::max<std::size_t>(extraction.report.c_vertices, 1000));
  seconds_per_c_vertex_ = (seconds_per_c_vertex_ + seconds / c_vertices) / 2;
  const std::size_t reduction = std::size_t{1} << halvings;
  const std::uint64_t id = meshes_.keep(std::make_shared<const std::string>(
      mesh_bytes(extraction, {options.surface.isovalue, reduction, seconds, volume_.grid.unit})));
  events_.send(mesh_message(job.number, id, reduction, is_final));
}

}  // namespace isoatlas::detail::tool
