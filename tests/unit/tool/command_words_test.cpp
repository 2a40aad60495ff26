// SPDX-License-Identifier: Apache-2.0
#include "command_words.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "arguments.h"

namespace isoatlas::detail::tool {
namespace {

// Options with their names and values, then positional words: "--iso=0 -o=a.ply -q | v.nrrd". A "?"
// marks unknown options; "<" marks words after a value of an option.
std::string read(const std::vector<std::string>& words) {
  CLI::App app;
  describe_tool(app);
  ExtractArguments arguments;
  const CommandWords found = read_words(*add_extract_command(app, arguments), words);
  std::string text;
  for (const OptionWord& word : found.options)
    text += word.name + (word.option ? "" : "?") + (word.value ? "=" + *word.value : "") + " ";
  text += "|";
  for (const PositionalWord& word : found.positionals)
    text += " " + word.text +
            (word.after_value_of ? "<" + found.options[*word.after_value_of].name : "");
  return text;
}

TEST(CommandWords, AreReadAsByCli11) {
  EXPECT_EQ(read({}), "|");
  EXPECT_EQ(read({"v.nrrd", "--iso", "-300", "-o", "a.ply"}), "--iso=-300 -o=a.ply | v.nrrd");
  EXPECT_EQ(read({"--iso=-.5", "-oa.ply", "-q", "v.nrrd"}), "--iso=-.5 -o=a.ply -q | v.nrrd");
  EXPECT_EQ(read({"-qo", "a.ply"}), "-q -o=a.ply |");
  EXPECT_EQ(read({"-qoa.ply"}), "-q -o=a.ply |");
  EXPECT_EQ(read({"-o", "-"}), "-o=- |");
  EXPECT_EQ(read({"-", "--", "-v.nrrd", "--iso"}), "| - -v.nrrd --iso");
}

TEST(CommandWords, OfWrongCommandLines) {
  EXPECT_EQ(read({"--report", "--html", "a.html"}), "--report --html=a.html |");
  EXPECT_EQ(read({"--iso"}), "--iso |");
  EXPECT_EQ(read({"--frob", "3"}), "--frob? | 3");
  EXPECT_EQ(read({"-iso", "3"}), "-iso? | 3");
  EXPECT_EQ(read({"-output=a.ply"}), "-output?=a.ply |");
  EXPECT_EQ(read({"-qz"}), "-q -z? |");
  EXPECT_EQ(read({"--VOLUME", "VOLUME"}), "--VOLUME? | VOLUME");
  EXPECT_EQ(read({"v", "--max-distance", "0.5", "mm", "x"}),
            "--max-distance=0.5 | v mm<--max-distance x");
}

TEST(CommandWords, NumbersAreNotOptions) {
  for (const char* word : {"-o", "--iso", "-x1", "--", "-inv"})
    EXPECT_TRUE(is_option_like(word)) << word;
  for (const char* word : {"", "-", "-1", "-.5", "-1,0,0", "-inf", "a-b", "o"})
    EXPECT_FALSE(is_option_like(word)) << word;
}

}  // namespace
}  // namespace isoatlas::detail::tool
