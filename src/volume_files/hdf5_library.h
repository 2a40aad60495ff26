// SPDX-License-Identifier: Apache-2.0
// HDF5's library, loaded when the first file of this format is read: it depends on network
// libraries, which programs that read other files do not need.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

namespace isoatlas::detail::io {

/// Its functions. The library is not safe for threads: take the lock for each use.
struct Hdf5Library {
  decltype(&H5open) open;
  decltype(&H5get_libversion) get_libversion;
  decltype(&H5Eset_auto2) set_auto;
  decltype(&H5Ewalk2) walk_errors;
  decltype(&H5Fopen) open_file;
  decltype(&H5Fclose) close_file;
  decltype(&H5Gget_info) group_info;
  decltype(&H5Lget_name_by_idx) link_name;
  decltype(&H5Gget_objtype_by_idx) link_type;
  decltype(&H5Oopen) open_object;
  decltype(&H5Oclose) close_object;
  decltype(&H5Iget_type) object_type;
  decltype(&H5Dget_space) dataset_space;
  decltype(&H5Dget_type) dataset_type;
  decltype(&H5Dget_create_plist) dataset_properties;
  decltype(&H5Dread) read;
  decltype(&H5Pget_chunk) chunk_size;
  decltype(&H5Pclose) close_properties;
  decltype(&H5Screate_simple) create_space;
  decltype(&H5Sclose) close_space;
  decltype(&H5Sget_simple_extent_ndims) axis_count;
  decltype(&H5Sget_simple_extent_dims) sizes;
  decltype(&H5Sselect_hyperslab) select_box;
  decltype(&H5Tclose) close_type;
  decltype(&H5Tget_class) type_class;
  decltype(&H5Tget_size) type_size;
  decltype(&H5Tget_sign) type_sign;
  decltype(&H5Aexists) has_attribute;
  decltype(&H5Aopen) open_attribute;
  decltype(&H5Aclose) close_attribute;
  decltype(&H5Aget_space) attribute_space;
  decltype(&H5Aread) read_attribute;

  /// The type with this name: "H5T_NATIVE_INT8_g".
  hid_t native_type(const char* name) const;
  /// "HDF5 1.10.8"
  std::string version() const;
  /// The cause of the last error, in the library's words.
  std::string error_text() const;

  void* handle = nullptr;
  std::mutex* mutex = nullptr;
};

/// @throws Error(unsupported) if the library is not installed; it names `path`
const Hdf5Library& hdf5_library(const std::filesystem::path& path);

/// Closes something of the library at its end.
class Hdf5Id {
 public:
  Hdf5Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Id() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Id& operator=(Hdf5Id&&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

}  // namespace isoatlas::detail::io
