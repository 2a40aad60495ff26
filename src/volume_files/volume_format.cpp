// SPDX-License-Identifier: Apache-2.0
#include "volume_files/volume_format.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "core/file_name.h"
#include "files/byte_source.h"
#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

bool has_at(std::string_view bytes, std::size_t position, std::string_view mark) {
  return bytes.size() >= position + mark.size() && bytes.substr(position, mark.size()) == mark;
}

bool is_nrrd(std::string_view bytes) { return has_at(bytes, 0, "NRRD00"); }

// The header begins with its size, in either byte order: 348, or 540 in NIfTI-2. Analyze has no
// other identification.
bool is_nifti(std::string_view bytes) {
  for (const std::string_view size :
       {std::string_view("\x5C\x01\0\0", 4), std::string_view("\0\0\x01\x5C", 4)}) {
    if (has_at(bytes, 0, size) && bytes.size() >= 348) {
      return true;
    }
  }
  return has_at(bytes, 4, "n+2") || has_at(bytes, 4, "ni2");
}

bool is_meta_image(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 1024);
  return start.find("NDims") != std::string_view::npos &&
         start.find('=') != std::string_view::npos &&
         (start.starts_with("ObjectType") || start.starts_with("NDims") ||
          start.starts_with("Comment"));
}

bool is_tiff(std::string_view bytes) {
  return has_at(bytes, 0, std::string_view("II*\0", 4)) ||
         has_at(bytes, 0, std::string_view("MM\0*", 4)) ||
         has_at(bytes, 0, std::string_view("II+\0", 4)) ||
         has_at(bytes, 0, std::string_view("MM\0+", 4));
}

bool is_legacy_vtk(std::string_view bytes) { return has_at(bytes, 0, "# vtk DataFile"); }

// Accepts any data set: the reader names the kind of data set if it is not a volume.
bool is_vtk_xml(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string_view::npos && bytes[first] == '<' &&
         bytes.find("<VTKFile") != std::string_view::npos;
}

// MGH begins with the version, whose second byte may state more, four sizes and a type, big-endian:
// most of their upper bytes are 0.
bool is_mgh(std::string_view bytes) {
  if (bytes.size() < 30 || bytes[0] != 0 || bytes[1] != 0 || bytes[3] != 1) return false;
  for (std::size_t field = 4; field < 20; field += 4) {
    const std::string_view size = bytes.substr(field, 4);
    if (size[0] != 0 || size == std::string_view("\0\0\0\0", 4)) return false;
  }
  constexpr char kLargestType = 10;
  return bytes.substr(20, 3) == std::string_view("\0\0\0", 3) && bytes[23] >= 0 &&
         bytes[23] <= kLargestType;
}

bool is_mrc(std::string_view bytes) { return bytes.size() >= 1024 && has_at(bytes, 208, "MAP"); }

bool is_npy(std::string_view bytes) { return has_at(bytes, 0, "\x93NUMPY"); }
bool has_hdf5_mark(std::string_view bytes) { return has_at(bytes, 0, "\x89HDF\r\n\x1a\n"); }
bool is_dicom(std::string_view bytes) { return has_at(bytes, 128, "DICM"); }

VolumeFile read_whole_hdf5(const fs::path& path, const ReadOptions& options) {
  return read_hdf5(path, options, true);
}

