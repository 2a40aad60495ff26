// SPDX-License-Identifier: Apache-2.0
// ImageJ's description in a TIFF file, read like ImageJ's own FileOpener and TiffDecoder read it.
// SCIFIO (ImageJ2) has its own description.
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "core/vector_math.h"
#include "files/file_error.h"
#include "isoatlas/length_unit.h"
#include "volume_files/key_value_lines.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace {

// Replaces escapes: java.util.Properties writes characters that are not ASCII as \u00B5.
std::string without_escapes(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    if (text.compare(i, 2, "\\u") == 0 && i + 6 <= text.size()) {
      auto code = static_cast<unsigned>(std::strtoul(text.substr(i + 2, 4).c_str(), nullptr, 16));
      if (code >= 0xD800 && code < 0xE000)
        code = 0xFFFD;  // half of a surrogate pair, which no unit of length contains
      if (code < 0x80) {
        plain += static_cast<char>(code);
        i += 6;
        continue;
      }
      if (code >= 0x800) {
        plain += static_cast<char>(0xE0U | code >> 12);
        plain += static_cast<char>(0x80U | (code >> 6 & 0x3FU));
      } else {
        plain += static_cast<char>(0xC0U | code >> 6);
      }
      plain += static_cast<char>(0x80U | (code & 0x3FU));
      i += 6;
    } else {
      plain += text[i++];
    }
  }
  return plain;
}

bool is_pixel(const std::string& unit) {
  return unit.empty() || unit == " " || unit == "pixel" || unit == "pixels" || unit == "voxel";
}

// Converts the length of an axis with its own unit (yunit, zunit) to the unit of x.
void convert_axis(const KeyValueLines& lines, const std::string& key, const TiffStack& stack,
                  std::optional<double>& length, VolumeSource& source) {
  if (!lines.has(key) || !length) {
    return;
  }
  const std::string unit_text = without_escapes(lines.text(key));
  const LengthUnit unit = length_unit_named(unit_text);
  if (unit != LengthUnit::unknown && stack.unit != LengthUnit::unknown) {
    *length *= metres(unit) / metres(stack.unit);
  } else if (unit_text != without_escapes(lines.text("unit"))) {
    source.warnings.push_back(one_line(
        "its " + key.substr(0, 1) + " axis is in '" + unit_text + "' and its x axis in '" +
        without_escapes(lines.text("unit")) + "'; the numbers are used without conversion"));
  }
}

std::optional<double> slice_distance(const KeyValueLines& lines,
                                     const std::filesystem::path& path) {
  if (!lines.has("spacing")) {
    return {};
  }
  const std::optional<double> distance = lines.number("spacing");
  if (!distance) {
    throw bad_file(
        path, "'" + one_line(lines.text("spacing"), 40) +
                  "' is not a number, expected a length after 'spacing=' in ImageJ's description");
  }
  return *distance == 0 ? std::nullopt : std::optional(std::abs(*distance));
}

// The resolution tags of a file with ImageJ's description are in the description's unit, with one
// exception; ResolutionUnit is ignored.
void set_geometry(TiffFile& tiff, const KeyValueLines& lines, TiffStack& stack,
                  VolumeSource& source) {
  const std::string unit = without_escapes(lines.text("unit"));
  stack.unit = length_unit_named(unit);
  stack.spacing[2] = slice_distance(lines, tiff.path());
  const double x = tiff.samples_per_length(TIFFTAG_XRESOLUTION),
               y = tiff.samples_per_length(TIFFTAG_YRESOLUTION);
  const bool has_resolution = x > 0 && y > 0 && (x != 1 || y != 1);
  const bool is_for_print =
      unit.empty() && !stack.spacing[2] && tiff.resolution_unit() != RESUNIT_NONE;
  if (!is_pixel(unit) || stack.spacing[2] || (has_resolution && !is_for_print)) {
    const double factor = tiff.resolution_unit() == RESUNIT_CENTIMETER && unit == "um" ? 1e4 : 1;
    stack.spacing[0] = x > 0 ? factor / x : 1;
    stack.spacing[1] = y > 0 ? factor / y : 1;
  }
  if (!is_pixel(unit) && stack.unit == LengthUnit::unknown) {
    source.warnings.push_back("its unit of length '" + one_line(unit, 40) + "' is not known");
  }
  convert_axis(lines, "yunit", stack, stack.spacing[1], source);
  convert_axis(lines, "zunit", stack, stack.spacing[2], source);
  const Vec3 first{lines.number("xorigin").value_or(0), lines.number("yorigin").value_or(0),
                   lines.number("zorigin").value_or(0)};
  if (first != Vec3{}) {  // in samples: the index of the sample at 0
    source.origin_in_samples = -1.0 * first;
    stack.origin = {-first.x * stack.spacing[0].value_or(1),
                    -first.y * stack.spacing[1].value_or(1),
                    -first.z * stack.spacing[2].value_or(1)};
    source.decisions.push_back({"origin", "ImageJ's xorigin, yorigin, zorigin"});
  }
}

