// SPDX-License-Identifier: Apache-2.0
// The parts of `isoatlas view` behind its server.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

#include "isoatlas/error.h"
#include "view/events.h"
#include "view/guard.h"
#include "view/kept_results.h"
#include "view/page_options.h"
#include "view/reduced_volumes.h"
#include "view/viewed_volume.h"

namespace isoatlas::detail::tool {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

// Samples that are a linear function of the index.
struct Ramp {
  std::vector<float> samples;
  VolumeView view;

  explicit Ramp(Size3 size) : samples(size[0] * size[1] * size[2]) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::size_t x = i % size[0], y = i / size[0] % size[1], z = i / (size[0] * size[1]);
      samples[i] = value(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    }
    view = VolumeView::of(samples, size);
    view.grid.spacing = {0.5, 1, 2};
    view.grid.origin = {10, -20, 30};
    view.grid.direction = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
  }
  static float value(double x, double y, double z) {
    return static_cast<float>(x + 100 * y + 10000 * z);
  }
};

// A mean of a linear function is its value at the centre, so samples and positions agree.
TEST(ReducedVolumes, AreMeansAtTheCentresOfTheirBlocks) {
  const Ramp ramp({131, 80, 64});
  const ReducedVolumes reduced(ramp.view);
  ASSERT_EQ(reduced.count(), 3u) << "670,720, 83,200 and 10,240 samples";
  for (std::size_t halvings = 1; halvings < reduced.count(); ++halvings) {
    const VolumeView volume = *reduced.at(halvings, {});
    const Size3 size = volume.grid.size;
    for (const Size3& at :
         {Size3(0, 0, 0), Size3(size[0] - 1, size[1] - 1, size[2] - 1), Size3(1, 2, 3)}) {
      const Vec3 world = volume.grid.to_world(
          {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])});
      const Vec3 index = ramp.view.grid.to_index(world);
      const VolumeView one = volume.box(at, at);
      EXPECT_FLOAT_EQ(*static_cast<const float*>(one.samples),
                      Ramp::value(index.x, index.y, index.z));
    }
  }
}

TEST(ReducedVolumes, LeaveShortAxesAsTheyAre) {
  const Ramp ramp({300, 300, 3});
  const ReducedVolumes reduced(ramp.view);
  const VolumeView last = *reduced.at(reduced.count() - 1, {});
  EXPECT_EQ(last.grid.size[2], 3u);
  EXPECT_LT(last.grid.size[0], 300u);
}

TEST(ReducedVolumes, GiveTheRegionOfInterest) {
  const Ramp ramp({64, 64, 64});
  const ReducedVolumes reduced(ramp.view);
  Region region;
  region.first = {10, 20, 0};
  region.last = {29, Region::kEnd, 63};
  const VolumeView whole = *reduced.at(0, region), half = *reduced.at(1, region);
  EXPECT_EQ(whole.grid.size, Size3(20, 44, 64));
  EXPECT_EQ(half.grid.size, Size3(10, 22, 32));
  EXPECT_EQ(*static_cast<const float*>(half.samples), Ramp::value(10.5, 20.5, 0.5));
  region.last = {11, 63, 63};
  EXPECT_FALSE(reduced.at(1, region)) << "one sample along x is left";
}

TEST(ReducedVolumes, MeanOfFiniteSamples) {
  std::vector<double> samples(64 * 64 * 64, 3);
  samples[0] = std::numeric_limits<double>::quiet_NaN();
  samples[1] = std::numeric_limits<double>::infinity();
  for (std::size_t x = 2; x < 4; ++x)
    for (std::size_t y = 0; y < 2; ++y)
      for (std::size_t z = 0; z < 2; ++z)
        samples[x + 64 * (y + 64 * z)] = std::numeric_limits<double>::quiet_NaN();
  const VolumeView view = VolumeView::of(samples, {64, 64, 64});
  const ReducedVolumes reduced(view);
  const auto* half = static_cast<const float*>(reduced.at(1, {})->samples);
  EXPECT_EQ(half[0], 3);
  EXPECT_TRUE(std::isnan(half[1]));
  EXPECT_EQ(half[2], 3);
}

TEST(CountCrossings, CountsPairsOfNeighbours) {
  const Ramp ramp({10, 10, 10});
  // Of the 9 x 9 x 9 samples with three neighbours each, those at x = 4 cross 4.5 in the first row.
  EXPECT_EQ(count_crossings(ramp.view, 4.5), 1u + 1 + 1 + 4 + 4) << "x, and steps in y and z";
  EXPECT_EQ(count_crossings(ramp.view, -1), 0u);
  EXPECT_EQ(count_crossings(ramp.view.box({0, 0, 0}, {8, 8, 8}), 4.5, 4),
            4 * count_crossings(ramp.view.box({0, 0, 0}, {8, 8, 1}), 4.5));
}

