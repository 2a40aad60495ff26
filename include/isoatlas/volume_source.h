// SPDX-License-Identifier: Apache-2.0
// The source of a volume: facts about the file that it was read from.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas {

/// A list of entries in a file, of which one is read; for example its channels.
struct FileChoice {
  std::string name = {};  ///< "channel", "time", "layer", "array" or "series", as in ReadOptions
  /// The name of each entry in the file, or its number if it has no name.
  std::vector<std::string> entries = {};
  std::optional<std::size_t> selected = {};  ///< index of the entry that was read; absent: none yet
};

/// A decision of a reader where a format allows several interpretations.
struct ReadDecision {
  std::string key;    ///< the question, e.g. "affine"
  std::string value;  ///< the answer, e.g. "sform"
};

/// The source of a volume and the interpretation of its file.
struct VolumeSource {
  std::string format = {};  ///< e.g. "NIfTI-1", "ImageJ TIFF"
  std::string reader = {};  ///< the library that read the file, with its version: "libtiff 4.5.0"
  std::vector<ReadDecision> decisions = {};  ///< in the order in which they were made
  std::vector<std::string> warnings = {};    ///< one line each, without the path
  std::vector<FileChoice> choices = {};      ///< the lists from which entries were selected
  bool has_spacing = true;  ///< whether the file states the distance between samples
  /// The part of the grid's origin that the file states as a number of samples along x, y and z.
  Vec3 origin_in_samples = {};
};

}  // namespace isoatlas
