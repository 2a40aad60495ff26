// SPDX-License-Identifier: Apache-2.0
#include "volume_files/slice_names.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <string>

#include "core/file_name.h"
#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

bool is_digit_of_name(char c) { return c >= '0' && c <= '9'; }

/// A file's name, split: "slice_07b.tif" has the text "slice_#b.tif" and the number 7.
struct SliceName {
  fs::path path;
  std::string text;
  std::vector<std::string> numbers;  // without leading zeros
};

SliceName parse(const fs::path& path) {
  SliceName name{path, {}, {}};
  const std::string file_name = path.stem().string();
  for (std::size_t i = 0; i < file_name.size();) {
    if (!is_digit_of_name(file_name[i])) {
      name.text += file_name[i++];
      continue;
    }
    std::size_t end = i;
    while (end < file_name.size() && is_digit_of_name(file_name[end])) ++end;
    const std::size_t first = std::min(file_name.find_first_not_of('0', i), end - 1);
    name.numbers.push_back(file_name.substr(first, end - first));
    name.text += '#';
    i = end;
  }
  const std::string extension = lower_case_extension(path);
  name.text += extension == ".tiff" ? ".tif" : extension;
  return name;
}

bool is_below(const std::string& a, const std::string& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

std::string quoted(const fs::path& path) {
  return "'" + one_line(path.filename().string(), 80) + "'";
}

void require_alike(const fs::path& folder, const std::vector<SliceName>& names) {
  for (const SliceName& name : names) {
    if (name.text != names.front().text) {
      throw unsupported(
          folder,
          "its images " + quoted(names.front().path) + " and " + quoted(name.path) +
              " are not named alike, expected slices of one volume with a number in their names");
    }
  }
}

std::vector<std::size_t> varying_numbers(const std::vector<SliceName>& names) {
  std::vector<std::size_t> varying;
  for (std::size_t index = 0; index < names.front().numbers.size(); ++index) {
    if (std::ranges::any_of(names, [&](const SliceName& name) {
          return name.numbers[index] != names.front().numbers[index];
        })) {
      varying.push_back(index);
    }
  }
  return varying;
}

// A date and a counter increase together. If a number repeats while another one varies, it counts
// channels or times.
void require_rising(const fs::path& folder, const std::vector<SliceName>& names,
                    const std::vector<std::size_t>& varying) {
  for (std::size_t i = 1; i < names.size(); ++i) {
    for (const std::size_t index : varying) {
      if (is_below(names[i - 1].numbers[index], names[i].numbers[index])) continue;
      if (varying.size() == 1) {
        throw bad_file(folder, "its images " + quoted(names[i - 1].path) + " and " +
                                   quoted(names[i].path) + " have the same number");
      }
      throw unsupported(folder, "its images differ in " + std::to_string(varying.size()) +
                                    " numbers of their names, as " + quoted(names[i - 1].path) +
                                    " and " + quoted(names[i].path) +
                                    ", expected slices of one channel and time with one number");
    }
  }
}

// The difference of two numbers. They may have more digits than an integer holds, so their common
// leading digits are dropped.
std::optional<std::uint64_t> difference(std::string_view from, std::string_view to) {
  const std::size_t same =
      static_cast<std::size_t>(std::ranges::mismatch(from, to).in1 - from.begin());
  if (from.size() == to.size() && same < from.size()) {
    from.remove_prefix(same);
    to.remove_prefix(same);
  }
  std::uint64_t low = 0, high = 0;
  const bool is_low =
      std::from_chars(from.data(), from.data() + from.size(), low).ec == std::errc{};
  const bool is_high = std::from_chars(to.data(), to.data() + to.size(), high).ec == std::errc{};
  return is_low && is_high ? std::optional(high - low) : std::nullopt;
}

void require_even_steps(const fs::path& folder, const std::vector<SliceName>& names,
                        std::size_t index) {
  std::optional<std::uint64_t> step;
  for (std::size_t i = 1; i < names.size(); ++i) {
    const auto found = difference(names[i - 1].numbers[index], names[i].numbers[index]);
    if (found && (!step || *found < *step)) step = found;
  }
  for (std::size_t i = 1; i < names.size(); ++i) {
    const auto found = difference(names[i - 1].numbers[index], names[i].numbers[index]);
    if (found && found != step) {
      throw bad_file(folder, "slices are missing between " + quoted(names[i - 1].path) + " and " +
                                 quoted(names[i].path) + ": elsewhere the numbers are " +
                                 std::to_string(*step) + " apart");
    }
  }
}

}  // namespace

std::vector<fs::path> in_slice_order(const fs::path& folder, std::vector<fs::path> files) {
  std::vector<SliceName> names;
  for (const fs::path& file : files) {
    names.push_back(parse(file));
  }
  std::ranges::sort(names, {},
                    &SliceName::path);  // messages must not depend on the order of the folder
  require_alike(folder, names);
  const std::vector<std::size_t> varying = varying_numbers(names);
  std::ranges::stable_sort(names, [&](const SliceName& a, const SliceName& b) {
    return std::ranges::lexicographical_compare(a.numbers, b.numbers, is_below);
  });
  if (varying.empty() && names.size() > 1) {
    throw bad_file(folder, "its images " + quoted(names[0].path) + " and " + quoted(names[1].path) +
                               " have the same number");
  }
  require_rising(folder, names, varying);
  if (varying.size() == 1) {
    require_even_steps(folder, names, varying.front());
  }
  std::ranges::transform(names, files.begin(), &SliceName::path);
  return files;
}

}  // namespace isoatlas::detail::io
