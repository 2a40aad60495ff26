// SPDX-License-Identifier: Apache-2.0
// Numbers, lines and histograms as text.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "isoatlas/extract.h"
#include "isoatlas/measure.h"

namespace isoatlas::detail::tool {

/// True if the environment (LC_ALL, LC_CTYPE, LANG) selects UTF-8.
bool terminal_is_utf8();

/// `text` as one line: line breaks and other control characters become spaces.
std::string one_line(std::string_view text);

/// "(1.5, 2, 3)". Coordinates far from the origin have two decimals.
std::string point_text(Vec3 p);

std::string number_text(double value);        ///< at most six significant digits
std::string ratio_text(double ratio);         ///< to a thousandth
std::string count_text(std::uint64_t count);  ///< 12,345
std::string counted(std::uint64_t count,
                    const std::string& noun);  ///< "1 component", "12 components"
std::string percent_text(double share);        ///< 0.0123 -> "1.23 %"
std::string bytes_text(double bytes);          ///< 5.9 MiB
std::string seconds_text(double seconds);      ///< 83 ms, 2.41 s, 3 min 05 s
/// 1,161; 0.5 mm; 15 degrees; unbounded. `world` is the unit of lengths.
std::string bound_text(Quantity quantity, double bound, LengthUnit world = LengthUnit::unknown);
std::string with_unit(double length, LengthUnit unit);  ///< 0.5 mm; 0.5 if the unit is unknown
std::string size_text(const std::array<std::size_t, 3>& size);  ///< 256 x 256 x 94

/// The command line, quoted for a shell: isoatlas extract 'my head.nrrd' --iso 80.5
std::string command_text(const std::vector<std::string>& arguments);

/// "2 components, genus 3, 1 boundary loop, Euler characteristic -3"
std::string topology_text(const TopologySummary& topology);
/// "3 x (genus 0, closed), 1 x (genus 2, 1 boundary loop)", with at most `most` kinds.
std::string kinds_text(const TopologySummary& topology, std::size_t most);

/// "proved: no point of the mesh is farther than 0.5 from the isosurface, nor of the isosurface
/// from the mesh"
std::string proof_text(double distance_at_most);

/// The sampling density of a measurement: "sampled at 209,180 points (32.7 per voxel face) of the
/// mesh and ... of the isosurface"
std::string sampling_text(const Measurement& measured);

/// A line of a summary: a padded label and its value.
std::string row(const std::string& label, const std::string& value);

/// Scale of the heights. logarithmic: from a ten-thousandth of the highest count upwards.
enum class Scale { linear, logarithmic };

/// Columns of block characters ('#' without UTF-8). The highest count has full height; the top line
/// is first.
std::vector<std::string> draw_histogram(std::span<const std::size_t> counts, int rows,
                                        int column_width, Scale scale, bool utf8);

}  // namespace isoatlas::detail::tool
