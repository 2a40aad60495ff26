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

// A word of a command line.
struct Word {
  std::string text;        ///< without quotes
  bool is_quoted = false;  ///< whether it needs quotes in a shell
};

// The words of a command line in which single quotes and backslashes quote.
std::vector<Word> words_of(const std::string& command) {
  std::vector<Word> words;
  bool is_inside_quotes = false, is_in_word = false;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (c == ' ' && !is_inside_quotes) {
      is_in_word = false;
      continue;
    }
    if (!is_in_word) words.emplace_back();
    is_in_word = true;
    if (c == '\'') {
      is_inside_quotes = !is_inside_quotes;
      words.back().is_quoted = true;
    } else if (c == '\\' && !is_inside_quotes && i + 1 < command.size()) {
      words.back().text += command[++i];
    } else {
      words.back().text += c;
    }
  }
  return words;
}

std::string quoted(const Word& word) {
  if (!word.is_quoted) return word.text;
  std::string out = "'";
  for (const char c : word.text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
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
  for (Word& word : words_of(command)) {
    if (const std::size_t option = option_length(word.text); option > 0)
      word.text = word.text.substr(0, option) + file_name(word.text.substr(option));
    else if (is_value || word.text == volume)
      word.text = file_name(word.text);
    is_value = std::ranges::find(kPathOptions, word.text) != kPathOptions.end();
    out += (out.empty() ? "" : " ") + quoted(word);
  }
  return out;
}

}  // namespace isoatlas::detail::page
