// SPDX-License-Identifier: Apache-2.0
#include "view/page_options.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "file_kinds.h"
#include "isoatlas/error.h"
#include "text.h"
#include "typing_help.h"
#include "wording/values.h"

namespace isoatlas::detail::tool {
namespace {

/// All of these are texts, numbers or points; none names a file.
constexpr std::array<std::string_view, 33> kSettable{"iso",
                                                     "inside",
                                                     "nan",
                                                     "topology",
                                                     "interpolation",
                                                     "supersample",
                                                     "adaptive-supersample",
                                                     "min-component-size",
                                                     "keep-components",
                                                     "keep-near",
                                                     "drop-near",
                                                     "coarse",
                                                     "max-radius",
                                                     "covering",
                                                     "event-persistence",
                                                     "border",
                                                     "placement",
                                                     "allow-self-intersections",
                                                     "levels",
                                                     "refine",
                                                     "max-distance",
                                                     "mean-distance",
                                                     "area-curvature",
                                                     "area-curvature-smooth",
                                                     "geodesic-ratio",
                                                     "normal-angle",
                                                     "max-vertices",
                                                     "min-vertices",
                                                     "min-edge",
                                                     "max-edge",
                                                     "min-aspect",
                                                     "space",
                                                     "roi"};

constexpr std::array<std::string_view, 8> kFormats{"ply", "stl", "3mf", "glb",
                                                   "obj", "off", "vtp", "gii"};

/// The region of a page in samples of the file.
std::string region_in_file(const std::string& text, const ReadOptions& read) {
  if (!read.region) return text;
  ReadOptions parsed;
  set(parsed, "roi", text);
  std::string out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t first = read.region->first[axis], last = read.region->last[axis];
    const std::size_t page_last = parsed.region->last[axis];
    const std::size_t end = page_last == Region::kEnd ? last : first + page_last;
    out += (axis == 0 ? "" : ",") + std::to_string(first + parsed.region->first[axis]) + ":" +
           (end == Region::kEnd ? "" : std::to_string(end));
  }
  return out;
}

bool is_flag(std::string_view name) {
  return name == "coarse" || name == "allow-self-intersections";
}

/// A path that is not taken for an option.
std::string as_operand(const std::string& path) {
  return path.starts_with("-") ? "./" + path : path;
}

}  // namespace

std::vector<std::string> extract_words(const ViewArguments& opened, const PageOptions& options,
                                       const std::string& output) {
  std::vector<std::string> words{"extract", as_operand(opened.volume.path.string())};
  bool has_region = false;
  for (const auto& [name, value] : options) {
    if (std::ranges::find(kSettable, name) == kSettable.end())
      throw Error(ErrorCode::bad_argument, "'" + name + "' is not an option that a page can set");
    has_region = has_region || name == "roi";
    words.push_back("--" + name);
    if (is_flag(name)) continue;
    // A value that begins with a dash would be taken for an option.
    const std::string text = name == "roi" ? region_in_file(value, opened.volume.read) : value;
    if (text.starts_with("-"))
      words.back() += "=" + text;
    else
      words.push_back(text);
  }
  for (std::size_t i = 0; i + 1 < opened.reading.size(); i += 2) {
    if (has_region && opened.reading[i] == "--roi") continue;
    words.insert(words.end(), {opened.reading[i], opened.reading[i + 1]});
  }
  words.insert(words.end(), {"-o", as_operand(output)});
  return words;
}

std::optional<Region> region_of(const PageOptions& options, const Size3& size) {
  ReadOptions read;
  for (const auto& [name, value] : options) {
    if (name != "roi") continue;
    set(read, name, value);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t first = read.region->first[axis],
                        last = std::min(read.region->last[axis], size[axis] - 1);
      const bool is_outside =
          read.region->last[axis] != Region::kEnd && read.region->last[axis] >= size[axis];
      if (is_outside || first >= last)
        throw Error(ErrorCode::bad_argument,
                    "roi: expected two or more samples along each axis of " + size_text(size) +
                        ", got " + value);
    }
  }
  return read.region;
}

ExtractArguments parse_extract(std::vector<std::string> words) {
  CLI::App app;
  describe_tool(app);
  ExtractArguments arguments;
  add_extract_command(app, arguments);
  if (const std::string mistake = find_mistake(app, words); !mistake.empty())
    throw Error(ErrorCode::bad_argument, mistake);
  try {
    std::reverse(words.begin(), words.end());  // the order that CLI11 expects
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorCode::bad_argument, error.what());
  }
  return arguments;
}

std::string mesh_name(const ViewArguments& opened, const std::string& format) {
  if (std::ranges::find(kFormats, format) == kFormats.end())
    refuse_value("one of ply, stl, 3mf, glb, obj, off, vtp, gii", format);
  const std::string name = name_without_extensions(opened.volume.path);
  return (name.empty() ? "mesh" : name) + "." + format;  // no name: a folder with a slash
}

}  // namespace isoatlas::detail::tool
