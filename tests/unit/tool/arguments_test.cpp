// SPDX-License-Identifier: Apache-2.0
#include "arguments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "completion.h"

namespace isoatlas::detail::tool {
namespace {

using enum Quantity;
using Goals = std::vector<std::vector<TypedConstraint>>;

// Parses `isoatlas extract v.nrrd --iso 1 -o m.ply` followed by `words`.
ExtractArguments parsed(std::vector<std::string> words) {
  CLI::App app;
  describe_tool(app);
  ExtractArguments arguments;
  add_extract_command(app, arguments);
  words.insert(words.begin(), {"extract", "v.nrrd", "--iso", "1", "-o", "m.ply"});
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return arguments;
}

TEST(ExtractArguments, PriorityIsTheOrderOnTheCommandLine) {
  EXPECT_EQ(parsed({"--max-vertices", "500", "--refine", "max-distance:0.5vx"}).goals.refine,
            (Goals{{{max_vertices, 500}, {max_distance, 0.5, true}}}));
  EXPECT_EQ(parsed({"--refine", "max-distance:0.5vx", "--max-vertices", "500"}).goals.refine,
            (Goals{{{max_distance, 0.5, true}, {max_vertices, 500}}}));
  // The order of declaration does not matter, nor does the syntax --name=value or --name value.
  EXPECT_EQ(
      parsed({"--min-aspect=0.2", "--refine=max-distance:2", "--normal-angle=9", "--min-edge", "1"})
          .goals.refine,
      (Goals{{{min_aspect, 0.2}, {max_distance, 2}, {normal_angle, 9}, {min_edge, 1}}}));
}

TEST(ExtractArguments, EveryQuantityIsAnOption) {
  for (std::size_t i = 0; i < kQuantityCount; ++i) {
    const auto quantity = static_cast<Quantity>(i);
    const std::string bound = quantity == min_aspect ? "0.5" : "7";
    const auto arguments = parsed({"--coarse", "--" + std::string(name(quantity)), bound});
    ASSERT_EQ(arguments.goals.coarse.size(), 1U);
    EXPECT_EQ(arguments.goals.coarse[0].quantity, quantity);
  }
}

TEST(ExtractArguments, RefineCanBeRepeated) {
  const auto goals = parsed({"--refine", "max-distance:2vx", "--min-aspect=0.2",
                             "--refine=max-distance:1vx,max-vertices:2000", "--placement",
                             "balanced", "--refine", "normal-angle:10deg"})
                         .goals.refine;
  EXPECT_EQ(goals, (Goals{{{max_distance, 2, true}, {min_aspect, 0.2}},
                          {{min_aspect, 0.2}, {max_distance, 1, true}, {max_vertices, 2000}},
                          {{min_aspect, 0.2}, {normal_angle, 10}}}));
}

TEST(ExtractArguments, Refusals) {
  const auto refusal = [](const std::vector<std::string>& words) -> std::string {
    try {
      parsed(words);
    } catch (const CLI::ParseError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(refusal({"--max-edge", "0"}),
            "--max-edge: expected a length above 0 like 0.5vx, 2mm or 2, got '0'");
  EXPECT_EQ(refusal({"--refine", "max-edge:0"}),
            "--refine: max-edge: expected a length above 0 like 0.5vx, 2mm or 2, got '0'");
  EXPECT_EQ(refusal({"--refine", "max-edge:1", "--max-edge", "1"}),
            "max-edge is given twice for level 1, expected once");
  EXPECT_NE(refusal({"--refine", "max-edge:1", "max-edge:2"}), "no error");
  EXPECT_NE(refusal({"--max-edge", "1", "--max-edge", "2"}), "no error");
  EXPECT_NE(refusal({"--refine"}), "no error");
}

TEST(ExtractArguments, Measure) {
  EXPECT_EQ(parsed({}).options.measure_samples, 0U);
  EXPECT_EQ(parsed({"--measure"}).options.measure_samples, 200'000U);
  EXPECT_EQ(parsed({"--measure-samples", "12"}).options.measure_samples, 12U);
}

// Every word that the shell completes is accepted by its option.
TEST(Completion, OptionsAcceptTheWords) {
  CLI::App app;
  ExtractArguments extract;
  InfoArguments info;
  CheckArguments check;
  std::size_t words = 0;
  for (CLI::App* command : {add_extract_command(app, extract), add_info_command(app, info),
                            add_check_command(app, check)}) {
    for (CLI::Option* option : command->get_options()) {
      for (const std::string_view word : words_of(*option)) {
        option->clear();
        option->add_result(std::string(word));
        EXPECT_NO_THROW(option->run_callback())
            << command->get_name() << " " << option->get_name() << " " << word;
        ++words;
      }
      if (words_of(*option).empty()) continue;
      option->clear();
      option->add_result("nonsense");
      EXPECT_THROW(option->run_callback(), CLI::ValidationError) << option->get_name();
    }
  }
  EXPECT_GT(words, 40U);
}

}  // namespace
}  // namespace isoatlas::detail::tool
