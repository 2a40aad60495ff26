// SPDX-License-Identifier: Apache-2.0
// Pages without a description of their axes, and pages with tifffile's: {"shape": [2, 16, 20, 24],
// "axes": "CZYX"}.
#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include "files/file_error.h"
#include "volume_files/choice.h"
#include "volume_files/tiff_stack.h"

namespace isoatlas::detail::io {

namespace {

/// An array that tifffile wrote; its pages are those from `first_page` on.
struct Series {
  std::size_t first_page = 0, page_count = 0;  // previews are not counted
  std::vector<std::size_t> shape = {};         // slowest first, as in NumPy
  std::string axes = {};                       // a letter per axis, or empty
  bool is_contiguous = false;
};

// The text after "name": in a JSON object without nesting.
std::string_view json_value(std::string_view json, const std::string& name) {
  const std::string key = "\"" + name + "\"";
  std::size_t at = json.find(key);
  if (at == std::string_view::npos) {
    return {};
  }
  at = json.find_first_not_of(" :", at + key.size());
  return at == std::string_view::npos ? std::string_view{} : json.substr(at);
}

std::vector<std::size_t> shape_of(std::string_view list) {
  std::vector<std::size_t> numbers;
  list = list.substr(0, list.find(']'));
  for (std::size_t at = list.find_first_of("0123456789"); at != std::string_view::npos;
       at = list.find_first_of("0123456789")) {
    std::size_t number = 0;
    const char* const end =
        std::from_chars(list.data() + at, list.data() + list.size(), number).ptr;
    list.remove_prefix(static_cast<std::size_t>(end - list.data()));
    numbers.push_back(number);
  }
  return numbers;
}

std::optional<Series> series_of(const std::string& description) {
  if (!description.starts_with("{\"") || description.find("\"shape\"") == std::string::npos) {
    return {};
  }
  Series series;
  series.shape = shape_of(json_value(description, "shape"));
  if (const std::string_view axes = json_value(description, "axes"); axes.starts_with('"')) {
    series.axes = std::string(axes.substr(1, axes.find('"', 1) - 1));
  }
  series.is_contiguous = json_value(description, "truncated").starts_with("true");
  return series.shape.size() < 2 ? std::nullopt : std::optional(series);
}

std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const std::size_t length : shape) {
    text += (text.empty() ? "" : " x ") + std::to_string(length);
  }
  return text;
}

// The axes of pages: those of the array except y, x and the values of a sample. Nothing if the
// shape does not match the pages.
std::optional<Series> axes_of_pages(Series series, const PageFormat& page,
                                    const std::filesystem::path& path) {
  const auto drop = [&](std::size_t index) {
    series.shape.erase(series.shape.begin() + static_cast<std::ptrdiff_t>(index));
    if (index < series.axes.size()) series.axes.erase(index, 1);
  };
  if (series.axes.size() != series.shape.size()) {
    series.axes.clear();
  }
  const std::size_t values = page.values_per_sample;
  if (values > 1 && series.shape.size() >= 3) {
    const std::size_t last = series.shape.size() - 1;
    drop(series.shape[last] == values && series.shape[last - 1] == page.width ? last : last - 2);
  }
  const std::size_t n = series.shape.size();
  if (n < 2 || series.shape[n - 1] != page.width || series.shape[n - 2] != page.height) {
    return {};
  }
  const std::string in_page = series.axes.empty() ? "YX" : series.axes.substr(n - 2);
  if (in_page != "YX" && in_page.find_first_not_of("XYZ") == std::string::npos) {
    throw unsupported(path, "states that its axes are '" + one_line(series.axes, 20) +
                                "', slowest first; expected rows and columns last, like 'ZYX' "
                                "(call numpy.transpose before writing)");
  }
  drop(n - 1);
  drop(n - 2);
  for (std::size_t index = series.shape.size(); index-- > 0;) {
    if (series.shape[index] == 1) drop(index);
  }
  return series;
}

