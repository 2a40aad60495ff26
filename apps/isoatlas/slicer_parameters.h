// SPDX-License-Identifier: Apache-2.0
// The parameters of isoatlas as a command-line module of 3D Slicer.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isoatlas::detail::tool {

/// A parameter of the module. Its flag on the command line is "--" and its name.
struct SlicerParameter {
  std::string_view type;  ///< the XML element: "double", "integer", "string-enumeration", ...
  std::string_view name, label, description;
  std::string_view default_value = {};
  std::vector<std::string_view> words = {};  ///< the values of an enumeration
  /// The option of isoatlas extract that the parameter sets, without dashes. Empty: none.
  std::string_view option = {};
  /// The value with which the option is not set. 3D Slicer passes every number, so a number that is
  /// not given needs one.
  std::string_view unset = {};

  bool is_file() const { return type == "image" || type == "geometry"; }
  bool is_flag() const { return type == "boolean"; }
};

/// A section of the module's panel.
struct SlicerGroup {
  std::string_view label, description;
  bool is_advanced = false;  ///< closed at first
  std::vector<SlicerParameter> parameters;
};

/// All parameters that are given on the command line. The constraints are in the order of their
/// priority.
std::span<const SlicerGroup> slicer_groups();

/// The numbers that the module returns in the file of --returnparameterfile.
const SlicerGroup& slicer_results();

/// The description of the module that --xml prints: XML of the Slicer Execution Model.
std::string slicer_xml();

}  // namespace isoatlas::detail::tool
