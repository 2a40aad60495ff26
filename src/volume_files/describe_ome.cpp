// SPDX-License-Identifier: Apache-2.0
// OME-XML in the description of the first page: sizes, lengths, and the planes of the pages.
// https://docs.openmicroscopy.org/ome-model/latest/ome-tiff/specification.html
#include <algorithm>
#include <array>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "isoatlas/length_unit.h"
#include "volume_files/choice.h"
#include "volume_files/key_value_lines.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace {

// The element's name without its prefix: the oldest files have "OME:Image" for "Image".
std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);
}

std::vector<pugi::xml_node> children(const pugi::xml_node& parent, std::string_view name) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node child : parent.children()) {
    if (local_name(child) == name) found.push_back(child);
  }
  return found;
}

pugi::xml_node child(const pugi::xml_node& parent, std::string_view name) {
  const std::vector<pugi::xml_node> found = children(parent, name);
  return found.empty() ? pugi::xml_node() : found.front();
}

std::optional<double> positive(const pugi::xml_attribute& attribute) {
  const std::optional<double> value = finite_number(attribute.value());
  return value && *value > 0 ? value : std::nullopt;
}

/// A page of this file, or the name of the file that has the page.
struct PlaneLocation {
  std::size_t page = 0;
  std::string other_file = {};
};

class OmeImage {
 public:
  OmeImage(const TiffFile& tiff, const pugi::xml_node& ome, const pugi::xml_node& image)
      : path_(tiff.path()),
        page_count_(tiff.page_count()),
        ome_(ome),
        pixels_(child(image, "Pixels")) {
    if (!pixels_) {
      throw bad_file(path_, one_line("OME image '" + std::string(image.attribute("Name").value()) +
                                     "' has no Pixels"));
    }
  }

  TiffStack stack(TiffFile& tiff, VolumeSource& source) {
    stack_.format = "OME-TIFF";
    stack_.channels = size_of("SizeC");
    stack_.slices = size_of("SizeZ");
    stack_.times = size_of("SizeT");
    read_order();
    tiff.select(first_page());
    const PageFormat page = tiff.format();
    if (stack_.channels % page.values_per_sample != 0) {
      throw bad_file(path_, "OME-XML states " + std::to_string(stack_.channels) +
                                " channels (SizeC), but its pages hold " +
                                std::to_string(page.values_per_sample) + " each");
    }
    read_channel_names(page.values_per_sample);
    stack_.channels /= page.values_per_sample;  // counted in pages
    locate_planes();
    if (children(ome_, "Image").size() == 1 && located_ < page_count_) {
      source.warnings.push_back("has " + std::to_string(page_count_) +
                                " pages, of which its OME-XML names " + std::to_string(located_) +
                                "; the others are not read");
    }
    read_lengths(source);
    warn_of_differences(page, source);
    stack_.page_of = [planes = std::make_shared<const Planes>(std::move(planes_)), path = path_](
                         std::size_t c, std::size_t z, std::size_t t) {
      return page_of_plane(*planes, path, {c, z, t});
    };
    return std::move(stack_);
  }

 private:
  using Plane = std::array<std::size_t, 3>;  // channel, slice, time
  struct PlaneHash {
    std::size_t operator()(const Plane& plane) const {
      return (plane[2] * 1000003 + plane[1]) * 1000003 + plane[0];
    }
  };
  static constexpr std::size_t kMostPlanes = 2000000;
  using Planes = std::unordered_map<Plane, PlaneLocation, PlaneHash>;

  std::size_t size_of(const char* name) const {
    const std::optional<std::size_t> size = count_of_pages(pixels_.attribute(name).value());
    if (!size) {
      throw bad_file(path_, one_line(std::string("OME-XML has ") + name + " '" +
                                     pixels_.attribute(name).value() +
                                     "', expected a number from 1 to 1000000"));
    }
    return *size;
  }

  void read_order() {
    const std::string order = pixels_.attribute("DimensionOrder").value();
    order_ = order.size() == 5 && order.starts_with("XY") ? order.substr(2) : "";
    std::string sorted = order_;
    std::ranges::sort(sorted);
    if (sorted != "CTZ") {
      throw bad_file(path_, one_line("OME-XML has DimensionOrder '" + order +
                                     "', expected XY and Z, C and T in any order"));
    }
  }

