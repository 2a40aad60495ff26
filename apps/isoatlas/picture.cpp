// SPDX-License-Identifier: Apache-2.0
// isoatlas picture: draws a mesh into an image file.
#include "picture/picture.h"

#include <iostream>
#include <string>

#include "commands.h"
#include "exit_status.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "outputs/output_files.h"
#include "text.h"

namespace isoatlas::detail::tool {

namespace fs = std::filesystem;

namespace {

TriangleMesh read_level(const fs::path& path, const std::optional<std::size_t>& level) {
  const Hierarchy hierarchy = read_levels(path).hierarchy;
  const std::size_t last = hierarchy.levels.size() - 1;
  if (level.value_or(0) > last) {
    const std::string found = last == 0 ? "one level" : "levels 0 to " + std::to_string(last);
    throw Error(ErrorCode::bad_argument,
                path.string() + ": has " + found + " and no level " + std::to_string(*level));
  }
  return hierarchy.mesh(level.value_or(last));
}

}  // namespace

int run_picture(const PictureArguments& arguments, Interruption& interruption) {
  PictureOptions options = arguments.options;
  if (same_file(arguments.mesh, arguments.picture))
    throw Error(ErrorCode::bad_argument,
                arguments.picture.string() + ": the picture would replace the mesh");
  options.format = picture_format(arguments.picture);
  check_output_path(arguments.picture);
  OutputFiles outputs;
  const Interruption::Cleanup clean_up(interruption, [&] { outputs.discard(); });
  const TriangleMesh mesh = read_level(arguments.mesh, arguments.level);
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
