// SPDX-License-Identifier: Apache-2.0
#include "volume_files/choice.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace {

// E.g. "0 (DAPI), 1 (GFP), 2". A name that is only the entry's number is omitted.
std::string entry_list(const FileChoice& choice) {
  constexpr std::size_t kMostListed = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(choice.entries.size(), kMostListed); ++i) {
    const std::string number = std::to_string(i);
    list += (i > 0 ? ", " : "") + number +
            (choice.entries[i] == number ? "" : " (" + one_line(choice.entries[i], 160) + ")");
  }
  if (choice.entries.size() > kMostListed) {
    list += ", ... " + std::to_string(choice.entries.size() - 1);
  }
  return list;
}

std::string plural(const FileChoice& choice) {
  return choice.name == "series" ? "series"
         : choice.name == "time" ? "time points"
                                 : choice.name + "s";
}

[[noreturn]] void refuse(const std::filesystem::path& path, const FileChoice& choice,
                         const std::string& wanted) {
  throw Error(ErrorCode::bad_argument,
              one_line(path.string() + ": has no " + choice.name + " '" + wanted +
                           "', expected one of " + entry_list(choice),
                       2000));
}

[[noreturn]] void require_choice(const std::filesystem::path& path, const VolumeSource& source,
                                 const FileChoice& choice) {
  VolumeSource known = source;
  known.choices.push_back(choice);
  throw ChoiceNeeded(
      one_line(path.string() + ": has " + std::to_string(choice.entries.size()) + " " +
                   plural(choice) + ", expected a choice of one: " + entry_list(choice),
               2000),
      choice, std::move(known));
}

std::size_t select(VolumeSource& source, FileChoice choice, std::size_t entry) {
  choice.selected = entry;
  source.choices.push_back(std::move(choice));
  return entry;
}

}  // namespace

std::size_t take_choice(const std::filesystem::path& path, VolumeSource& source, FileChoice choice,
                        std::optional<std::size_t> wanted) {
  if (!wanted && choice.entries.size() > 1) {
    require_choice(path, source, choice);
  }
  const std::size_t entry = wanted.value_or(0);
  if (entry >= choice.entries.size()) {
    refuse(path, choice, std::to_string(entry));
  }
  return select(source, std::move(choice), entry);
}

std::size_t take_choice(const std::filesystem::path& path, VolumeSource& source, FileChoice choice,
                        const std::string& wanted) {
  const auto named = std::ranges::find(choice.entries, wanted);
  if (!wanted.empty() && named != choice.entries.end()) {
    const auto entry = static_cast<std::size_t>(named - choice.entries.begin());
    return select(source, std::move(choice), entry);
  }
  std::optional<std::size_t> number;
  if (!wanted.empty()) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), value);
    if (error != std::errc{} || end != wanted.data() + wanted.size()) {
      refuse(path, choice, wanted);
    }
    number = value;
  }
  return take_choice(path, source, std::move(choice), number);
}

FileChoice numbered_choice(const std::string& name, std::size_t count) {
  FileChoice choice{name, {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    choice.entries.push_back(std::to_string(i));
  }
  return choice;
}

FileChoice checked_choice(const std::filesystem::path& path, const std::string& name,
                          std::uint64_t count) {
  constexpr std::uint64_t kMost = 65536;
  if (count > kMost) {
    throw unsupported(path, "has " + std::to_string(count) + " entries to choose a " + name +
                                " from, expected at most " + std::to_string(kMost));
  }
  return numbered_choice(name, static_cast<std::size_t>(count));
}

}  // namespace isoatlas::detail::io