  // The plane `steps` after `plane`, in the order of the dimensions.
  std::optional<Plane> advanced(Plane plane, std::size_t steps) const {
    for (const char axis : order_) {
      std::size_t& index = plane[axis == 'C' ? 0 : axis == 'Z' ? 1 : 2];
      const std::size_t length = axis == 'C'   ? stack_.channels
                                 : axis == 'Z' ? stack_.slices
                                               : stack_.times;
      const std::size_t total = index + steps;
      index = total % length;
      steps = total / length;
    }
    return steps == 0 ? std::optional(plane) : std::nullopt;
  }

  // The name of the file with the planes; empty if they are in this file. A file is identified by
  // its UUID, or by its name if it has no UUID.
  std::string other_file(const pugi::xml_node& tiff_data) const {
    const pugi::xml_node uuid = child(tiff_data, "UUID");
    const std::string_view own = ome_.attribute("UUID").value();
    if (!uuid || (!own.empty() && own == uuid.child_value())) {
      return "";
    }
    const std::string file_name = uuid.attribute("FileName").value();
    const bool is_named_here = std::filesystem::path(file_name).filename() == path_.filename();
    if (own.empty() && (file_name.empty() || is_named_here)) {
      return "";
    }
    return file_name.empty() ? std::string("the file ") + uuid.child_value() : file_name;
  }

  // The first page of this file that holds a plane of the image.
  std::size_t first_page() const {
    const std::vector<pugi::xml_node> blocks = children(pixels_, "TiffData");
    if (blocks.empty()) {
      throw unsupported(path_,
                        "OME-XML does not state the pages of its planes (it has no TiffData), "
                        "expected the pixels in this file");
    }
    for (const pugi::xml_node& block : blocks) {
      const unsigned long long page = block.attribute("IFD").as_ullong();
      if (other_file(block).empty() && page < page_count_) {
        return static_cast<std::size_t>(page);
      }
    }
    throw unsupported(path_, one_line("has no planes of its OME image, which are in '" +
                                      other_file(blocks.front()) + "'; expected all in one file"));
  }

  void locate_planes() {
    for (const pugi::xml_node& block : children(pixels_, "TiffData")) {
      const bool has_page = !block.attribute("IFD").empty(),
                 has_count = !block.attribute("PlaneCount").empty();
      const Plane start{static_cast<std::size_t>(block.attribute("FirstC").as_ullong()),
                        static_cast<std::size_t>(block.attribute("FirstZ").as_ullong()),
                        static_cast<std::size_t>(block.attribute("FirstT").as_ullong())};
      if (start[0] >= stack_.channels || start[1] >= stack_.slices || start[2] >= stack_.times) {
        throw bad_file(path_, "OME-XML places a page at channel " + std::to_string(start[0]) +
                                  ", slice " + std::to_string(start[1]) + ", time " +
                                  std::to_string(start[2]) + ", beyond its own sizes");
      }
      const auto first = static_cast<std::size_t>(block.attribute("IFD").as_ullong());
      const std::string file = other_file(block);
      const std::size_t pages_left =
          file.empty() ? page_count_ - std::min(first, page_count_) : kMostPlanes;
      const auto count = static_cast<std::size_t>(
          block.attribute("PlaneCount").as_ullong(has_page ? 1 : pages_left));
      for (std::size_t i = 0; i < count; ++i) {
        const std::optional<Plane> plane = advanced(start, i);
        if (!plane) break;  // there are more pages than planes
        if (i >= pages_left && (has_page || has_count)) {
          throw bad_file(path_, "OME-XML states a page " + std::to_string(first + i + 1) +
                                    ", the file has " + std::to_string(page_count_));
        }
        if (++located_ > kMostPlanes) {
          throw bad_file(path_,
                         "OME-XML places more than " + std::to_string(kMostPlanes) + " pages");
        }
        planes_[*plane] = file.empty() ? PlaneLocation{first + i, ""} : PlaneLocation{0, file};
      }
    }
  }

  static std::size_t page_of_plane(const Planes& planes, const std::filesystem::path& path,
                                   const Plane& plane) {
    const std::string name = "channel " + std::to_string(plane[0]) + ", slice " +
                             std::to_string(plane[1]) + ", time " + std::to_string(plane[2]);
    const auto found = planes.find(plane);
    if (found == planes.end()) {
      throw bad_file(path, "OME-XML names no page for " + name);
    }
    if (!found->second.other_file.empty()) {
      throw unsupported(path,
                        one_line("is one of several files of an OME-TIFF: " + name + " is in '" +
                                 found->second.other_file + "'; expected all in one file"));
    }
    return found->second.page;
  }

