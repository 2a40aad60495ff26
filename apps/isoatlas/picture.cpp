// SPDX-License-Identifier: Apache-2.0
// isoatlas picture: draws a mesh into an image file.
#include "picture/picture.h"

#include <iostream>
#include <string>

#include "commands.h"
#include "core/file_name.h"
#include "exit_status.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "outputs/output_files.h"
#include "text.h"

namespace isoatlas::detail::tool {

namespace fs = std::filesystem;

namespace {

TriangleMesh level_of(const Hierarchy& hierarchy, const fs::path& path,
                      const std::optional<std::size_t>& level) {
  const std::size_t last = hierarchy.levels.size() - 1;
  if (level.value_or(0) > last) {
    const std::string found = last == 0 ? "one level" : "levels 0 to " + std::to_string(last);
    throw Error(ErrorCode::bad_argument,
                path.string() + ": has " + found + " and no level " + std::to_string(*level));
  }
  return hierarchy.mesh(level.value_or(last));
}

/// The options for a mesh in `space`. In RAS the front of a patient is at y, in LPS at -y.
PictureOptions options_in(const std::string& space, const PictureArguments& arguments) {
  PictureOptions options = arguments.options;
  if (lower_case(space) != "ras") return options;
  options.front = {0, 1, 0};
  if (arguments.view_is_in_lps) options.view = {-options.view.x, -options.view.y, options.view.z};
  return options;
}

}  // namespace

int run_picture(const PictureArguments& arguments, Interruption& interruption) {
  if (same_file(arguments.mesh, arguments.picture))
    throw Error(ErrorCode::bad_argument,
                arguments.picture.string() + ": the picture would replace the mesh");
  const PictureFormat format = picture_format(arguments.picture);
  check_output_path(arguments.picture);
  require_pictures();
  OutputFiles outputs;
  const Interruption::Cleanup clean_up(interruption, [&] { outputs.discard(); });
  const HierarchyFile file = read_levels(arguments.mesh);
  const TriangleMesh mesh = level_of(file.hierarchy, arguments.mesh, arguments.level);
  PictureOptions options = options_in(file.info.mesh.space, arguments);
  options.format = format;
  const std::string picture = picture_of(mesh, options);
  outputs.write(arguments.picture,
                [&](const fs::path& staged) { write_text_file(picture, staged); });
  interruption.commit([&] { outputs.commit(); });
  if (!arguments.quiet)
    std::cout << row("wrote", arguments.picture.string() + ": " +
                                  count_text(mesh.triangles.size()) + " triangles, " +
                                  bytes_text(static_cast<double>(picture.size())));
  return kSuccess;
}

}  // namespace isoatlas::detail::tool
