// SPDX-License-Identifier: Apache-2.0
#include "volume_files/hdf5_library.h"

#include <dlfcn.h>

#include <string_view>

#include "files/file_error.h"

namespace isoatlas::detail::io {
namespace {

// Of Debian (serial) from old to new, then of others.
constexpr const char* kLibraryNames[] = {"libhdf5_serial.so.103", "libhdf5_serial.so.310",
                                         "libhdf5.so.103",        "libhdf5.so.200",
                                         "libhdf5.so.310",        "libhdf5.so.320"};

template <class Function>
bool find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

bool load(void* handle, Hdf5Library& to) {
  to.handle = handle;
  return find(handle, "H5open", to.open) && find(handle, "H5get_libversion", to.get_libversion) &&
         find(handle, "H5Eset_auto2", to.set_auto) && find(handle, "H5Ewalk2", to.walk_errors) &&
         find(handle, "H5Fopen", to.open_file) && find(handle, "H5Fclose", to.close_file) &&
         find(handle, "H5Gget_info", to.group_info) &&
         find(handle, "H5Lget_name_by_idx", to.link_name) &&
         find(handle, "H5Gget_objtype_by_idx", to.link_type) &&
         find(handle, "H5Oopen", to.open_object) && find(handle, "H5Oclose", to.close_object) &&
         find(handle, "H5Iget_type", to.object_type) &&
         find(handle, "H5Dget_space", to.dataset_space) &&
         find(handle, "H5Dget_type", to.dataset_type) &&
         find(handle, "H5Dget_create_plist", to.dataset_properties) &&
         find(handle, "H5Dread", to.read) && find(handle, "H5Pget_chunk", to.chunk_size) &&
         find(handle, "H5Pclose", to.close_properties) &&
         find(handle, "H5Screate_simple", to.create_space) &&
         find(handle, "H5Sclose", to.close_space) &&
         find(handle, "H5Sget_simple_extent_ndims", to.axis_count) &&
         find(handle, "H5Sget_simple_extent_dims", to.sizes) &&
         find(handle, "H5Sselect_hyperslab", to.select_box) &&
         find(handle, "H5Tclose", to.close_type) && find(handle, "H5Tget_class", to.type_class) &&
         find(handle, "H5Tget_size", to.type_size) && find(handle, "H5Tget_sign", to.type_sign) &&
         find(handle, "H5Aexists", to.has_attribute) &&
         find(handle, "H5Aopen", to.open_attribute) &&
         find(handle, "H5Aclose", to.close_attribute) &&
         find(handle, "H5Aget_space", to.attribute_space) &&
         find(handle, "H5Aread", to.read_attribute);
}

const Hdf5Library* find_library() {
  static Hdf5Library library;
  static std::mutex mutex;
  for (const char* const name : kLibraryNames) {
    void* const handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) continue;
    if (load(handle, library) && library.open() >= 0) {
      library.set_auto(H5E_DEFAULT, nullptr, nullptr);  // it would print its errors
      library.mutex = &mutex;
      return &library;
    }
    dlclose(handle);
  }
  return nullptr;
}

// The innermost error is the cause, except that the library first searches folders for a missing
// filter.
herr_t keep_cause(unsigned, const H5E_error2_t* error, void* to) {
  std::string& text = *static_cast<std::string*>(to);
  const std::string_view stated = error->desc == nullptr ? "" : error->desc;
  if (text.empty() || stated.starts_with("required filter")) text = stated;
  return 0;
}

}  // namespace

hid_t Hdf5Library::native_type(const char* name) const {
  // A program that links the library may have a copy of this variable, which the library then uses.
  const void* type = dlsym(RTLD_DEFAULT, name);
  if (type == nullptr) type = dlsym(handle, name);
  return type == nullptr ? -1 : *static_cast<const hid_t*>(type);
}

std::string Hdf5Library::version() const {
  unsigned major = 0, minor = 0, release = 0;
  get_libversion(&major, &minor, &release);
  return "HDF5 " + std::to_string(major) + "." + std::to_string(minor) + "." +
         std::to_string(release);
}

std::string Hdf5Library::error_text() const {
  std::string text;
  walk_errors(H5E_DEFAULT, H5E_WALK_UPWARD, keep_cause, &text);
  return text.empty() ? "of no stated cause" : one_line(text);
}

const Hdf5Library& hdf5_library(const std::filesystem::path& path) {
  static const Hdf5Library* const library = find_library();
  if (library == nullptr)
    throw unsupported(path,
                      "is an HDF5 file, for which HDF5's library is missing; install it (Debian: "
                      "libhdf5-103-1), or use h5py with isoatlas.dask in Python");
  return *library;
}

}  // namespace isoatlas::detail::io
