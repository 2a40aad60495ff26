// SPDX-License-Identifier: Apache-2.0
#include "page/file_names.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

namespace isoatlas::detail::page {
namespace {

// The options of `isoatlas extract` whose values are paths.
constexpr std::array<std::string_view, 4> kPathOptions{"-o", "--output", "--report", "--html"};

// The words of a command line in which single quotes and backslashes quote, without quotes.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  bool is_inside_quotes = false, is_in_word = false;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (c == ' ' && !is_inside_quotes) {
      is_in_word = false;
      continue;
    }
    if (!is_in_word) words.emplace_back();
    is_in_word = true;
    if (c == '\'')
      is_inside_quotes = !is_inside_quotes;
    else if (c == '\\' && !is_inside_quotes && i + 1 < command.size())
      words.back() += command[++i];
    else
      words.back() += c;
  }
  return words;
}

// A word for a shell, with quotes if it needs them.
std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// The number of characters of an option before a path in the same word: 9 of "--output=a.ply", 2 of
// "-oa.ply"; 0: none.
std::size_t option_length(const std::string& word) {
  for (const std::string_view option : kPathOptions) {
    const bool is_long = option.starts_with("--");
    if (word.size() > option.size() && word.starts_with(option) &&
        (!is_long || word[option.size()] == '='))
      return option.size() + (is_long ? 1 : 0);
  }
  return 0;
}

}  // namespace

std::string file_name(const std::string& path) {
  const std::filesystem::path whole(path);
  const std::string name = whole.filename().string();
  return name.empty() ? whole.parent_path().filename().string() : name;
}

std::string with_file_names(const std::string& command, const std::string& volume) {
  std::string out;
  bool is_value = false;  // of an option whose value is a path
  for (std::string& word : words_of(command)) {
    if (const std::size_t option = option_length(word); option > 0)
      word = word.substr(0, option) + file_name(word.substr(option));
    else if (is_value || word == volume)
      word = file_name(word);
    is_value = std::ranges::find(kPathOptions, word) != kPathOptions.end();
    out += (out.empty() ? "" : " ") + shell_word(word);
  }
  return out;
}

}  // namespace isoatlas::detail::page
