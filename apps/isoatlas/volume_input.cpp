// SPDX-License-Identifier: Apache-2.0
#include "volume_input.h"

#include <ostream>

#include "isoatlas/error.h"
#include "text.h"

namespace isoatlas::detail::tool {

namespace {

template <class Read>
auto naming_options(Read read) {
  try {
    return read();
  } catch (const ChoiceNeeded& needed) {
    const std::string option = "--" + needed.choice().name;
    throw ChoiceNeeded(
        needed.what() + ("; choose with " + option + ", for example " + option + " 0"),
        needed.choice(), needed.source());
  }
}

}  // namespace

VolumeFile read_volume_input(const std::filesystem::path& path, const ReadOptions& options) {
  return naming_options([&] { return read_volume_file(path, options); });
}

VolumeReader open_volume_input(const std::filesystem::path& path, const ReadOptions& options) {
  return naming_options([&] { return VolumeReader(path, options); });
}

std::string volume_name(const std::filesystem::path& path) {
  return path == "-" ? "standard input" : path.string();
}

void print_warnings(std::ostream& out, const std::filesystem::path& path,
                    const VolumeSource& source) {
  for (const std::string& warning : source.warnings)
    out << one_line("isoatlas: warning: " + volume_name(path) + ": " + warning) << "\n";
}

std::string choice_text(const FileChoice& choice) {
  const std::string count = std::to_string(choice.entries.size());
  if (!choice.selected) return count + ", choose one with --" + choice.name;
  const std::string& entry = choice.entries[*choice.selected];
  const std::string number = std::to_string(*choice.selected);
  return number + (entry == number ? "" : " (" + entry + ")") + " of " + count;
}

}  // namespace isoatlas::detail::tool
