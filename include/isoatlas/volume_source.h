// SPDX-License-Identifier: Apache-2.0
// Where a volume comes from.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "isoatlas/volume.h"

namespace isoatlas {

/// A list in a file from which one entry is read.
struct FileChoice {
  std::string name = {};  ///< "channel", "time", "layer", "array" or "series", as in ReadOptions
  std::vector<std::string> entries =
      {};  ///< what each is called in the file; a number where it has no name
  std::optional<std::size_t> selected = {};  ///< the entry that was read
};

/// What a reader decided, in the order in which it did.
struct ReadDecision {
  std::string key;    ///< e.g. "affine"
  std::string value;  ///< e.g. "sform"
};

/// Where a volume comes from and how its file was understood.
struct VolumeSource {
  std::string format = {};  ///< e.g. "NIfTI-1", "ImageJ TIFF"
  std::string reader = {};  ///< the library that read it, with its version, e.g. "libtiff 4.5.0"
  std::vector<ReadDecision> decisions = {};
  std::vector<std::string> warnings = {};  ///< one line each, without the path
  std::vector<FileChoice> choices = {};
  bool has_spacing = true;  ///< the file states the distance between samples
  Vec3 origin_in_samples =
      {};  ///< the part of the origin that the file states in samples along x, y and z
};

}  // namespace isoatlas