// World values are a function of the stored values. ImageJ supports it for 8 and 16 bits only, and
// ignores it without a unit of value (vunit). Signed 16-bit samples are stored from 0 on, which
// stands for -32768, so ImageJ's function counts from there.
void set_rescale(TiffFile& tiff, const KeyValueLines& lines, TiffStack& stack,
                 VolumeSource& source) {
  constexpr double kStraightLine = 0, kNone = 20;
  const std::optional<double> function = lines.number("cf");
  const PageFormat page = tiff.format();
  const bool has_function = page.type() == SampleType::uint8 || page.type() == SampleType::uint16 ||
                            page.type() == SampleType::int16;
  if (!function || *function == kNone || !has_function) {
    return;
  }
  if (!lines.has("vunit")) {
    source.warnings.push_back(
        "its calibration function (cf=) has no unit (vunit=) and is not applied, as in ImageJ");
    return;
  }
  const std::optional<double> c0 = lines.number("c0"), c1 = lines.number("c1");
  if (*function != kStraightLine || lines.text("zeroclip") == "true") {
    throw unsupported(
        tiff.path(),
        "has ImageJ's calibration function " + one_line(lines.text("cf"), 20) +
            (lines.text("zeroclip") == "true" ? " with values below 0 cut off" : "") +
            ", expected none or a straight line (0); Image > Type > 32-bit in ImageJ applies it");
  }
  if (!c0 || !c1 || *c1 == 0) {
    throw bad_file(tiff.path(),
                   "has ImageJ's calibration function 0 (a straight line) without two coefficients "
                   "c0 and c1, expected both, c1 not 0");
  }
  const double first_value = page.type() == SampleType::int16 ? 32768 : 0;
  stack.rescale = LinearRescale{*c1, *c0 + *c1 * first_value};
}

[[noreturn]] void refuse_page_count(const TiffFile& tiff, const TiffStack& stack,
                                    std::size_t pages) {
  throw bad_file(tiff.path(), "ImageJ's description states " + std::to_string(stack.channels) +
                                  " channels x " + std::to_string(stack.slices) + " slices x " +
                                  std::to_string(stack.times) + " time points, the file has " +
                                  std::to_string(pages) + (pages == 1 ? " page" : " pages"));
}

void set_pages(TiffFile& tiff, const KeyValueLines& lines, TiffStack& stack, VolumeSource& source) {
  stack.channels = lines.count("channels").value_or(1);
  stack.slices = lines.count("slices").value_or(1);
  stack.times = lines.count("frames").value_or(1);
  std::vector<std::size_t> pages = pages_without_previews(tiff, source);
  tiff.select(pages.front());
  if (stack.channels * stack.slices * stack.times == 1) {
    stack.slices = lines.count("images").value_or(1);
  }
  if (stack.channels == tiff.format().values_per_sample &&
      pages.size() == stack.slices * stack.times) {
    stack.channels = 1;  // counted in pages; a page of red, green and blue holds all channels
  }
  const std::size_t stated = stack.channels * stack.slices * stack.times;
  if (pages.size() == 1 && stated > 1) {
    stack.is_contiguous = true;
    if (tiff.offset_of_plain_samples() == 0) {
      refuse_page_count(tiff, stack, pages.size());
    }
    pages.assign(1, pages.front());
    source.decisions.push_back(
        {"layout", std::to_string(stated) +
                       " images after the only page, as ImageJ writes files above 4 GB"});
  } else if (pages.size() > stated && stack.channels == 1 && stack.times == 1) {
    source.warnings.push_back("ImageJ's description states " + std::to_string(stated) +
                              " images, the file has " + std::to_string(pages.size()) +
                              " pages, which are all read");
    stack.slices = pages.size();
  } else if (pages.size() != stated) {
    refuse_page_count(tiff, stack, pages.size());
  }
  set_page_order(stack, "CZT", std::move(pages));
}

}  // namespace

std::optional<TiffStack> describe_imagej(TiffFile& tiff, VolumeSource& source) {
  const std::string description = tiff.description();
  if (!description.starts_with("ImageJ=")) {
    return {};
  }
  const KeyValueLines lines(description);
  TiffStack stack;
  stack.format = "ImageJ TIFF";
  set_geometry(tiff, lines, stack, source);
  set_rescale(tiff, lines, stack, source);
  set_pages(tiff, lines, stack, source);
  return stack;
}

TiffStack describe_slice(TiffFile& tiff, VolumeSource& source) {
  TiffStack stack;
  if (const std::string description = tiff.description(); description.starts_with("ImageJ=")) {
    const KeyValueLines lines(description);
    const std::size_t images = lines.count("images").value_or(1);
    const std::uint64_t start = tiff.offset_of_plain_samples();
    if (images > 1 && start != 0 &&
        (tiff.file_size() - start) / tiff.format().stored_bytes() >= images) {
      throw unsupported(
          tiff.path(), "has " + std::to_string(images) +
                           " images after one page, expected one slice in each file of the folder; "
                           "read a file of many slices by its own path");
    }
    set_geometry(tiff, lines, stack, source);
    set_rescale(tiff, lines, stack, source);
  }
  return stack;
}

}  // namespace isoatlas::detail::io
