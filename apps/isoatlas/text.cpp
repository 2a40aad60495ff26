// SPDX-License-Identifier: Apache-2.0
#include "text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/file_name.h"

namespace isoatlas::detail::tool {
namespace {

std::string formatted(const char* format, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

}  // namespace

bool terminal_is_utf8() {
  // In the order in which the C library reads them.
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(variable);
    if (value == nullptr || *value == '\0') continue;
    const std::string locale = lower_case(value);
    return locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
  }
  return false;
}

std::string one_line(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const bool blank = c == ' ' || std::iscntrl(static_cast<unsigned char>(c)) != 0;
    if (!blank)
      result += c;
    else if (!result.empty() && result.back() != ' ')
      result += ' ';
  }
  while (!result.empty() && result.back() == ' ') result.pop_back();
  return result;
}

std::string number_text(double value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, 6)
                       .ptr;
  return {buffer.data(), end};
}

std::string point_text(Vec3 p) {
  constexpr double kFar = 1e4;
  std::string text;
  for (const double x : {p.x, p.y, p.z})
    text +=
        (text.empty() ? "(" : ", ") + (std::fabs(x) < kFar ? number_text(x) : formatted("%.2f", x));
  return text + ")";
}

std::string ratio_text(double ratio) { return number_text(std::round(ratio * 1e3) / 1e3); }

std::string count_text(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

std::string counted(std::uint64_t count, const std::string& noun) {
  std::string text = count_text(count) + " " + noun;
  if (count == 1) return text;
  if (!noun.ends_with("vertex")) return text + "s";
  text.replace(text.size() - 2, 2, "ices");
  return text;
}

std::string percent_text(double share) { return number_text(std::round(share * 1e4) / 1e2) + " %"; }

std::string bytes_text(double bytes) {
  constexpr std::array<const char*, 5> kUnits{"bytes", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024;
  return formatted(unit == 0 || bytes >= 100 ? "%.0f " : "%.1f ", bytes) + kUnits[unit];
}

std::string seconds_text(double seconds) {
  if (seconds < 0.9995) return formatted("%.0f ms", seconds * 1e3);
  if (seconds < 60) return formatted("%.2f s", seconds);
  const double minutes = std::floor(seconds / 60);
  return formatted("%.0f min ", minutes) +
         formatted("%02.0f s", std::floor(seconds - 60 * minutes));
}

std::string with_unit(double length, LengthUnit unit) {
  std::string text = number_text(length);
  if (unit != LengthUnit::unknown) text.append(" ").append(symbol(unit));
  return text;
}

std::string bound_text(Quantity quantity, double bound, LengthUnit world) {
  if (std::isinf(bound)) return "unbounded";
  switch (unit(quantity)) {
    case Unit::count:
      return count_text(static_cast<std::uint64_t>(std::max(bound, 0.0)));
    case Unit::degrees:
      return number_text(bound) + " degrees";
    case Unit::length:
      return with_unit(bound, world);
    case Unit::ratio:
    case Unit::number:
      break;
  }
  return number_text(bound);
}

std::string size_text(const std::array<std::size_t, 3>& size) {
  return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
         std::to_string(size[2]);
}

std::string command_text(const std::vector<std::string>& arguments) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  std::string out = "isoatlas";
  for (const std::string& argument : arguments) {
    out += ' ';
    if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) {
      out += argument;
      continue;
    }
    out += "'";
    for (const char c : argument) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    out += "'";
  }
  return out;
}

std::string topology_text(const TopologySummary& topology) {
  return counted(topology.components, "component") + ", genus " + std::to_string(topology.genus) +
         ", " + counted(static_cast<std::uint64_t>(topology.boundary_loops), "boundary loop") +
         ", Euler characteristic " + std::to_string(topology.euler_characteristic);
}

std::string kinds_text(const TopologySummary& topology, std::size_t most) {
  std::string text;
  const std::size_t listed = std::min(most, topology.kinds.size());
  for (std::size_t i = 0; i < listed; ++i) {
    const auto& kind = topology.kinds[i];
    if (i > 0) text += ", ";
    text += count_text(kind.count) + " x (genus " + std::to_string(kind.genus) + ", ";
    text += kind.boundary_loops == 0
                ? "closed"
                : counted(static_cast<std::uint64_t>(kind.boundary_loops), "boundary loop");
    text += ")";
  }
  if (listed < topology.kinds.size())
    text += " and " + counted(topology.kinds.size() - listed, "other kind");
  return text;
}

std::string proof_text(double distance_at_most) {
  return "proved: no point of the mesh is farther than " + number_text(distance_at_most) +
         " from the isosurface, nor of the isosurface from the mesh";
}

std::string sampling_text(const Measurement& measured) {
  const auto samples = [](const OneSidedDistance& side) {
    return count_text(side.samples) + " points (" +
           number_text(std::round(10 * side.samples_per_voxel_face) / 10) + " per voxel face)";
  };
  return "sampled at " + samples(measured.mesh_to_surface) + " of the mesh and " +
         samples(measured.surface_to_mesh) + " of the isosurface";
}

std::string row(const std::string& label, const std::string& value) {
  constexpr std::size_t kLabelWidth = 14;
  std::string padded = label;
  padded.resize(std::max(kLabelWidth, label.size() + 1), ' ');
  return std::string(2, ' ') + padded + value + "\n";
}

std::vector<std::string> draw_histogram(std::span<const std::size_t> counts, int rows,
                                        int column_width, Scale scale, bool utf8) {
  static constexpr std::array<const char*, 9> kBlocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const std::size_t highest = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  const auto height = [&](std::size_t count) {  // in [0, 1]
    if (count == 0) return 0.0;
    const double share = static_cast<double>(count) / static_cast<double>(highest);
    return scale == Scale::linear ? share : std::max(0.0, 1 + std::log10(share) / 4);
  };

  std::vector<std::string> lines(static_cast<std::size_t>(rows));
  for (const std::size_t count : counts) {
    int eighths = static_cast<int>(std::lround(height(count) * 8 * rows));
    if (count > 0) eighths = std::max(eighths, 1);  // a count above 0 is always visible
    for (int r = 0; r < rows; ++r) {
      const int filled = std::clamp(eighths - 8 * (rows - 1 - r), 0, 8);
      const char* ascii = filled >= 4 ? "#" : filled > 0 ? "." : " ";
      for (int c = 0; c < column_width; ++c)
        lines[static_cast<std::size_t>(r)] +=
            utf8 ? kBlocks[static_cast<std::size_t>(filled)] : ascii;
    }
  }
  return lines;
}

}  // namespace isoatlas::detail::tool
