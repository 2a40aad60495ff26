// SPDX-License-Identifier: Apache-2.0
// Makes the coarse meshes that `isoatlas view` shows while the isovalue moves.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "arguments.h"
#include "isoatlas/extract.h"
#include "view/events.h"
#include "view/kept_results.h"
#include "view/reduced_volumes.h"

namespace isoatlas::detail::tool {

/// A thread that makes one mesh at a time. If a mesh of the whole volume would take longer than a
/// moment, a mesh of a reduced volume comes first. Both are certified, each for its own volume.
class MeshMaker {
 public:
  using Bytes = std::shared_ptr<const std::string>;

  /// @param volume  must outlive this object, as `events`
  MeshMaker(const VolumeView& volume, Events& events);
  ~MeshMaker();
  MeshMaker(const MeshMaker&) = delete;
  MeshMaker& operator=(const MeshMaker&) = delete;

  /// Makes a mesh in place of the one that is being made, which can be of another page. A message
  /// reports that it is cancelled.
  /// @param request  number of the page, in all messages about the mesh
  /// @param arguments  their bounds and levels are ignored
  void make(std::int64_t request, ExtractArguments arguments);

  /// Stops a mesh, if it is still being made.
  void cancel(std::int64_t request);

  /// A mesh, as mesh_bytes(); null if it is not kept any more.
  Bytes mesh(std::uint64_t id) const;

 private:
  struct Request {
    std::int64_t number = 0;
    ExtractArguments arguments;
  };
  /// Of one request.
  struct Job;

  void run();
  void make_meshes(const Request& request);
  std::size_t halvings_for(const Job& job) const;
  void make_mesh(const Job& job, std::size_t halvings, bool is_final);

  const VolumeView volume_;
  Events& events_;
  KeptResults<Bytes> meshes_{4};
  std::optional<ReducedVolumes> reduced_;  // made with the first mesh
  double seconds_per_c_vertex_;            // as measured

  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::optional<Request> next_;
  std::int64_t current_ = 0;  // number of the request that is being made
  bool ends_ = false;
  std::atomic<bool> stops_{false};  // the current mesh is not wanted any more
  std::thread thread_;
};

}  // namespace isoatlas::detail::tool
