// SPDX-License-Identifier: Apache-2.0
// isoatlas-mpi FOLDER: meshes the blocks of `isoatlas blocks plan` on all ranks and merges them on
// rank 0. A rank gets its next block when it has finished one.
#include <mpi.h>

#include <atomic>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "block_parts.h"
#include "blocks.h"
#include "commands.h"
#include "error_text.h"
#include "exit_status.h"
#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "text.h"
#include "volume_input.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: mpirun -n RANKS isoatlas-mpi FOLDER [--threads N]\n\n"
    "Meshes the blocks of `isoatlas blocks plan --parts FOLDER` on all ranks, each with N threads\n"
    "(default: 1), and merges them on rank 0. Every rank must see FOLDER and the volume.\n";

/// Numbers of blocks, each given to one rank.
class BlockQueue {
 public:
  explicit BlockQueue(int count) : count_(count) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    if (rank_ == 0 && ranks_ > 1) server_ = std::thread([this] { serve(); });
  }
  ~BlockQueue() {
    if (server_.joinable()) server_.join();
  }
  BlockQueue(const BlockQueue&) = delete;
  BlockQueue& operator=(const BlockQueue&) = delete;

  /// The next block of this rank; none is left if it is the number of blocks or more.
  int next() {
    if (rank_ == 0) return next_++;
    int block = 0;
    MPI_Send(nullptr, 0, MPI_INT, 0, kRequest, MPI_COMM_WORLD);
    MPI_Recv(&block, 1, MPI_INT, 0, kBlock, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return block;
  }

 private:
  static constexpr int kRequest = 1, kBlock = 2;

  // Answers until every other rank knows that no block is left.
  void serve() {
    for (int ended = 0; ended < ranks_ - 1;) {
      MPI_Status status;
      MPI_Recv(nullptr, 0, MPI_INT, MPI_ANY_SOURCE, kRequest, MPI_COMM_WORLD, &status);
      const int block = next_++;
      ended += block >= count_ ? 1 : 0;
      MPI_Send(&block, 1, MPI_INT, status.MPI_SOURCE, kBlock, MPI_COMM_WORLD);
    }
  }

  int count_, rank_ = 0, ranks_ = 1;
  std::atomic<int> next_ = 0;
  std::thread server_;
};

BlocksArguments arguments_from(const std::vector<std::string>& words) {
  BlocksArguments out;
  out.threads = 1;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--threads" && i + 1 < words.size()) {
      out.threads = parse_threads(words[++i]);
    } else if (!words[i].starts_with("-") && out.folder.empty()) {
      out.folder = fs::absolute(words[i]);
    } else {
      throw Error(ErrorCode::bad_argument,
                  "'" + words[i] + "' is not expected; " + "isoatlas-mpi --help shows what is");
    }
  }
  if (out.folder.empty()) throw Error(ErrorCode::bad_argument, "FOLDER is missing");
  return out;
}

/// What every rank needs before it meshes blocks.
struct Job {
  BlocksArguments arguments;
  ExtractArguments planned;
  VolumeReader volume;
  BlockPlan plan;
};

Job job_from(const std::vector<std::string>& words, bool is_threaded) {
  if (!is_threaded)
    throw Error(ErrorCode::unsupported,
                "this MPI has no MPI_THREAD_MULTIPLE; use `isoatlas blocks run` on each machine");
  BlocksArguments arguments = arguments_from(words);
  ExtractArguments planned = planned_arguments(arguments.folder);
  VolumeReader volume = open_volume_input(planned.volume.path, planned.volume.read);
  const BlockPlan plan(volume.grid(), block_size_of(planned, volume));
  return {std::move(arguments), std::move(planned), std::move(volume), plan};
}

int rank_of_this_process() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int run(const Job& job) {
  const BlockParts parts(*job.planned.parts, job.plan);
  const ExtractOptions options = in_world(job.planned, job.volume.grid());
  RunControl control;
  control.threads = job.arguments.threads;
  const auto count = static_cast<int>(job.plan.block_count());
  {
    BlockQueue queue(count);
    for (int b = queue.next(); b < count; b = queue.next()) {
      const auto block = static_cast<std::size_t>(b);
      parts.make(job.volume, options, {block, block + 1}, control);
    }
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank_of_this_process() != 0) return kSuccess;
  Interruption interruption;
  return run_blocks_merge(job.arguments, interruption);
}

struct Failure {
  int status;
  std::string message;
};

/// Runs `work` and calls failed() with the error, if there is one.
template <class Work, class Failed>
void report_errors(Work work, Failed failed) {
  try {
    work();
  } catch (const Error& error) {
    failed(Failure{exit_status(error.code()), error_text(error)});
  } catch (const std::bad_alloc&) {
    failed(Failure{kOutOfMemory, "out of memory"});
  } catch (const std::exception& error) {
    failed(Failure{kInternal, error.what()});
  }
}

void print(const Failure& failure) {
  std::cerr << "isoatlas-mpi: error: " << one_line(failure.message) << std::endl;
}

/// What is wrong before the first block is wrong on all ranks: the first of them prints it.
/// @return the status of the first rank with an error, or success
int status_of_all(const std::optional<Failure>& failure) {
  constexpr int kNoRank = std::numeric_limits<int>::max();
  const int rank = rank_of_this_process();
  int first = failure ? rank : kNoRank;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (first == kNoRank) return kSuccess;
  int status = failure ? failure->status : kSuccess;
  if (first == rank) print(*failure);
  MPI_Bcast(&status, 1, MPI_INT, first, MPI_COMM_WORLD);
  return status;
}

}  // namespace
}  // namespace isoatlas::detail::tool

int main(int argc, char** argv) {
  using namespace isoatlas;
  using namespace isoatlas::detail::tool;
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty() || words[0] == "--help" || words[0] == "-h") {
    (words.empty() ? std::cerr : std::cout) << kUsage;
    return words.empty() ? kBadInput : kSuccess;
  }
  if (words[0] == "--version") {
    std::cout << "isoatlas-mpi " ISOATLAS_VERSION "\n";
    return kSuccess;
  }
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &provided);
  std::optional<Job> job;
  std::optional<Failure> failure;
  report_errors([&] { job.emplace(job_from(words, provided >= MPI_THREAD_MULTIPLE)); },
                [&](const Failure& it) { failure = it; });
  int status = status_of_all(failure);
  if (status == kSuccess) {
    report_errors([&] { status = run(*job); },
                  [](const Failure& it) {
                    print(it);
                    MPI_Abort(MPI_COMM_WORLD, it.status);  // the others wait for this rank
                    std::abort();
                  });
  }
  MPI_Finalize();
  return status;
}
