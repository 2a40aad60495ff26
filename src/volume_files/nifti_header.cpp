// SPDX-License-Identifier: Apache-2.0
#include "volume_files/nifti_header.h"

// The structures of the format's authors. Their library is not used: it writes to standard error,
// repairs a header silently, reads NaN as 0, and exports functions with the names of other
// functions in ITK's copy of the library.
#define DONT_INCLUDE_ANALYZE_STRUCT
#include <nifti/nifti1.h>
#include <nifti/nifti2.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "files/file_error.h"
#include "volume_files/stored_volumes.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

static_assert(sizeof(nifti_1_header) == 348 && sizeof(nifti_2_header) == 540);

template <class Value>
Value swapped(Value value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(Value)>>(value);
  std::ranges::reverse(bytes);
  return std::bit_cast<Value>(bytes);
}

// Both versions have the same fields, at other offsets and with other widths.
template <class Stored>
NiftiHeader decoded(const Stored& stored, bool swap, NiftiVersion version) {
  const auto value = [&](auto field) { return swap ? swapped(field) : field; };
  NiftiHeader header;
  header.version = version;
  header.swap = swap;
  for (std::size_t i = 0; i < 8; ++i) {
    header.dim[i] = value(stored.dim[i]);
    header.pixdim[i] = value(stored.pixdim[i]);
  }
  header.datatype = value(stored.datatype);
  header.bitpix = value(stored.bitpix);
  header.vox_offset = static_cast<double>(value(stored.vox_offset));
  header.scl_slope = value(stored.scl_slope);
  header.scl_inter = value(stored.scl_inter);
  if (version == NiftiVersion::analyze) {
    header.scl_inter = 0;  // Analyze has another field there, and none of the following fields
    return header;
  }
  header.is_one_file = stored.magic[1] == '+';
  header.qform_code = value(stored.qform_code);
  header.sform_code = value(stored.sform_code);
  header.quatern = {value(stored.quatern_b), value(stored.quatern_c), value(stored.quatern_d)};
  header.qoffset = {value(stored.qoffset_x), value(stored.qoffset_y), value(stored.qoffset_z)};
  for (std::size_t i = 0; i < 4; ++i) {
    header.srow[0][i] = value(stored.srow_x[i]);
    header.srow[1][i] = value(stored.srow_y[i]);
    header.srow[2][i] = value(stored.srow_z[i]);
  }
  header.xyzt_units = value(stored.xyzt_units);
  header.intent_code = value(stored.intent_code);
  return header;
}

template <class Stored>
Stored structure_in(const std::string& bytes) {
  Stored stored;
  std::memcpy(&stored, bytes.data(), sizeof stored);
  return stored;
}

void require_unchanged_magic(const nifti_2_header& stored, const fs::path& file) {
  constexpr std::string_view kEnd("\0\r\n\x1A\n", 5);
  const std::string_view magic(stored.magic, 8);
  if ((!magic.starts_with("n+2") && !magic.starts_with("ni2")) || magic.substr(3) != kEnd) {
    throw bad_file(file,
                   "is not a NIfTI-2 file, or was damaged by a transfer as text: its magic is '" +
                       one_line(magic) + "'");
  }
}

NiftiHeader decoded(const std::string& bytes, const fs::path& file) {
  const std::string_view cut_off = "is not a NIfTI file, or its header is cut off or damaged";
  if (bytes.size() < sizeof(nifti_1_header)) throw bad_file(file, cut_off);
  const auto stored = structure_in<nifti_1_header>(bytes);
  for (const bool swap : {false, true}) {
    const int header_bytes = swap ? swapped(stored.sizeof_hdr) : stored.sizeof_hdr;
    if (header_bytes == sizeof(nifti_1_header)) {
      const std::string_view magic(stored.magic, 4);
      const bool is_nifti =
          magic == std::string_view("n+1\0", 4) || magic == std::string_view("ni1\0", 4);
      return decoded(stored, swap, is_nifti ? NiftiVersion::nifti1 : NiftiVersion::analyze);
    }
    if (header_bytes == sizeof(nifti_2_header)) {
      if (bytes.size() < sizeof(nifti_2_header)) throw bad_file(file, cut_off);
      const auto stored2 = structure_in<nifti_2_header>(bytes);
      require_unchanged_magic(stored2, file);
      return decoded(stored2, swap, NiftiVersion::nifti2);
    }
  }
  throw bad_file(file, "is not a NIfTI file: expected 348 or 540 as its first number");
}

}  // namespace

NiftiHeader read_nifti_header(const fs::path& header_file) {
  NiftiHeader header = decoded(unpacked_start(header_file, sizeof(nifti_2_header)), header_file);
  constexpr int kFirstCiftiIntent = 3000,
                kLastCiftiIntent = 3099;  // connectivity: a NIfTI-2 file with an XML extension
  if (header.intent_code >= kFirstCiftiIntent && header.intent_code <= kLastCiftiIntent) {
    throw unsupported(header_file,
                      "is a CIFTI file (intent " + std::to_string(header.intent_code) +
                          "): a table of values at points of a brain's surface, expected a volume");
  }
  const std::int64_t dimensions = header.dim[0];
  if (dimensions < 1 || dimensions > 7) {
    throw bad_file(header_file, "has " + std::to_string(dimensions) + " dimensions, expected 3");
  }
  for (std::size_t axis = 1; axis <= static_cast<std::size_t>(dimensions); ++axis) {
    if (header.dim[axis] < 1) {
      throw bad_file(header_file, "has " + std::to_string(header.dim[axis]) +
                                      " samples along axis " + std::to_string(axis) +
                                      ", expected at least 1");
    }
  }
  std::fill(header.dim.begin() + dimensions + 1, header.dim.end(),
            1);  // unused entries have no meaning
  return header;
}

}  // namespace isoatlas::detail::io