// The meaning of each axis of the pages, a letter of "CZT", slowest first. A single axis without a
// meaning is the axis of slices.
std::string meaning_of_axes(const Series& series, const std::filesystem::path& path) {
  if (series.shape.size() < 2) {
    return series.axes == "C" || series.axes == "T" ? series.axes
                                                    : std::string(series.shape.size(), 'Z');
  }
  std::string meaning = series.axes;
  const auto plain = meaning.find_first_not_of("CT");
  if (plain != std::string::npos &&
      (meaning[plain] == 'Z' || meaning[plain] == 'Q' || meaning[plain] == 'I')) {
    meaning[plain] = 'Z';
  }
  for (const char axis : meaning) {
    if (std::string("CZT").find(axis) == std::string::npos ||
        std::ranges::count(meaning, axis) > 1) {
      meaning.clear();
      break;
    }
  }
  if (meaning.empty()) {
    throw unsupported(path,
                      "holds pages in an array of " + shape_text(series.shape) +
                          (series.axes.empty() ? " without names of its axes"
                                               : " with axes '" + one_line(series.axes, 20) + "'") +
                          ", expected slices, or axes named Z, C (channels) and T (time points)");
  }
  return meaning;
}

bool set_axes(const Series& series, const std::filesystem::path& path,
              std::vector<std::size_t> pages, TiffStack& stack) {
  std::size_t product = 1;
  for (const std::size_t length : series.shape) {
    constexpr std::size_t kMostPages = 1000000000;
    if (length == 0 || length > kMostPages / product) return false;
    product *= length;
  }
  stack.is_contiguous = series.is_contiguous && pages.size() == 1 && product > 1;
  if (product != pages.size() && !stack.is_contiguous) {
    return false;
  }
  std::string order = meaning_of_axes(series, path);
  for (std::size_t i = 0; i < order.size(); ++i) {
    (order[i] == 'Z'   ? stack.slices
     : order[i] == 'C' ? stack.channels
                       : stack.times) = series.shape[i];
  }
  std::ranges::reverse(order);
  for (const char axis : std::string("CZT")) {
    order += order.find(axis) == std::string::npos ? std::string(1, axis) : "";
  }
  set_page_order(stack, order, std::move(pages));
  return true;
}

}  // namespace

TiffStack describe_pages(TiffFile& tiff, const ReadOptions& options, VolumeSource& source) {
  TiffStack stack;
  std::vector<Series> list;  // each page with a shape begins a series
  std::vector<std::size_t> pages = pages_without_previews(tiff, source, [&](std::size_t index) {
    if (std::optional<Series> series = series_of(tiff.description())) {
      series->first_page = index;
      list.push_back(std::move(*series));
    }
    if (!list.empty()) {
      ++list.back().page_count;
    }
  });
  // Programs that write slices one by one make a series of one page for each.
  const bool is_one_by_one = std::ranges::all_of(
      list, [](const Series& series) { return series.page_count == 1 && !series.is_contiguous; });
  if (!list.empty() && list.front().first_page == 0 && !(list.size() > 1 && is_one_by_one)) {
    FileChoice choice{"series", {}, {}};
    for (const Series& series : list) {
      choice.entries.push_back(shape_text(series.shape));
    }
    const Series& chosen = list.size() > 1
                               ? list[take_choice(tiff.path(), source, choice, options.series)]
                               : list.front();
    const auto begin = pages.begin() + static_cast<std::ptrdiff_t>(chosen.first_page);
    pages = {begin, begin + static_cast<std::ptrdiff_t>(chosen.page_count)};
    tiff.select(pages.front());
    if (const auto axes = axes_of_pages(chosen, tiff.format(), tiff.path());
        axes && set_axes(*axes, tiff.path(), pages, stack)) {
      return stack;
    }
    source.warnings.push_back("its description states an array of " + shape_text(chosen.shape) +
                              ", which does not match its " + std::to_string(pages.size()) +
                              " pages; they are read as slices");
  }
  stack.slices = pages.size();
  tiff.select(pages.front());
  set_page_order(stack, "ZCT", std::move(pages));
  return stack;
}

}  // namespace isoatlas::detail::io