TEST(SliceSamples, HaveTheEarlierAxisFirst) {
  const Ramp ramp({4, 3, 2});
  const auto floats = [&](std::size_t axis, std::size_t index) {
    const std::string bytes = slice_samples(ramp.view, axis, index);
    std::vector<float> out(bytes.size() / 4);
    std::memcpy(out.data(), bytes.data(), bytes.size());
    return out;
  };
  using Floats = std::vector<float>;
  EXPECT_EQ(floats(0, 3), (Floats{3, 103, 203, 10003, 10103, 10203}));
  EXPECT_EQ(floats(1, 2), (Floats{200, 201, 202, 203, 10200, 10201, 10202, 10203}));
  EXPECT_EQ(floats(2, 1).size(), 12u);
  EXPECT_THROW(floats(0, 4), Error);
  EXPECT_THROW(floats(3, 0), Error);
}

ViewArguments opened(const std::string& path) {
  ViewArguments out;
  out.volume.path = path;
  return out;
}

TEST(ExtractWords, AreTheCommandLine) {
  const Words words = extract_words(
      opened("a b.nrrd"), {{"iso", "-3.5"}, {"coarse", ""}, {"keep-near", "1,2,3"}}, "a.ply");
  EXPECT_EQ(words, (Words{"extract", "a b.nrrd", "--iso=-3.5", "--coarse", "--keep-near", "1,2,3",
                          "-o", "a.ply"}));
  const ExtractArguments parsed = parse_extract(words);
  EXPECT_EQ(parsed.options.surface.isovalue, -3.5);
  EXPECT_TRUE(parsed.coarse);
  EXPECT_EQ(parsed.options.components.keep_near, (std::vector<Vec3>{{1, 2, 3}}));
}

TEST(ExtractWords, TakeNoPathForAnOption) {
  const Words words = extract_words(opened("-a.nrrd"), {{"iso", "1"}}, "-a.ply");
  EXPECT_EQ(words, (Words{"extract", "./-a.nrrd", "--iso", "1", "-o", "./-a.ply"}));
  EXPECT_EQ(parse_extract(words).volume.path, "./-a.nrrd");
}

// A page names no file, neither as an option nor within the value of one.
TEST(ExtractWords, RefuseOptionsThatNameFiles) {
  for (const char* name : {"output", "o", "report", "html", "format", "channel", "-o", "", "iso=3",
                           "raw-size", "quiet", "help"})
    EXPECT_THROW(extract_words(opened("a.nrrd"), {{"iso", "1"}, {name, "x"}}, "a.ply"), Error)
        << name;
  for (const char* value : {"--report=x", "-ox", "--html", "1 -o x", "1\n--report"}) {
    const Words words = extract_words(opened("a.nrrd"), {{"iso", value}}, "a.ply");
    EXPECT_THROW(parse_extract(words), Error) << value;
  }
}

TEST(ExtractWords, RepeatTheOptionsOfTheVolume) {
  ViewArguments volume = opened("a.nrrd");
  volume.reading = {"--channel", "GFP", "--roi", "10:19,:,5:"};
  set(volume.volume.read, "roi", "10:19,:,5:");
  EXPECT_EQ(extract_words(volume, {{"iso", "1"}}, "a.ply"),
            (Words{"extract", "a.nrrd", "--iso", "1", "--channel", "GFP", "--roi",
                   "10:19,:,5:", "-o", "a.ply"}));
  EXPECT_EQ(extract_words(volume, {{"iso", "1"}, {"roi", "2:5,:,1:3"}}, "a.ply"),
            (Words{"extract", "a.nrrd", "--iso", "1", "--roi", "12:15,0:,6:8", "--channel", "GFP",
                   "-o", "a.ply"}))
      << "counted from the first sample that was read";
}

TEST(RegionOf, IsInsideTheVolume) {
  const Size3 size(10, 20, 30);
  EXPECT_FALSE(region_of({{"iso", "1"}}, size));
  const auto region = region_of({{"roi", "2:5,:,7:"}}, size);
  ASSERT_TRUE(region);
  EXPECT_EQ(region->first, Size3(2, 0, 7));
  for (const char* bad : {"9:3,:,:", "4:4,:,:", "0:10,:,:", ":,30:,:", "1:2", "a:b,:,:", ""})
    EXPECT_THROW(region_of({{"roi", bad}}, size), Error) << bad;
}

TEST(MeshName, IsThatOfTheVolume) {
  EXPECT_EQ(mesh_name(opened("/scans/head.nii.gz"), "3mf"), "head.3mf");
  EXPECT_EQ(mesh_name(opened("/scans/series/"), "ply"), "mesh.ply");
  for (const char* bad : {"exe", "", "../x", "vtm", "PLY "})
    EXPECT_THROW(mesh_name(opened("a.nrrd"), bad), Error) << bad;
}