constexpr std::array kVolumeFormats{
    VolumeFormat{"DICOM", ".dcm .ima", is_dicom, read_dicom, false},
    VolumeFormat{"NRRD", ".nrrd .nhdr", is_nrrd, read_nrrd},
    VolumeFormat{"NIfTI", ".nii .nii.gz .nii.bz2 .hdr .img .img.gz", is_nifti, read_nifti},
    VolumeFormat{"MGH", ".mgz .mgh .mgh.gz", is_mgh, read_mgh},
    VolumeFormat{"MRC", ".mrc .map .rec .ccp4 .st .mrcs .mrc.gz .map.gz", is_mrc, read_mrc},
    VolumeFormat{"NumPy array", ".npy", is_npy, read_npy},
    VolumeFormat{"MetaImage", ".mha .mhd", is_meta_image, read_meta_image},
    VolumeFormat{"TIFF", ".tif .tiff", is_tiff, read_tiff, false},
    VolumeFormat{"legacy VTK", ".vtk", is_legacy_vtk, read_legacy_vtk},
    VolumeFormat{"HDF5", ".h5 .hdf5 .ims", has_hdf5_mark, read_whole_hdf5, false},
    VolumeFormat{"VTK XML", ".vti .vtr .pvti .pvtr", is_vtk_xml, read_vtk_xml},
};

// The kind of a file for which there is no reader; empty if it is not known either.
std::string other_kind(std::string_view bytes, const fs::path& path) {
  if (has_extension(path, ".ply .stl .obj .off .vtp .glb .vtm .3mf .gii")) return "is a mesh file";
  if (has_extension(path, ".json")) return "is a JSON file, perhaps a report";
  if (has_extension(path, ".vtkhdf")) return "is a VTKHDF file";
  if (has_at(bytes, 0, "CDF")) return "is a NetCDF file";
  if (has_extension(path, ".npz"))
    return "is an archive of NumPy arrays (numpy.save writes one array as .npy)";
  if (has_at(bytes, 0, "PK\x03\x04")) return "is a ZIP archive";
  if (has_at(bytes, 0, "BZh")) return "is compressed by bzip2 (decompress it first: bunzip2)";
  if (has_at(bytes, 0,
             "\xFD"
             "7zXZ"))
    return "is compressed by xz (decompress it first: unxz)";
  if (has_at(bytes, 0, "\x28\xB5\x2F\xFD"))
    return "is compressed by zstandard (decompress it first: unzstd)";
  if (has_at(bytes, 0, "ZISRAWFILE")) return "is a Zeiss CZI file";
  if (has_at(bytes, 0, "\xDA\xCE\xBE\x0A")) return "is a Nikon ND2 file";
  if (has_at(bytes, 0, "\xFF\xD8\xFF")) return "is a JPEG image";
  if (has_at(bytes, 0, "\x89PNG")) return "is a 2-D PNG image (give the folder with all slices)";
  if (has_at(bytes, 0, "%PDF")) return "is a PDF document";
  return "";
}

std::string format_names() {
  std::string list;
  for (const VolumeFormat& format : kVolumeFormats) {
    list += (list.empty() ? "" : ", ") + std::string(format.name);
  }
  return list;
}

}  // namespace

const VolumeFormat& format_of(const fs::path& path) {
  constexpr std::size_t kStart = 4096;
  const std::string start = first_bytes(path, kStart);
  const bool is_vtkhdf = has_extension(path, ".vtkhdf");  // other_kind() names it
  for (const VolumeFormat& format : kVolumeFormats) {
    if (format.has_mark != nullptr && format.has_mark(start) && !is_vtkhdf) {
      if (!format.is_read_gzipped && packing_of(path) == Packing::deflate) {
        throw unsupported(path, "is a gzipped " + std::string(format.name) +
                                    " file, expected it decompressed (gunzip)");
      }
      return format;
    }
  }
  for (const VolumeFormat& format : kVolumeFormats) {
    if (has_extension(path, format.extensions)) {
      return format;
    }
  }
  const std::string kind = other_kind(start, path);
  throw unsupported(path, (kind.empty() ? "unknown volume format" : kind) +
                              ", expected a volume: " + format_names() +
                              ", or a folder of Zarr or of DICOM, TIFF or PNG slices");
}

std::string volume_extensions() {
  std::string list;
  for (const VolumeFormat& format : kVolumeFormats) {
    if (!list.empty()) {
      list += ' ';
    }
    list += format.extensions;
  }
  return list;
}

}  // namespace isoatlas::detail::io
