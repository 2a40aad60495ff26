// SPDX-License-Identifier: Apache-2.0
// The header of a NRRD file. https://teem.sourceforge.net/nrrd/format.html
//
// Read here and not by Teem (which ITK uses): Teem opens the data files to read the header alone,
// aborts the process if a long line does not fit into its messages, and keeps nothing of fields it
// does not know; ITK looks at the file's extension, and at the three spaces that it converts it
// takes LAS for RPS.
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
  std::uint64_t bytes = 0;                       ///< of the header; the samples may follow
  bool is_gzipped = false;                       ///< the file as a whole

  std::string_view field(std::string_view name) const;
};

/// @throws Error(bad_file) if there is a line that is none of a header, or a field has two values
NrrdHeader read_nrrd_header(const std::filesystem::path& path);

/// The field, which has to be there. @param spelled  its name in messages
std::string_view required_field(const NrrdHeader& header, const std::filesystem::path& path,
                                std::string_view name);

/// What the header says of one axis of the array, fastest axis first.
struct NrrdAxis {
  std::size_t size = 0;
  std::string kind = {};       ///< lower case; empty: not stated
  std::string centering = {};  ///< "node", "cell" or empty
  double spacing;              ///< this, `minimum` and `maximum`: NaN if not stated
  double minimum, maximum;
  std::string unit = {};
  std::vector<double> direction =
      {};  ///< in space, from one sample to the next; empty: the axis is not in space
};

/// The space in which the array lies.
struct NrrdSpace {
  std::string name = {};            ///< as in the file; empty: not stated
  std::size_t dimension = 0;        ///< 0: there is none
  std::vector<double> origin = {};  ///< position of the first sample; empty: not stated
  std::vector<std::string> units = {};
};

std::vector<NrrdAxis> nrrd_axes(const NrrdHeader& header, const std::filesystem::path& path);
NrrdSpace nrrd_space(const NrrdHeader& header, const std::filesystem::path& path);
SampleType nrrd_sample_type(const NrrdHeader& header, const std::filesystem::path& path);

enum class NrrdWorld { body, scanner, right_handed, left_handed };

/// A space that NRRD has a name for.
struct NrrdSpaceName {
  std::string_view spellings;  ///< a word each, lower case, without blanks and hyphens
  std::size_t dimension;
  NrrdWorld world;
  int x_to_lps, y_to_lps;  ///< 1 or -1
};

/// @throws Error(unsupported) if there is no space of this name
const NrrdSpaceName& nrrd_space_named(const std::filesystem::path& path, std::string_view name);

}  // namespace isoatlas::detail::io
