// SPDX-License-Identifier: Apache-2.0
#include "volume_files/volume_format.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>

#include "files/file_error.h"
#include "files/stored_data.h"

namespace isoatlas::io {

namespace fs = std::filesystem;

namespace {

bool has_at(std::string_view bytes, std::size_t position, std::string_view mark) {
  return bytes.size() >= position + mark.size() && bytes.substr(position, mark.size()) == mark;
}

bool is_nrrd(std::string_view bytes) { return has_at(bytes, 0, "NRRD000"); }

// The size of the header, as a number of either byte order, is at its start: 348, or 540 in NIfTI-2. Analyze has no mark.
bool is_nifti(std::string_view bytes) {
  for (const std::string_view size : {std::string_view("\x5C\x01\0\0", 4), std::string_view("\0\0\x01\x5C", 4)}) {
    if (has_at(bytes, 0, size) && bytes.size() >= 348) {
      return true;
    }
  }
  return has_at(bytes, 4, "n+2") || has_at(bytes, 4, "ni2");
}

bool is_meta_image(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 1024);
  return start.find("NDims") != std::string_view::npos && start.find('=') != std::string_view::npos &&
         (start.starts_with("ObjectType") || start.starts_with("NDims") || start.starts_with("Comment"));
}

bool is_tiff(std::string_view bytes) {
  return has_at(bytes, 0, std::string_view("II*\0", 4)) || has_at(bytes, 0, std::string_view("MM\0*", 4)) ||
         has_at(bytes, 0, std::string_view("II+\0", 4)) || has_at(bytes, 0, std::string_view("MM\0+", 4));
}

bool is_legacy_vtk(std::string_view bytes) { return has_at(bytes, 0, "# vtk DataFile"); }

// Any data set: the reader says what it is where it is no volume.
bool is_vtk_xml(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string_view::npos && bytes[first] == '<' && bytes.find("<VTKFile") != std::string_view::npos;
}

constexpr std::array kVolumeFormats{
    VolumeFormat{"NRRD", ".nrrd .nhdr", is_nrrd, read_nrrd},
    VolumeFormat{"NIfTI", ".nii .nii.gz .hdr .img", is_nifti, read_nifti},
    VolumeFormat{"MetaImage", ".mha .mhd", is_meta_image, read_meta_image},
    VolumeFormat{"TIFF", ".tif .tiff", is_tiff, read_tiff},
    VolumeFormat{"legacy VTK", ".vtk", is_legacy_vtk, read_legacy_vtk},
    VolumeFormat{"VTK XML", ".vti .vtr .pvti .pvtr", is_vtk_xml, read_vtk_xml},
};

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool has_extension(const std::string& file_name, std::string_view extensions) {
  while (!extensions.empty()) {
    const std::string_view extension = extensions.substr(0, extensions.find(' '));
    if (file_name.ends_with(extension)) {
      return true;
    }
    extensions.remove_prefix(std::min(extension.size() + 1, extensions.size()));
  }
  return false;
}

// What a file is that no reader is for; empty if that is not known either.
std::string other_kind(std::string_view bytes, const std::string& file_name) {
  if (has_extension(file_name, ".ply .stl .obj .off .vtp .glb .vtm .3mf .gii")) return "is a mesh file";
  if (has_extension(file_name, ".json")) return "is a JSON file, perhaps a report";
  if (has_extension(file_name, ".vtkhdf")) return "is a VTKHDF file";
  if (has_at(bytes, 0, "\x89HDF")) return "is an HDF5 file";
  if (has_at(bytes, 0, "CDF")) return "is a NetCDF file";
  if (has_at(bytes, 0, "PK\x03\x04")) return "is a ZIP archive";
  if (has_at(bytes, 0, "ZISRAWFILE")) return "is a Zeiss CZI file";
  if (has_at(bytes, 0, "\xDA\xCE\xBE\x0A")) return "is a Nikon ND2 file";
  if (has_at(bytes, 0, "\xFF\xD8\xFF")) return "is a JPEG image";
  if (has_at(bytes, 0, "\x89PNG")) return "is a single PNG image";
  if (has_at(bytes, 0, "%PDF")) return "is a PDF document";
  return "";
}

}  // namespace

const VolumeFormat& format_of(const fs::path& path) {
  constexpr std::size_t kStart = 4096;
  const std::string start = first_bytes(path, kStart);
  for (const VolumeFormat& format : kVolumeFormats) {
    if (format.has_mark != nullptr && format.has_mark(start)) {
      return format;
    }
  }
  const std::string file_name = lower_case(path.filename().string());
  for (const VolumeFormat& format : kVolumeFormats) {
    if (has_extension(file_name, format.extensions)) {
      return format;
    }
  }
  const std::string kind = other_kind(start, file_name);
  throw unsupported(path, (kind.empty() ? "unknown volume format" : kind) + ", expected a volume: one of " + volume_extensions() +
                              ", a folder with a DICOM series, or a raw layout (size and sample type)");
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

}  // namespace isoatlas::io
