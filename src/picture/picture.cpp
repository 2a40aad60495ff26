// SPDX-License-Identifier: Apache-2.0
#include "picture/picture.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "core/file_name.h"
#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "picture/picture_module.h"

namespace isoatlas::detail {
namespace {

namespace fs = std::filesystem;

/// The path of isoatlas_picture.so, which has a fixed place relative to the running program.
fs::path module_path() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error)
    throw Error(ErrorCode::unsupported,
                "pictures are drawn by a library next to this program, and /proc/self/exe does not "
                "name the program: mount /proc");
  return (program.parent_path() / ISOATLAS_TOOL_TO_MODULES / "isoatlas_picture.so")
      .lexically_normal();
}

const PictureModule& load_module() {
  const fs::path path = module_path();
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    throw Error(ErrorCode::unsupported,
                path.string() +
                    ": this library draws pictures, and it is missing: install "
                    "isoatlas as a whole, not only the program");
  // Never closed: VTK and OpenGL drivers register functions that run when the program exits.
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const reason = dlerror();
    throw Error(ErrorCode::unsupported,
                "pictures need OpenGL and X11, and a library cannot be loaded (" +
                    std::string(reason == nullptr ? path.string() : reason) +
                    "): install them (Debian: libopengl0 libgl1 libgl1-mesa-dri libx11-6 xvfb)");
  }
  const auto* const module = static_cast<const PictureModule*>(dlsym(library, kPictureModule));
  if (module == nullptr || std::string(module->version) != ISOATLAS_VERSION)
    throw Error(ErrorCode::unsupported, path.string() +
                                            ": belongs to another version of isoatlas, expected " +
                                            ISOATLAS_VERSION + ": install isoatlas again");
  return *module;
}

const PictureModule& picture_module() {
  static const PictureModule& module = load_module();
  return module;
}

}  // namespace

void require_pictures() { picture_module(); }

PictureFormat picture_format(const fs::path& path) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".png") return PictureFormat::png;
  if (extension == ".jpg" || extension == ".jpeg") return PictureFormat::jpeg;
  throw Error(
      ErrorCode::unsupported,
      path.string() + ": unknown picture format, expected a name ending in .png, .jpg or .jpeg");
}

std::string picture_of(const TriangleMesh& mesh, const PictureOptions& options) {
  DrawnPicture result;
  picture_module().draw(mesh, options, result);
  if (result.error) throw Error(*result.error);
  return std::move(result.bytes);
}

}  // namespace isoatlas::detail
