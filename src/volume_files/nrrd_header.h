// SPDX-License-Identifier: Apache-2.0
// The header of a NRRD file. https://teem.sourceforge.net/nrrd/format.html
//
// Teem, which ITK uses, is not used: it opens the data files even to read only the header, aborts
// the process if a long line does not fit into its messages, and drops fields that it does not
// know. ITK selects by the file's extension and, of the three spaces that it converts, takes LAS
// for RPS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas::detail::io {

/// The lines of a header.
struct NrrdHeader {
  std::map<std::string, std::string, std::less<>> fields =
      {};  ///< by name, lower case without blanks: "spacedirections"
  std::map<std::string, std::string, std::less<>> key_values = {};  ///< the key:=value lines
  std::vector<std::string> listed_files = {};    ///< the lines after "data file: LIST"
  std::vector<std::string> unknown_fields = {};  ///< names as they are written
  std::uint64_t bytes = 0;                       ///< size of the header; the samples may follow
  bool is_gzipped = false;                       ///< the file as a whole

  std::string_view field(std::string_view name) const;
};

/// @throws Error(bad_file) if a line is not a header line, or a field has two values
NrrdHeader read_nrrd_header(const std::filesystem::path& path);

/// A field that must exist. @param name  its name, also in messages
std::string_view required_field(const NrrdHeader& header, const std::filesystem::path& path,
                                std::string_view name);

/// The attributes of one axis of the array, fastest axis first.
struct NrrdAxis {
  std::size_t size = 0;
  std::string kind = {};       ///< lower case; empty: not stated
  std::string centering = {};  ///< "node", "cell" or empty
  double spacing;              ///< this, `minimum` and `maximum`: NaN if not stated
  double minimum, maximum;
  std::string unit = {};
  std::vector<double> direction =
      {};  ///< in space, from one sample to the next; empty if the axis is not in space
};

/// The space in which the array lies.
struct NrrdSpace {
  std::string name = {};            ///< as in the file; empty: not stated
  std::size_t dimension = 0;        ///< 0 if there is no space
  std::vector<double> origin = {};  ///< position of the first sample; empty: not stated
  std::vector<std::string> units = {};
};

std::vector<NrrdAxis> nrrd_axes(const NrrdHeader& header, const std::filesystem::path& path);
NrrdSpace nrrd_space(const NrrdHeader& header, const std::filesystem::path& path);
SampleType nrrd_sample_type(const NrrdHeader& header, const std::filesystem::path& path);

enum class NrrdWorld { body, scanner, right_handed, left_handed };

/// A space that NRRD defines.
struct NrrdSpaceName {
  std::string_view
      spellings;  ///< separated by blanks, in lower case, without blanks and hyphens inside
  std::size_t dimension;
  NrrdWorld world;
  int x_to_lps, y_to_lps;  ///< 1 or -1
};

/// @throws Error(unsupported) if there is no space with this name
const NrrdSpaceName& nrrd_space_named(const std::filesystem::path& path, std::string_view name);

}  // namespace isoatlas::detail::io