  void read_channel_names(std::size_t values) {
    const std::vector<pugi::xml_node> channels = children(pixels_, "Channel");
    if (channels.size() * values != stack_.channels) {
      return;
    }
    for (const pugi::xml_node& channel : channels) {
      const std::string name = channel.attribute("Name").value();
      for (std::size_t value = 0; value < values; ++value) {
        std::string entry = name.empty() ? std::to_string(stack_.channel_names.size()) : name;
        if (values > 1 && !name.empty()) {
          entry += ' ';
          entry += std::to_string(value);
        }
        stack_.channel_names.push_back(std::move(entry));
      }
    }
  }

  void read_lengths(VolumeSource& source) {
    std::array<LengthUnit, 3> units{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string key = std::string("PhysicalSize") + "XYZ"[axis];
      const std::string unit = pixels_.attribute((key + "Unit").c_str()).as_string("\u00B5m");
      stack_.spacing[axis] = positive(pixels_.attribute(key.c_str()));
      units[axis] = length_unit_named(unit);
      const bool is_counted = unit == "pixel" || unit == "reference frame";
      if (stack_.spacing[axis] && units[axis] == LengthUnit::unknown && !is_counted) {
        source.warnings.push_back("its unit of length '" + one_line(unit, 40) + "' along " +
                                  "xyz"[axis] + " is not known");
      }
    }
    const std::size_t first = stack_.spacing[0] ? 0 : stack_.spacing[1] ? 1 : 2;
    stack_.unit = stack_.spacing[first] ? units[first] : LengthUnit::unknown;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!stack_.spacing[axis] || units[axis] == stack_.unit) continue;
      if (units[axis] == LengthUnit::unknown || stack_.unit == LengthUnit::unknown) {
        throw unsupported(
            path_,
            "has voxel sizes along x, y and z of which some have a known unit and some do not");
      }
      *stack_.spacing[axis] *= metres(units[axis]) / metres(stack_.unit);
    }
  }

  void warn_of_differences(const PageFormat& page, VolumeSource& source) const {
    const auto width = size_of("SizeX"), height = size_of("SizeY");
    if (width != page.width || height != page.height) {
      source.warnings.push_back("OME-XML states " + std::to_string(width) + " x " +
                                std::to_string(height) + " samples, its pages have " +
                                std::to_string(page.width) + " x " + std::to_string(page.height) +
                                "; the sizes of the pages are used");
    }
    const bool has_more =
        !ome_.select_nodes("//*[starts-with(local-name(), 'ModuloAlongZ')]").empty();
    if (has_more) {
      source.warnings.push_back(
          "its slices are those of several angles, phases or the like (ModuloAlongZ)");
    }
  }

  std::filesystem::path path_;
  std::size_t page_count_;
  pugi::xml_node ome_, pixels_;
  TiffStack stack_;
  std::string order_;  // a permutation of "CZT", fastest first
  Planes planes_;
  std::size_t located_ = 0;
};

}  // namespace

std::optional<TiffStack> describe_ome(TiffFile& tiff, const ReadOptions& options,
                                      VolumeSource& source) {
  const std::string description = tiff.description();
  if (description.substr(0, 4096).find("<OME") == std::string::npos ||
      description.find_first_not_of(" \r\n\t\xEF\xBB\xBF") != description.find('<')) {
    return {};
  }
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer(description.data(), description.size());
  const pugi::xml_node ome = document.document_element();
  if (result && local_name(ome) != "OME") {
    return {};
  }
  if (!result) {
    throw bad_file(tiff.path(), "its OME-XML is damaged after " + std::to_string(result.offset) +
                                    " bytes: " + result.description());
  }
  if (const pugi::xml_node companion = child(ome, "BinaryOnly")) {
    throw unsupported(tiff.path(),
                      one_line("its OME-XML is in another file, '" +
                               std::string(companion.attribute("MetadataFile").value()) +
                               "' (BinaryOnly); expected it in this file"));
  }
  const std::vector<pugi::xml_node> images = children(ome, "Image");
  if (images.empty()) {
    throw bad_file(tiff.path(), "its OME-XML describes no image");
  }
  std::size_t chosen = 0;
  if (images.size() > 1) {
    FileChoice choice{"series", {}, {}};
    for (const pugi::xml_node& image : images) {
      const std::string name = image.attribute("Name").value();
      choice.entries.push_back(name.empty() ? std::to_string(choice.entries.size()) : name);
    }
    chosen = take_choice(tiff.path(), source, std::move(choice), options.series);
  }
  return OmeImage(tiff, ome, images[chosen]).stack(tiff, source);
}

}  // namespace isoatlas::detail::io