TEST(Guard, AcceptsOnlyThePage) {
  const Guard guard(8080), other(8080);
  EXPECT_NE(guard.base(), other.base());
  EXPECT_EQ(guard.base().size(), 34u);
  const std::string path = guard.base() + "volume", host = "127.0.0.1:8080";
  const auto is_accepted = [&](const RequestOrigin& from) { return guard.refusal(from).empty(); };
  EXPECT_TRUE(is_accepted({path, host, "", "", ""}));
  EXPECT_TRUE(is_accepted({path, host, "http://" + host, "same-origin", "empty"}));
  EXPECT_TRUE(is_accepted({path, "localhost:8080", "http://localhost:8080", "", ""}));
  EXPECT_TRUE(is_accepted({guard.base(), host, "", "cross-site", "document"})) << "a link";
  for (const RequestOrigin& from : {RequestOrigin{path, "", "", "", ""},
                                    {path, "127.0.0.1", "", "", ""},
                                    {path, "evil.example:8080", "", "", ""},
                                    {path, "127.0.0.1:8080.evil.example", "", "", ""},
                                    {path, host, "null", "", ""},
                                    {path, host, "http://evil.example", "", ""},
                                    {path, host, "https://127.0.0.1:8080", "", ""},
                                    {path, host, "http://localhost:8080", "", ""},
                                    {path, host, "", "cross-site", "empty"},
                                    {path, host, "", "cross-site", "document"},
                                    {path, host, "", "same-site", ""},
                                    {"/", host, "", "", ""},
                                    {"/volume", host, "", "", ""},
                                    {other.base() + "volume", host, "", "", ""},
                                    {guard.base().substr(0, 33), host, "", "", ""}})
    EXPECT_FALSE(is_accepted(from)) << from.path << " " << from.host << " " << from.origin;
}

// Browsers leave the port of HTTP out of Host and Origin.
TEST(Guard, AcceptsThePageAtThePortOfHttp) {
  const Guard guard(80);
  EXPECT_EQ(guard.refusal({guard.base(), "127.0.0.1", "http://127.0.0.1", "", ""}), "");
  EXPECT_NE(guard.refusal({guard.base(), "evil.example", "", "", ""}), "");
}

TEST(Events, ReachEachPageFromWhenItOpens) {
  Events events;
  events.send("early");
  Events::Number first = events.open();
  EXPECT_EQ(events.wait(first, 0ms), "");
  events.send("1");
  Events::Number second = events.open();
  events.send("2");
  EXPECT_EQ(events.wait(first, 0ms), "id: 1\ndata: 1\n\nid: 2\ndata: 2\n\n");
  EXPECT_EQ(events.wait(second, 0ms), "id: 2\ndata: 2\n\n");
  EXPECT_EQ(events.wait(second, 0ms), "");
  for (int i = 0; i < 10'000; ++i) events.send("n");
  const std::string kept = events.wait(first, 0ms);
  EXPECT_TRUE(kept.starts_with("id: 9503\n")) << "the last 500 of 10,003";
  EXPECT_TRUE(kept.ends_with("id: 10002\ndata: n\n\n"));
}

TEST(Events, ReachAPageWhoseConnectionWasBroken) {
  Events events;
  for (const char* text : {"a", "b", "c"}) events.send(text);
  Events::Number next = events.open(0);
  EXPECT_EQ(events.wait(next, 0ms), "id: 1\ndata: b\n\nid: 2\ndata: c\n\n");
  for (const Events::Number last : {Events::Number{2}, Events::Number{3}, ~Events::Number{0}}) {
    next = events.open(last);
    EXPECT_EQ(events.wait(next, 0ms), "") << last;
  }
  for (int i = 0; i < 600; ++i) events.send("n");
  next = events.open(0);
  EXPECT_TRUE(events.wait(next, 0ms).starts_with("id: 103\n")) << "the first that is kept";
}

TEST(Events, EndWithTheLastPage) {
  Events events;
  EXPECT_FALSE(events.all_closed_for(-1s)) << "none has been open yet";
  events.open();
  events.open();
  events.close();
  EXPECT_FALSE(events.all_closed_for(-1s));
  events.close();
  EXPECT_TRUE(events.all_closed_for(-1s));
  EXPECT_FALSE(events.all_closed_for(1h));
  events.open();
  EXPECT_FALSE(events.all_closed_for(-1s)) << "loaded again";
}

TEST(KeptResults, ForgetTheFirst) {
  KeptResults<int> results(2);
  const auto a = results.keep(1), b = results.keep(2), c = results.keep(3);
  EXPECT_EQ(results.get(a), std::nullopt);
  EXPECT_EQ(results.get(b), 2);
  EXPECT_EQ(results.get(c), 3);
  EXPECT_EQ(results.get(c + 1), std::nullopt);
}

}  // namespace
}  // namespace isoatlas::detail::tool
