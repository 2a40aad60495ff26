// SPDX-License-Identifier: Apache-2.0
#include "command_words.h"

#include <cctype>

namespace isoatlas::detail::tool {
namespace {

class Reader {
 public:
  Reader(const CLI::App& command, const std::vector<std::string>& words)
      : command_(command), words_(words) {}

  CommandWords read() {
    bool only_positionals = false;
    for (; next_ < words_.size(); ++next_) {
      const std::string& word = words_[next_];
      if (only_positionals || !is_option_like(word)) {
        read_.positionals.push_back({word, value_ended_at_ == next_
                                               ? std::optional(read_.options.size() - 1)
                                               : std::nullopt});
      } else if (word == "--") {
        only_positionals = true;
      } else if (word.starts_with("--") || is_misspelt_long_name(word)) {
        read_long(word);
      } else {
        read_short(word);
      }
    }
    return std::move(read_);
  }

 private:
  // "-iso", "-iso=100": a long name with one dash. "-oout.ply" is an option with its value.
  bool is_misspelt_long_name(const std::string& word) const {
    const std::string name = word.substr(1, word.find('=') - 1);
    return name.size() > 1 && command_.get_option_no_throw("--" + name) != nullptr;
  }

  void read_long(const std::string& word) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const CLI::Option* option =
        name.starts_with("--") ? command_.get_option_no_throw(name) : nullptr;
    if (option != nullptr && option->get_positional()) option = nullptr;
    add(name, option,
        equals == std::string::npos ? std::nullopt : std::optional(word.substr(equals + 1)));
  }

  // Flags may share a dash. The rest of the word after an option that takes a value is its value.
  void read_short(const std::string& word) {
    for (std::size_t i = 1; i < word.size(); ++i) {
      const CLI::Option* option = command_.get_option_no_throw(std::string("-") + word[i]);
      if (option == nullptr)
        return add(i == 1 ? word : std::string("-") + word[i], nullptr, std::nullopt);
      const bool is_last = i + 1 == word.size();
      const bool has_value = takes_value(*option) && !is_last;
      add(std::string("-") + word[i], option,
          has_value ? std::optional(word.substr(i + 1)) : std::nullopt);
      if (has_value) return;
    }
  }

  void add(const std::string& name, const CLI::Option* option, std::optional<std::string> value) {
    const std::string& typed = words_[next_];
    const bool wants_word = option != nullptr && takes_value(*option) && !value;
    if (wants_word && next_ + 1 < words_.size() && !is_option_like(words_[next_ + 1]))
      value = words_[++next_];
    if (value) value_ended_at_ = next_ + 1;
    read_.options.push_back({name, option, std::move(value), typed});
  }

  const CLI::App& command_;
  const std::vector<std::string>& words_;
  std::size_t next_ = 0;
  std::optional<std::size_t> value_ended_at_;  // index of the word after the last value
  CommandWords read_;
};

}  // namespace

bool is_option_like(std::string_view word) {
  if (word.size() < 2 || word[0] != '-') return false;
  return std::isdigit(static_cast<unsigned char>(word[1])) == 0 && word[1] != '.' &&
         word != "-inf" && word != "-nan";
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

CommandWords read_words(const CLI::App& command, const std::vector<std::string>& words) {
  return Reader(command, words).read();
}

}  // namespace isoatlas::detail::tool
