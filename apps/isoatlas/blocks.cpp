// SPDX-License-Identifier: Apache-2.0
// isoatlas blocks plan, run and merge: a volume that is meshed block by block, by several runs.
#include "blocks.h"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "block_parts.h"
#include "commands.h"
#include "exit_status.h"
#include "files/file_error.h"
#include "isoatlas/error.h"
#include "isoatlas/text_file.h"
#include "isoatlas/version.h"
#include "progress_bar.h"
#include "text.h"
#include "volume_input.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "isoatlas-blocks-1";
constexpr std::uint64_t kDefaultMemory = std::uint64_t{4} << 30;

fs::path plan_path(const fs::path& folder) { return folder / "plan.json"; }

/// The folder of the plan, and the command line of `extract` that was typed there.
struct Plan {
  fs::path working_folder;
  std::vector<std::string> words;
};

Plan read_plan(const fs::path& folder) {
  const fs::path path = plan_path(folder);
  if (!fs::exists(path))
    throw Error(ErrorCode::bad_file,
                folder.string() + ": has no plan.json; make it with `isoatlas blocks plan`");
  try {
    const Json json = Json::parse(io::file_contents(path));
    if (json.at("schema") != kSchema) throw Error(ErrorCode::bad_file, "");
    if (json.at("version") != ISOATLAS_VERSION)
      throw Error(ErrorCode::bad_argument, path.string() + ": was made by isoatlas " +
                                               json.at("version").get<std::string>() +
                                               ", expected " ISOATLAS_VERSION "; make it again");
    return {json.at("working_folder").get<std::string>(),
            json.at("arguments").get<std::vector<std::string>>()};
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bad_argument) throw;
  } catch (const Json::exception&) {
  }
  throw Error(ErrorCode::bad_file,
              path.string() + ": is not a plan; make it with `isoatlas blocks plan`");
}

std::string size_text(const Size3& size) {
  return count_text(size[0]) + " x " + count_text(size[1]) + " x " + count_text(size[2]);
}

}  // namespace

ExtractArguments planned_arguments(const fs::path& folder) {
  const Plan plan = read_plan(folder);
  ExtractArguments arguments;
  CLI::App app;
  add_extract_command(app, arguments);
  std::vector<std::string> words(plan.words.rbegin(), plan.words.rend());
  words.emplace_back("extract");
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorCode::bad_file, plan_path(folder).string() + ": " + error.what());
  }
  arguments.parts = fs::absolute(folder);
  std::error_code error;
  fs::current_path(plan.working_folder, error);
  if (error)
    throw Error(ErrorCode::bad_file, plan_path(folder).string() + ": its folder " +
                                         plan.working_folder.string() +
                                         " cannot be entered: " + error.message());
  return arguments;
}

Size3 block_size_of(const ExtractArguments& arguments, const VolumeReader& volume) {
  if (arguments.block_size) return *arguments.block_size;
  return block_size_for(volume.grid(), volume.type(), arguments.memory.value_or(kDefaultMemory));
}

std::string blocks_text(const std::vector<std::size_t>& blocks) {
  constexpr std::size_t kMostListed = 3;
  std::string text = blocks.size() == 1 ? "block " : "blocks ";
  const std::size_t listed = std::min(blocks.size(), kMostListed);
  for (std::size_t i = 0; i < listed; ++i) {
    const bool is_last = i + 1 == blocks.size();
    text += (i == 0 ? "" : is_last ? " and " : ", ") + std::to_string(blocks[i]);
  }
  if (blocks.size() > listed) text += " and " + std::to_string(blocks.size() - listed) + " more";
  return text;
}

void require_no_labels(const ExtractArguments& arguments) {
  if (!arguments.labels.empty())
    throw Error(ErrorCode::unsupported, "--label needs the whole volume in memory, not blocks");
}

int run_blocks_plan(const ExtractArguments& arguments, const std::vector<std::string>& words) {
  require_no_labels(arguments);
  const VolumeReader volume = open_volume_input(arguments.volume.path, arguments.volume.read);
  const BlockPlan plan(volume.grid(), block_size_of(arguments, volume));
  const BlockParts parts(*arguments.parts, plan);
  const fs::path path = plan_path(*arguments.parts);
  Json json = {{"schema", kSchema},
               {"version", ISOATLAS_VERSION},
               {"working_folder", fs::current_path().string()},
               {"arguments", words},
               {"size", plan.grid().size},
               {"block_size", plan.block_size()},
               {"counts", plan.counts()},
               {"blocks", plan.block_count()}};
  const std::string text = json.dump(2) + "\n";
  if (fs::exists(path) && io::file_contents(path) != text)
    throw Error(ErrorCode::bad_argument,
                path.string() + ": is the plan of another run; give a new folder, or delete it");
  write_text_file(text, path);
  if (!arguments.quiet)
    std::cout << counted(plan.block_count(), "block") << " of up to "
              << size_text(plan.block_size()) << " grid cells. Next:\n"
              << "  isoatlas blocks run " << arguments.parts->string() << "\n"
              << "  isoatlas blocks merge " << arguments.parts->string() << "\n";
  return kSuccess;
}

int run_blocks_run(const BlocksArguments& arguments, Interruption& interruption) {
  const ExtractArguments planned = planned_arguments(arguments.folder);
  ProgressBar progress(!arguments.quiet);
  const Interruption::Cleanup clean_up(interruption, [&] { progress.erase(); });
  interruption.set_message(kBlocksAreKept);
  const RunControl control{
      .progress = [&](std::string_view stage, double fraction) { progress.show(stage, fraction); },
      .cancel = &interruption.requested(),
      .threads = arguments.threads > 0 ? arguments.threads : planned.threads};
  const VolumeReader volume = open_volume_input(planned.volume.path, planned.volume.read);
  const BlockPlan plan(volume.grid(), block_size_of(planned, volume));
  if (arguments.range.first >= plan.block_count())
    throw Error(ErrorCode::bad_argument, "--blocks: the plan has the blocks 0 to " +
                                             std::to_string(plan.block_count() - 1) + ", found " +
                                             std::to_string(arguments.range.first));
  const BlockParts parts(*planned.parts, plan);
  const std::vector<std::size_t> elsewhere =
      parts.make(volume, in_world(planned, volume.grid()), arguments.range, control);
  progress.finish();
  if (arguments.quiet) return kSuccess;
  const std::size_t missing = parts.missing().size();
  std::cout << count_text(plan.block_count() - missing) << " of "
            << counted(plan.block_count(), "block") << " made";
  if (!elsewhere.empty()) std::cout << "; another run is making " << blocks_text(elsewhere);
  std::cout << "\n";
  return kSuccess;
}

int run_blocks_merge(const BlocksArguments& arguments, Interruption& interruption) {
  ExtractArguments planned = planned_arguments(arguments.folder);
  planned.only_merges = true;
  planned.quiet = planned.quiet || arguments.quiet;
  planned.verbose = planned.verbose || arguments.verbose;
  if (arguments.threads > 0) planned.threads = arguments.threads;
  return run_extract(planned, interruption);
}

}  // namespace isoatlas::detail::tool
