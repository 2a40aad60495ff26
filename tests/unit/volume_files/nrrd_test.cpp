// SPDX-License-Identifier: Apache-2.0
// NRRD: the features of the format, file by file. https://teem.sourceforge.net/nrrd/format.html
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/one_file.h"

namespace isoatlas::detail::test {
namespace {

using NrrdFile = OneFile;

constexpr ErrorCode kBad = ErrorCode::bad_file;
constexpr ErrorCode kUnsupported = ErrorCode::unsupported;

// 2 x 3 x 4 samples of one byte, spacing 0.5 1 2 unless `more` states another.
const std::string kSpacing = "spacings: 0.5 1 2\n";
std::string small(const std::string& more = kSpacing, const std::string& body = counted(24),
                  const std::string& encoding = "raw") {
  return "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nencoding: " + encoding + "\n" + more +
         "\n" + body;
}

std::string header(const std::string& lines) {
  return "NRRD0005\ntype: uint8\nencoding: raw\n" + lines;
}

// ---- field files

TEST(NrrdField, SpaceLasNegatesY) {
  const VolumeFile file = read_volume_file(kField / "r_sp_las.nrrd");
  const Grid& grid = file.volume.view.grid;
  EXPECT_EQ(grid.size, (std::array<std::size_t, 3>{24, 20, 16}));
  EXPECT_EQ(grid.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(grid.origin, (Vec3{10, -20, 30}));
  EXPECT_EQ(grid.direction, (std::array<Vec3, 3>{Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}}));
  EXPECT_EQ(grid.unit, LengthUnit::millimetre);
  EXPECT_EQ(samples_of(file.volume), read_bytes(kField / "r_det.raw"));
  EXPECT_EQ(file.source.warnings, Strings{});
}

TEST(NrrdField, SpacingFromTheEndsOfTheAxes) {
  const VolumeFile file = read_volume_file(kField / "r_axmins.nrrd");
  EXPECT_EQ(file.volume.view.grid.spacing,
            (Vec3{1, 1, 2}));  // node-centred: 23 / 23, 19 / 19, 30 / 15
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{0, 0, 0}));
  EXPECT_EQ(samples_of(file.volume), read_bytes(kField / "r_det.raw"));
  EXPECT_EQ(decision(file, "spacing"), "from axis mins and maxs, centerings node node node");
  EXPECT_EQ(file.source.warnings, Strings{});
}

TEST(NrrdField, ALongerDataFileGivesAWarning) {
  const VolumeFile file = read_volume_file(kField / "r_det_longer.nhdr");
  EXPECT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{24, 20, 15}));
  EXPECT_EQ(samples_of(file.volume), read_bytes(kField / "r_det.raw").substr(0, 28800));
  ASSERT_EQ(file.source.warnings.size(), 2u);
  EXPECT_EQ(file.source.warnings[0],
            "its data file r_det.raw has 1920 bytes after the last sample that the header states");
  EXPECT_EQ(file.source.warnings[1], "states no voxel size; 1 x 1 x 1 is assumed");
}

TEST(NrrdField, Bzip2) {
  const VolumeFile file = read_volume_file(kField / "r_bz2.nrrd");
  EXPECT_EQ(samples_of(file.volume), read_bytes(kField / "r_det.raw"));
  EXPECT_NE(file.source.reader.find("bzip2 1."), std::string::npos);
}

TEST(NrrdField, SegmentationLayersAreAChoice) {
  const auto path = kField / "r_seg2.seg.nrrd";
  expect_error(kUnsupported, "has 2 layers, expected a choice of one: 0, 1", path,
               [&] { read_volume_file(path); });
  const VolumeFile file = read_volume_file(path, {.layer = "1"});
  EXPECT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{24, 20, 16}));
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::millimetre);
  const std::string samples = samples_of(file.volume);
  EXPECT_EQ(std::count(samples.begin(), samples.end(), '\1'),
            606);  // 1212 in both layers, which are equal
  EXPECT_EQ(std::count(samples.begin(), samples.end(), '\0'), 7680 - 606);
  expect_error(ErrorCode::bad_argument, "no layer '2'", path,
               [&] { read_volume_file(path, {.layer = "2"}); });
}

// ---- geometry

struct SpaceCase {
  std::string name;
  double x, y;  // signs of the file's x and y in LPS
  LengthUnit unit;
};

TEST(NrrdSpace, EveryName) {
  const LengthUnit mm = LengthUnit::millimetre, none = LengthUnit::unknown;
  const std::vector<SpaceCase> cases{{"right-anterior-superior", -1, -1, mm},
                                     {"RAS", -1, -1, mm},
                                     {"Right Anterior Superior", -1, -1, mm},
                                     {"left-anterior-superior", 1, -1, mm},
                                     {"LAS", 1, -1, mm},
                                     {"left-posterior-superior", 1, 1, mm},
                                     {"lps", 1, 1, mm},
                                     {"scanner-xyz", 1, 1, mm},
                                     {"3D-right-handed", 1, 1, none},
                                     {"3D-left-handed", 1, 1, none}};
  for (const SpaceCase& space : cases) {
    SCOPED_TRACE(space.name);
    const VolumeFile file =
        NrrdFile(small("space: " + space.name +
                       "\nspace directions: (0,2,0) (3,0,0) (0,0,4)\nspace origin: (10,20,30)\n"))
            .file();
    const Grid& grid = file.volume.view.grid;
    EXPECT_EQ(grid.spacing, (Vec3{2, 3, 4}));
    EXPECT_EQ(grid.origin, (Vec3{10 * space.x, 20 * space.y, 30}));
    EXPECT_EQ(grid.direction,
              (std::array<Vec3, 3>{Vec3{0, space.y, 0}, Vec3{space.x, 0, 0}, Vec3{0, 0, 1}}));
    EXPECT_EQ(grid.unit, space.unit);
    EXPECT_EQ(decision(file, "space"), space.name);
    EXPECT_EQ(file.source.warnings.size(), space.name == "3D-left-handed" ? 1u : 0u);
  }
  NrrdFile(small("space: up-and-down\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"))
      .expect_refused(kUnsupported, "a space called 'up-and-down'");
}

TEST(NrrdSpace, TimeIsAFourthDimension) {
  for (const auto& [name, y] : {std::pair{"left-anterior-superior-time", -1.0},
                                {"LPST", 1.0},
                                {"scanner-xyzt", 1.0},
                                {"3D-right-handed-time", 1.0}}) {
    SCOPED_TRACE(name);
    const NrrdFile nrrd(header("dimension: 4\nsizes: 2 3 4 2\nspace: " + std::string(name) +
                               "\nspace directions: (1,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,0,7)\nspace "
                               "origin: (1,2,3,0)\n\n") +
                        counted(48));
    nrrd.expect_refused(kUnsupported, "has 2 time points, expected a choice of one: 0, 1");
    const VolumeFile file = nrrd.file({.time = 1});
    EXPECT_EQ(samples_of(file.volume), counted(24, 24));
    EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{1, 2, 3}));
    EXPECT_EQ(file.volume.view.grid.origin, (Vec3{1, 2 * y, 3}));
    EXPECT_EQ(file.volume.view.grid.direction[1], (Vec3{0, y, 0}));
  }
  NrrdFile(header("dimension: 4\nsizes: 2 3 4 2\nspace: LPST\nspace directions: (1,0,0,1) "
                  "(0,2,0,0) (0,0,3,0) (0,0,0,7)\n\n") +
           counted(48))
      .expect_refused(kUnsupported, "x axis runs through both space and time");
}

TEST(NrrdSpace, DimensionAlone) {
  const VolumeFile file =
      NrrdFile(small("space dimension: 3\nspace directions: (0.5,0,0) (0,1,0) ( 0 , 0 , 2 )\n"))
          .file();
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.5, 1, 2}));
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::unknown);
  EXPECT_EQ(decision(file, "space"), "none");
  NrrdFile(small("space dimension: 2\nspace directions: (0.5,0) (0,1) (1,1)\n"))
      .expect_refused(kUnsupported, "a space of 2 dimensions");
  NrrdFile(small(kSpacing + "space dimension: 5\n"))
      .expect_refused(kUnsupported, "a space of 5 dimensions");
  NrrdFile(small("space: LPS\nspace dimension: 4\n"))
      .expect_refused(kBad, "'space dimension' is '4'");
}

TEST(NrrdSpace, ShearedAxesStayAsTheyAre) {
  const Grid grid =
      NrrdFile(small("space dimension: 3\nspace directions: (1,0,0) (1,1,0) (0,0,1)\n"))
          .file()
          .volume.view.grid;
  EXPECT_DOUBLE_EQ(grid.spacing.y, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(grid.direction[1].x, std::sqrt(0.5));
  NrrdFile(small("space dimension: 3\nspace directions: (1,0,0) (2,0,0) (0,0,1)\n"))
      .expect_refused(kBad, "lie in a plane");
  NrrdFile(small("space dimension: 3\nspace directions: (1,0,0) (0,0,0) (0,0,1)\n"))
      .expect_refused(kBad, "direction of the y axis");
}

TEST(NrrdSpace, WrongVectors) {
  const std::string space = "space dimension: 3\n";
  NrrdFile(small(space + "space directions: (1,0,0) (0,1,0)\n"))
      .expect_refused(kBad, "expected 3 vectors");
  NrrdFile(small(space + "space directions: (1,0,0) (0,1) (0,0,1)\n"))
      .expect_refused(kBad, "vectors of 3 numbers");
  NrrdFile(small(space + "space directions: (1,0,0) (0,nan,1) (0,0,1)\n"))
      .expect_refused(kBad, "vectors of 3 numbers");
  NrrdFile(small(space + "space directions: (1,0,0) (0,1,0) (0,0,x)\n"))
      .expect_refused(kBad, "vectors of 3 numbers");
  NrrdFile(small(space + "space directions: (1,0,0) (0,1,0) (0,0,1\n"))
      .expect_refused(kBad, "vectors of 3 numbers");
  NrrdFile(small(space + "space directions: (inf,0,0) (0,1,0) (0,0,1)\n"))
      .expect_refused(kBad, "x axis");
  NrrdFile(small("space directions: (1,0,0) (0,1,0) (0,0,1)\n"))
      .expect_refused(kBad, "vectors of 0 numbers");
  NrrdFile(small(space + "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (1,inf,2)\n"))
      .expect_refused(kBad, "origin");
}

TEST(NrrdSpace, SpacingsAndDirections) {
  const VolumeFile both =
      NrrdFile(small("space: RAS\nspacings: 7 7 7\nspace directions: (1,0,0) (0,2,0) (0,0,3)\n"))
          .file();
  EXPECT_EQ(both.volume.view.grid.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(both.source.warnings,
            Strings{"states both spacings and space directions; the space directions are used"});
  const VolumeFile without =
      NrrdFile(small("space: RAS\nspacings: 7 8 9\nspace origin: (1,2,3)\n")).file();
  EXPECT_EQ(without.volume.view.grid.spacing, (Vec3{7, 8, 9}));
  EXPECT_EQ(without.volume.view.grid.origin, (Vec3{-1, -2, 3}));
  EXPECT_EQ(without.volume.view.grid.direction[0], (Vec3{-1, 0, 0}));
  EXPECT_EQ(without.source.warnings,
            Strings{"states no space directions, axes along those of its space (RAS) are assumed"});
}

TEST(NrrdSpacing, FromAxisMinsAndMaxs) {
  const auto grid = [](const std::string& more) {
    return NrrdFile(small(more)).file().volume.view.grid;
  };
  const std::string ends = "axis mins: 10 0 -4\naxis maxs: 20 6 4\n";
  EXPECT_EQ(grid(ends + "centerings: node node node\n").spacing, (Vec3{10, 3, 8.0 / 3}));
  EXPECT_EQ(grid(ends + "centers: node node node\n").origin, (Vec3{10, 0, -4}));
  EXPECT_EQ(grid(ends + "centerings: cell cell cell\n").spacing, (Vec3{5, 2, 2}));
  EXPECT_EQ(grid(ends + "centerings: cell cell cell\n").origin, (Vec3{12.5, 1, -3}));
  EXPECT_EQ(grid(ends).origin, (Vec3{12.5, 1, -3}));  // as in Teem
  EXPECT_EQ(grid(ends + "centerings: ??? node none\n").spacing, (Vec3{5, 3, 2}));
  EXPECT_EQ(grid("axis maxs: 10 0 -4\naxis mins: 20 6 4\n").direction[0],
            (Vec3{-1, 0, 0}));  // the axis decreases
  EXPECT_EQ(grid(kSpacing + "axis mins: 10 20 30\n").origin, (Vec3{10.25, 20.5, 31}));
  EXPECT_EQ(grid(kSpacing + ends).spacing, (Vec3{0.5, 1, 2}));  // a stated spacing counts
  NrrdFile(small("axis mins: 1 1 1\naxis maxs: 1 2 2\n"))
      .expect_refused(kBad, "spacing along x is 0");
  NrrdFile(small("axis mins: 1 1\n")).expect_refused(kBad, "expected 3 numbers");
}

TEST(NrrdSpacing, ANegativeSpacingReversesTheAxis) {
  const Grid grid = NrrdFile(small("spacings: 0.5 -2 1\n")).file().volume.view.grid;
  EXPECT_EQ(grid.spacing, (Vec3{0.5, 2, 1}));
  EXPECT_EQ(grid.direction, (std::array<Vec3, 3>{Vec3{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}));
}

TEST(NrrdSpacing, MissingSpacings) {
  const VolumeFile none = NrrdFile(small("thicknesses: 3 3 3\n")).file();
  EXPECT_FALSE(none.source.has_spacing);
  EXPECT_EQ(none.source.warnings, Strings{"states no voxel size; 1 x 1 x 1 is assumed"});
  const VolumeFile some = NrrdFile(small("spacings: 0.5 0.5 nan\n")).file();
  EXPECT_TRUE(some.source.has_spacing);
  EXPECT_EQ(some.volume.view.grid.spacing, (Vec3{0.5, 0.5, 1}));
  EXPECT_EQ(some.source.warnings, Strings{"states no spacing along z; 1 is assumed"});
  NrrdFile(small("spacings: 1 0 1\n")).expect_refused(kBad, "spacing along y is 0");
  NrrdFile(small("spacings: 1 inf 1\n")).expect_refused(kBad, "spacing along y");
  NrrdFile(small("spacings: 1 one 1\n"))
      .expect_refused(kBad, "'spacings' is '1 one 1', expected 3 numbers");
}

TEST(NrrdUnits, OfSpaceAndAxes) {
  const auto unit = [](const std::string& more) {
    return NrrdFile(small(more)).file().volume.view.grid.unit;
  };
  const std::string lps = "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n";
  EXPECT_EQ(unit(lps + "space units: \"um\" \"um\" \"um\"\n"), LengthUnit::micrometre);
  EXPECT_EQ(unit(lps + "space units: \"mm\" \"mm\" \"mm\"\n"), LengthUnit::millimetre);
  EXPECT_EQ(unit(lps), LengthUnit::millimetre);
  EXPECT_EQ(unit(lps + "space units: \"furlong\" \"furlong\" \"furlong\"\n"), LengthUnit::unknown);
  EXPECT_EQ(unit(kSpacing + "units: \"cm\" \"cm\" \"cm\"\n"), LengthUnit::centimetre);
  EXPECT_EQ(unit(kSpacing + "units: \"nm\" \"\" \"nm\"\n"), LengthUnit::nanometre);
  EXPECT_EQ(unit(kSpacing), LengthUnit::unknown);
  EXPECT_EQ(NrrdFile(small("space: LPS\n")).file().volume.view.grid.unit,
            LengthUnit::unknown);  // without a length there is no unit
  NrrdFile(small(kSpacing + "units: \"mm\" \"mm\" \"cm\"\n"))
      .expect_refused(kUnsupported, "units of their own (mm and cm)");
  for (const std::string units : {R"("mm" "mm" "s")", R"("s" "mm" "mm")",
                                  R"("mm" "mm" "ms")"})  // slices in time are not a volume
    NrrdFile(small(kSpacing + "units: " + units + "\n"))
        .expect_refused(kUnsupported, "units of their own (mm and '");
  EXPECT_EQ(decision(NrrdFile(small(lps)).file(), "unit"), "mm, by the convention of LPS");
}

// ---- axes that are not axes of the volume

TEST(NrrdAxes, ListIsALayerWhereverItIs) {
  const std::string tail = "space: LPS\n";
  const NrrdFile first(header("dimension: 4\nsizes: 2 2 3 4\nkinds: list domain domain domain\n" +
                              tail + "space directions: none (1,0,0) (0,1,0) (0,0,1)\n\n") +
                       counted(48));
  EXPECT_EQ(first.samples({.layer = "0"}), counted(24, 0, 2));
  EXPECT_EQ(first.samples({.layer = "1"}), counted(24, 1, 2));
  const NrrdFile last(header("dimension: 4\nsizes: 2 3 4 2\nkinds: space space space list\n" +
                             tail + "space directions: (1,0,0) (0,1,0) (0,0,1) none\n\n") +
                      counted(48));
  EXPECT_EQ(last.samples({.layer = "0"}), counted(24));
  EXPECT_EQ(last.samples({.layer = "1"}), counted(24, 24));
  const NrrdFile middle(
      header("dimension: 4\nsizes: 2 2 3 4\nkinds: domain list domain domain\n\n") + counted(48));
  std::string expected;
  for (std::size_t row = 0; row < 12; ++row) {
    expected += counted(2, 4 * row + 2);
  }
  EXPECT_EQ(middle.samples({.layer = "1"}), expected);
  EXPECT_EQ(middle.file({.layer = "1"}).volume.view.grid.size,
            (std::array<std::size_t, 3>{2, 3, 4}));
}

TEST(NrrdAxes, SegmentsNameTheirLayer) {
  const std::string layers =
      "Segment0_ID:=Segment_1\nSegment0_Name:=liver\nSegment0_Layer:=0\nSegment0_LabelValue:=1\n"
      "Segment1_ID:=Segment_2\nSegment1_Name:=tumour \\\\ "
      "left\nSegment1_Layer:=1\nSegment1_LabelValue:=1\n"
      "Segment2_ID:=Segment_3\nSegment2_Layer:=0\nSegment2_LabelValue:=5\n";
  const NrrdFile nrrd(
      header("dimension: 4\nsizes: 2 2 3 4\nkinds: list domain domain domain\n" + layers + "\n") +
          counted(48),
      "a.seg.nrrd");
  nrrd.expect_refused(
      kUnsupported,
      "has 2 layers, expected a choice of one: 0 (liver, Segment_3), 1 (tumour \\ left)");
  const VolumeFile named = nrrd.file({.layer = "tumour \\ left"});
  EXPECT_EQ(samples_of(named.volume), counted(24, 1, 2));
  EXPECT_EQ(decision(named, "segments"), "1 tumour \\ left");
  EXPECT_EQ(decision(nrrd.file({.layer = "0"}), "segments"), "1 liver, 5 Segment_3");
  ASSERT_EQ(named.source.choices.size(), 1u);
  EXPECT_EQ(named.source.choices[0].selected, 1u);
  // Slicer before 4.11: a layer for each segment, without Layer in the header.
  const NrrdFile old(header("dimension: 4\nsizes: 2 2 3 4\nkinds: list domain domain "
                            "domain\nSegment0_ID:=a\nSegment0_Name:=A\nSegment1_ID:=b\n"
                            "Segment1_Name:=B\n\n") +
                     counted(48));
  EXPECT_EQ(old.samples({.layer = "B"}), counted(24, 1, 2));
  // One layer: no list axis.
  EXPECT_EQ(decision(NrrdFile(small(kSpacing +
                                    "Segment0_ID:=a\nSegment0_Name:=A\nSegment0_LabelValue:=3\n"))
                         .file(),
                     "segments"),
            "3 A");
}

TEST(NrrdAxes, ComponentsAreChannels) {
  const auto components = [](const std::string& kind, std::size_t count) {
    return header("dimension: 4\nsizes: " + std::to_string(count) + " 2 3 4\nkinds: " + kind +
                  " domain domain domain\n\n") +
           counted(24 * count);
  };
  const NrrdFile colours(components("RGB-color", 3));
  colours.expect_refused(kUnsupported,
                         "has 3 channels, expected a choice of one: 0 (red), 1 (green), 2 (blue)");
  EXPECT_EQ(colours.samples({.channel = "2"}), counted(24, 2, 3));
  EXPECT_EQ(NrrdFile(components("complex", 2)).samples({.channel = "1"}), counted(24, 1, 2));
  EXPECT_EQ(NrrdFile(components("vector", 5)).samples({.channel = "4"}), counted(24, 4, 5));
  EXPECT_EQ(NrrdFile(components("3D-masked-symmetric-matrix", 7)).samples({.channel = "6"}),
            counted(24, 6, 7));
  EXPECT_EQ(NrrdFile(components("stub", 1)).samples(), counted(24));
  EXPECT_EQ(NrrdFile(components("scalar", 1)).samples(), counted(24));
  NrrdFile(components("vector", 5))
      .expect_refused(ErrorCode::bad_argument, "no channel '5'", {.channel = "5"});
}

TEST(NrrdAxes, WithoutKindsSpacingsAndDirectionsDecide) {
  const NrrdFile spacings(header("dimension: 4\nsizes: 2 2 3 4\nspacings: nan 1 1 2\n\n") +
                          counted(48));
  EXPECT_EQ(spacings.samples({.channel = "1"}), counted(24, 1, 2));
  EXPECT_EQ(spacings.file({.channel = "1"}).volume.view.grid.spacing, (Vec3{1, 1, 2}));
  const NrrdFile directions(header("dimension: 4\nsizes: 2 3 4 2\nspace: LPS\nspace directions: "
                                   "(1,0,0) (0,1,0) (0,0,1) none\n\n") +
                            counted(48));
  EXPECT_EQ(directions.samples({.channel = "1"}), counted(24, 24));
  NrrdFile(header("dimension: 4\nsizes: 2 3 4 2\n\n") + counted(48))
      .expect_refused(kUnsupported, "has 4 dimensions (2 x 3 x 4 x 2) without stating");
}

TEST(NrrdAxes, AxesOfOneSampleAreDropped) {
  for (const std::string sizes : {"2 3 4 1", "1 2 3 4", "2 1 3 4"}) {
    const VolumeFile file =
        NrrdFile(header("dimension: 4\nsizes: " + sizes + "\n\n") + counted(24)).file();
    EXPECT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{2, 3, 4})) << sizes;
    EXPECT_EQ(samples_of(file.volume), counted(24));
  }
  NrrdFile(header("dimension: 2\nsizes: 4 6\n\n") + counted(24))
      .expect_refused(kUnsupported, "4 x 6 x 1 samples");
  NrrdFile(header("dimension: 3\nsizes: 4 6 3\nkinds: domain domain RGB-color\n\n") + counted(72))
      .expect_refused(kUnsupported, "4 x 6 x 1 samples");
}

TEST(NrrdAxes, TwoListsAtOnce) {
  const NrrdFile nrrd(
      header("dimension: 5\nsizes: 2 2 3 4 2\nkinds: vector domain domain domain time\n\n") +
      counted(96));
  nrrd.expect_refused(kUnsupported, "has 2 channels");
  nrrd.expect_refused(kUnsupported, "has 2 time points", {.channel = "1"});
  EXPECT_EQ(nrrd.samples({.channel = "1", .time = 1}), counted(24, 49, 2));
  NrrdFile(header("dimension: 5\nsizes: 2 2 3 4 2\nkinds: list domain domain domain list\n\n") +
           counted(96))
      .expect_refused(kUnsupported, "several of them lists of one kind");
}

TEST(NrrdAxes, LargeRowsOfComponents) {  // more than one buffer of them
  const std::size_t nx = 50000;
  std::string bytes, expected;
  for (std::size_t i = 0; i < nx * 4; ++i) {
    bytes += {static_cast<char>(i), static_cast<char>(i >> 8), static_cast<char>(i * 7)};
    expected += static_cast<char>(i * 7);
  }
  const NrrdFile nrrd(
      header("dimension: 4\nsizes: 3 50000 2 2\nkinds: 3-vector space space space\n\n") + bytes);
  EXPECT_EQ(nrrd.samples({.channel = "2"}), expected);
}

// ---- samples

TEST(NrrdSamples, TypesByAllTheirNames) {
  const std::vector<std::pair<SampleType, Strings>> types{
      {SampleType::int8, {"signed char", "int8", "int8_t"}},
      {SampleType::uint8, {"uchar", "unsigned char", "uint8", "uint8_t", "UINT8"}},
      {SampleType::int16,
       {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
      {SampleType::uint16,
       {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
      {SampleType::int32, {"int", "signed int", "int32", "int32_t"}},
      {SampleType::uint32, {"uint", "unsigned int", "uint32", "uint32_t"}},
      {SampleType::int64,
       {"longlong", "long long", "long long int", "signed long long", "signed long long int",
        "int64", "int64_t"}},
      {SampleType::uint64,
       {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}},
      {SampleType::float32, {"float"}},
      {SampleType::float64, {"double"}}};
  for (const auto& [type, names] : types) {
    for (const std::string& name : names) {
      const std::string body = counted(8 * bytes_per_sample(type));
      const NrrdFile nrrd("NRRD0004\ntype: " + name +
                          "\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n\n" + body);
      EXPECT_EQ(nrrd.file().volume.view.type, type) << name;
      EXPECT_EQ(nrrd.samples(), body) << name;
    }
  }
  for (const std::string name : {"block", "char", "half", "long", ""}) {
    NrrdFile("NRRD0004\ntype: " + name +
             "\nblock size: 4\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n" + counted(32))
        .expect_refused(name.empty() ? kBad : kUnsupported,
                        name.empty() ? "no field 'type'" : "samples of type '" + name + "'");
  }
}

TEST(NrrdSamples, ByteOrder) {
  const auto nrrd = [](const std::string& endian, const std::string& encoding = "raw",
                       const std::string& body = counted(16)) {
    return "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 2 2 2\nencoding: " + encoding + "\n" +
           endian + "\n" + body;
  };
  std::string swapped = counted(16);
  for (std::size_t i = 0; i < 16; i += 2) {
    std::swap(swapped[i], swapped[i + 1]);
  }
  EXPECT_EQ(NrrdFile(nrrd("endian: little\n")).samples(), counted(16));
  EXPECT_EQ(NrrdFile(nrrd("endian: big\n")).samples(), swapped);
  EXPECT_EQ(NrrdFile(nrrd("endian: big\n", "hex", "0001 0203 0405 0607\n0809 0A0b 0c0D 0e0F\n"))
                .samples(),
            swapped);
  EXPECT_EQ(NrrdFile(nrrd("", "ascii", "1 2 3 4 5 6 7 8")).samples(),
            std::string("\1\0\2\0\3\0\4\0\5\0\6\0\7\0\10\0", 16));
  EXPECT_EQ(NrrdFile(nrrd("endian: big\n", "ascii", "1 2 3 4 5 6 7 8")).samples(),
            std::string("\1\0\2\0\3\0\4\0\5\0\6\0\7\0\10\0", 16));
  NrrdFile(nrrd("")).expect_refused(kBad, "does not state the byte order");
  NrrdFile(nrrd("endian: middle\n")).expect_refused(kBad, "'endian' is 'middle'");
}

TEST(NrrdSamples, EveryEncoding) {
  std::string text, hex;
  for (std::size_t i = 0; i < 24; ++i) {
    text += std::to_string(i) + (i % 5 == 0 ? "\n" : i % 3 == 0 ? " , " : "\t ");
    hex += std::string(1, "0123456789abcdef"[i / 16]) + "0123456789ABCDEF"[i % 16] +
           (i % 7 == 6 ? "\n" : "");
  }
  const std::vector<std::pair<std::string, std::string>> encodings{{"raw", counted(24)},
                                                                   {"RAW", counted(24)},
                                                                   {"txt", text},
                                                                   {"text", text},
                                                                   {"ascii", text},
                                                                   {"hex", hex},
                                                                   {"gz", gzipped(counted(24))},
                                                                   {"gzip", gzipped(counted(24))},
                                                                   {"bz2", bzipped(counted(24))},
                                                                   {"bzip2", bzipped(counted(24))}};
  for (const auto& [encoding, body] : encodings) {
    const VolumeFile file = NrrdFile(small(kSpacing, body, encoding)).file();
    EXPECT_EQ(samples_of(file.volume), counted(24)) << encoding;
    EXPECT_EQ(file.source.warnings, Strings{}) << encoding;
  }
  NrrdFile(small(kSpacing, counted(24), "zrl"))
      .expect_refused(kUnsupported, "in the encoding 'zrl'");
  NrrdFile("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\n\n" + counted(24))
      .expect_refused(kBad, "no field 'encoding'");
}

TEST(NrrdSamples, GzippedInNameOnly) {  // Teem takes these as they are
  const VolumeFile file = NrrdFile(small(kSpacing, counted(24), "gzip")).file();
  EXPECT_EQ(samples_of(file.volume), counted(24));
  EXPECT_EQ(file.source.warnings,
            Strings{"states that its samples are gzipped, but they are not gzipped"});
  NrrdFile(small(kSpacing, counted(25), "gzip")).expect_refused(kBad, "damaged");
}

TEST(NrrdSamples, Text) {
  const auto nrrd = [](const std::string& type, const std::string& body) {
    return "NRRD0004\ntype: " + type +
           "\ndimension: 3\nsizes: 2 2 2\nencoding: text\nspacings: 1 1 1\n\n" + body;
  };
  const Volume floats =
      NrrdFile(nrrd("float", "0.1 -1e3 nan inf -inf +2 .5 16777217\n")).file().volume;
  const auto* const f = static_cast<const float*>(floats.view.samples);
  EXPECT_EQ(f[0], 0.1F);
  EXPECT_EQ(f[1], -1000.0F);
  EXPECT_TRUE(std::isnan(f[2]));
  EXPECT_EQ(f[3], std::numeric_limits<float>::infinity());
  EXPECT_EQ(f[4], -std::numeric_limits<float>::infinity());
  EXPECT_EQ(f[5], 2.0F);
  EXPECT_EQ(f[6], 0.5F);
  EXPECT_EQ(f[7], 16777216.0F);
  const Volume longs =
      NrrdFile(nrrd("int64", "9223372036854775807 -9223372036854775808 12.0 1e3 0 0 0 0"))
          .file()
          .volume;
  const auto* const l = static_cast<const std::int64_t*>(longs.view.samples);
  EXPECT_EQ(l[0], std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(l[1], std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(l[2], 12);
  EXPECT_EQ(l[3], 1000);
  NrrdFile(nrrd("uint8", "0 1 256 3 4 5 6 7"))
      .expect_refused(kBad, "sample 2 is '256', expected a number of type uint8");
  NrrdFile(nrrd("uint8", "0 1 2 -3 4 5 6 7")).expect_refused(kBad, "sample 3 is '-3'");
  NrrdFile(nrrd("int16", "0 1 2 3.5 4 5 6 7")).expect_refused(kBad, "sample 3 is '3.5'");
  NrrdFile(nrrd("int16", "0 1 2 three 4 5 6 7")).expect_refused(kBad, "sample 3 is 'three'");
  NrrdFile(nrrd("int8", "0 1 2 3 4 5 6")).expect_refused(kBad, "states 8 numbers");
  NrrdFile(nrrd("int8", "0 1 2 3 4 5 6            "))
      .expect_refused(kBad, "states 8 numbers, the file has 7");
  EXPECT_EQ(NrrdFile(nrrd("int8", "0 1 2 3 4 5 6 7 89")).file().source.warnings,
            Strings{"has 2 bytes after the last sample that the header states"});
  NrrdFile(nrrd("int8", std::string(100000, '1'))).expect_refused(kBad, "sample 0 is '1111");
}

TEST(NrrdSamples, HexadecimalDigits) {
  NrrdFile(small(kSpacing, std::string(48, 'a') + "b", "hex"))
      .expect_refused(ErrorCode::bad_argument, "no", {.channel = "1"});
  EXPECT_EQ(
      NrrdFile(small(kSpacing, std::string(48, 'a') + "b\n", "hex")).file().source.warnings.size(),
      1u);
  NrrdFile(small(kSpacing, std::string(47, 'a') + "g", "hex"))
      .expect_refused(kBad, "byte 23 of its samples has 'g'");
  NrrdFile(small(kSpacing, std::string(46, 'a') + "  \n", "hex"))
      .expect_refused(kBad, "the file has 23");
  NrrdFile(small(kSpacing, std::string(40, 'a'), "hex"))
      .expect_refused(kBad, "24 bytes in hexadecimal");
}

TEST(NrrdSamples, Skips) {
  const std::string lines = "one\ntwo\r\n";
  EXPECT_EQ(NrrdFile(small(kSpacing + "line skip: 2\n", lines + counted(24))).samples(),
            counted(24));
  EXPECT_EQ(NrrdFile(small(kSpacing + "line skip: 2\nbyte skip: 3\n", lines + "abc" + counted(24)))
                .samples(),
            counted(24));
  EXPECT_EQ(NrrdFile(small(kSpacing + "lineskip: 2\nbyteskip: 3\n",
                           lines + gzipped("abc" + counted(24)), "gzip"))
                .samples(),
            counted(24));
  EXPECT_EQ(
      NrrdFile(small(kSpacing + "byte skip: 3\n", bzipped("abc" + counted(24)), "bzip2")).samples(),
      counted(24));
  EXPECT_EQ(NrrdFile(small(kSpacing + "byte skip: -1\n", "anything" + counted(24))).samples(),
            counted(24));
  EXPECT_EQ(
      NrrdFile(small(kSpacing + "byte skip: -4\n", "anything" + counted(24) + "end")).samples(),
      counted(24));
  NrrdFile(small(kSpacing + "byte skip: -1\n", gzipped(counted(24)), "gzip"))
      .expect_refused(kUnsupported, "'byte skip: -1' with compressed samples");
  NrrdFile(small(kSpacing + "byte skip: 30\n")).expect_refused(kBad, "the file has 0");
  NrrdFile(small(kSpacing + "byte skip: 30\n", gzipped(counted(24)), "gzip"))
      .expect_refused(kBad, "is cut off");
  NrrdFile(small(kSpacing + "byte skip: 9223372036854775807\n"))
      .expect_refused(kBad, "the file has 0");
  NrrdFile(small(kSpacing + "byte skip: -9223372036854775807\n"))
      .expect_refused(kBad, "the file has 0");
  NrrdFile(small(kSpacing + "line skip: 1000000000\n"))
      .expect_refused(kBad, "lines before its samples begin");
  NrrdFile(small(kSpacing + "line skip: -1\n")).expect_refused(kBad, "'lineskip' is '-1'");
  NrrdFile(small(kSpacing + "byte skip: few\n")).expect_refused(kBad, "'byteskip' is 'few'");
}

TEST(NrrdSamples, MoreBytesThanStated) {
  const auto warnings = [](const std::string& body, const std::string& encoding) {
    return NrrdFile(small(kSpacing, body, encoding)).file().source.warnings;
  };
  EXPECT_EQ(warnings(counted(27), "raw"),
            Strings{"has 3 bytes after the last sample that the header states"});
  EXPECT_EQ(warnings(gzipped(counted(27)), "gzip"),
            Strings{"has 3 bytes after the last sample that the header states"});
  EXPECT_EQ(warnings(bzipped(counted(27)), "bzip2"),
            Strings{"has 3 bytes after the last sample that the header states"});
}

TEST(NrrdSamples, CutOrDamaged) {
  const std::string bz = bzipped(counted(24));
  NrrdFile(small(kSpacing, counted(23)))
      .expect_refused(kBad, "states 24 bytes of samples, the file has 23");
  NrrdFile(small(kSpacing, gzipped(counted(23)), "gzip"))
      .expect_refused(kBad, "states 24 bytes of samples, the file has 23");
  NrrdFile(small(kSpacing, bz.substr(0, bz.size() - 4), "bzip2"))
      .expect_refused(kBad, "is cut off");
  // The part of a compressed file that is not read is still checked.
  const std::string gz = gzipped(counted(48));
  const std::string lines =
      "NRRD0004\ntype: uint8\nencoding: gzip\ndimension: 4\nsizes: 2 3 4 2\nkinds: space space "
      "space time\n\n";
  EXPECT_EQ(NrrdFile(lines + gz).samples({.time = 0}), counted(24));
  NrrdFile(lines + gz.substr(0, gz.size() - 6)).expect_refused(kBad, "is cut off", {.time = 0});
  NrrdFile(lines + gzipped(counted(47)))
      .expect_refused(kBad, "states 48 bytes of samples, the file has 47", {.time = 0});
  NrrdFile(header("dimension: 4\nsizes: 2 3 4 2\nkinds: space space space time\n\n") + counted(47))
      .expect_refused(kBad, "the file has 47", {.time = 0});
}

TEST(NrrdSamples, SizesTooLargeForAnyFile) {
  const std::string bz = bzipped(counted(24));
  NrrdFile(
      "NRRD0004\ntype: double\nendian: little\nencoding: bzip2\ndimension: 3\nsizes: 100000 100000 "
      "100000\n\n" +
      bz)
      .expect_refused(kBad, "far more than a file of");
  NrrdFile(
      "NRRD0004\ntype: double\nendian: little\nencoding: bzip2\ndimension: 3\nsizes: 200 200 "
      "200\n\n" +
      bz)
      .expect_refused(ErrorCode::out_of_memory, "more than the limit of 1000000",
                      {.max_memory = 1000000});
  NrrdFile(
      "NRRD0004\ntype: uint8\nencoding: text\ndimension: 3\nsizes: 100000 100000 100000\n\n1 2 3")
      .expect_refused(kBad, "numbers, far more than");
  NrrdFile(
      "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 5\nsizes: 2 2 2 4294967296 "
      "4294967296\nkinds: space space space list vector\n\n1 2 "
      "3")
      .expect_refused(kUnsupported, "has 4294967296 entries to choose a layer from",
                      {.channel = "0", .layer = "0"});
}

// ---- data files

TEST(NrrdDataFiles, OneNextToTheHeader) {
  NrrdFile nrrd(small(kSpacing + "data file: sub/a b.raw\n", ""), "a.nhdr");
  nrrd.expect_refused(kBad, "its data file");
  std::filesystem::create_directory(nrrd.path.parent_path() / "sub");
  nrrd.with("sub/a b.raw", counted(24));
  EXPECT_EQ(nrrd.samples(), counted(24));
  EXPECT_EQ(NrrdFile(small(kSpacing + "datafile: " +
                               (nrrd.path.parent_path() / "sub/a b.raw").string() + "\n",
                           ""))
                .samples(),
            counted(24));
  write_bytes(nrrd.path, small(kSpacing + "data file: sub\\a b.raw\n", ""));
  EXPECT_EQ(nrrd.samples(), counted(24));
  write_bytes(nrrd.path, small(kSpacing + "data file: sub\n", ""));
  nrrd.expect_refused(kBad, "is a folder");
}

TEST(NrrdDataFiles, PackedAndText) {
  EXPECT_EQ(NrrdFile(small(kSpacing + "data file: a.gz\n", "", "gzip"))
                .with("a.gz", gzipped(counted(24)))
                .samples(),
            counted(24));
  EXPECT_EQ(NrrdFile(small(kSpacing + "data file: a.txt\nline skip: 1\n", "", "txt"))
                .with("a.txt", "# x\n0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23")
                .samples(),
            counted(24));
}

TEST(NrrdDataFiles, List) {
  const auto with_slices = [](NrrdFile& nrrd) -> NrrdFile& {
    return nrrd.with("a.raw", counted(6))
        .with("b.raw", counted(6, 6))
        .with("c.raw", counted(6, 12))
        .with("d.raw", counted(6, 18));
  };
  NrrdFile slices(small(kSpacing + "data file: LIST\na.raw\nb.raw\r\nc.raw\nd.raw\n", ""),
                  "a.nhdr");
  EXPECT_EQ(with_slices(slices).samples(), counted(24));
  NrrdFile explicitly(small(kSpacing + "data file: LIST 2\na.raw\nb.raw\nc.raw\nd.raw", ""),
                      "a.nhdr");
  EXPECT_EQ(with_slices(explicitly).samples(), counted(24));
  NrrdFile rows(small(kSpacing + "data file: LIST 1\na\nb\nc\nd\ne\nf\ng\nh\ni\nj\nk\nl\n", ""),
                "a.nhdr");
  for (std::size_t i = 0; i < 12; ++i) {
    rows.with(std::string(1, static_cast<char>('a' + i)), counted(2, 2 * i));
  }
  EXPECT_EQ(rows.samples(), counted(24));
  NrrdFile slabs(small(kSpacing + "data file: LIST 3\na\nb\n", ""), "a.nhdr");
  EXPECT_EQ(slabs.with("a", counted(12)).with("b", counted(12, 12)).samples(), counted(24));
  NrrdFile few(small(kSpacing + "data file: LIST\na.raw\nb.raw\nc.raw\n", ""), "a.nhdr");
  with_slices(few).expect_refused(kBad, "names 3 data files, expected 4, each of dimension 2");
  NrrdFile odd(small(kSpacing + "data file: LIST 3\na.raw\nb.raw\nc.raw\n", ""), "a.nhdr");
  with_slices(odd).expect_refused(kBad, "a divisor of the 4 samples of the last axis");
  NrrdFile none(small(kSpacing + "data file: LIST 3\n", ""), "a.nhdr");
  none.expect_refused(kBad, "names 0 data files");
  NrrdFile(small(kSpacing + "data file: LIST 4\na\n", ""), "a.nhdr")
      .expect_refused(kBad, "of dimension '4', expected 1 to 3");
  NrrdFile cut(small(kSpacing + "data file: LIST\na.raw\nb.raw\nc.raw\nd.raw\n", ""), "a.nhdr");
  with_slices(cut)
      .with("c.raw", counted(5))
      .expect_refused(
          kBad,
          "c.raw: is cut off or damaged: the header states 6 bytes of samples, the file has 5");
  NrrdFile longer(small(kSpacing + "data file: LIST\na.raw\nb.raw\nc.raw\nd.raw\n", ""), "a.nhdr");
  EXPECT_EQ(with_slices(longer)
                .with("c.raw", counted(8, 12))
                .with("d.raw", counted(7, 18))
                .file()
                .source.warnings,
            Strings{"its data file c.raw has 2 bytes after the last sample that the header "
                    "states, and 1 more files are longer too"});
}

TEST(NrrdDataFiles, TextHasNoBytesToCountFromTheEnd) {
  for (const std::string encoding : {"text", "hex"})
    NrrdFile(small(kSpacing + "byte skip: -1\n", "1 2 3", encoding))
        .expect_refused(kUnsupported, "(byte skip -1), expected this with raw samples only");
}

TEST(NrrdDataFiles, Pattern) {
  NrrdFile nrrd(small(kSpacing + "data file: s%03d.raw 9 3 -2\n", ""), "a.nhdr");
  nrrd.with("s009.raw", counted(6))
      .with("s007.raw", counted(6, 6))
      .with("s005.raw", counted(6, 12))
      .with("s003.raw", counted(6, 18));
  EXPECT_EQ(nrrd.samples(), counted(24));
  NrrdFile slabs(small(kSpacing + "data file: s%d.gz 1 2 1 3\nbyte skip: 1\n", "", "gzip"),
                 "a.nhdr");
  EXPECT_EQ(slabs.with("s1.gz", gzipped("x" + counted(12)))
                .with("s2.gz", gzipped("y" + counted(12, 12)))
                .samples(),
            counted(24));
  NrrdFile few(small(kSpacing + "data file: s%d.raw 1 3 1\n", ""), "a.nhdr");
  few.with("s1.raw", counted(6)).expect_refused(kBad, "names 3 data files, expected 4");
  // Refused before a million names are generated:
  NrrdFile(small(kSpacing + "data file: s%d.raw 1 1000000 1\n", ""), "a.nhdr")
      .expect_refused(kBad, "s1.raw: no such file");
  NrrdFile(small(kSpacing + "data file: s%d.raw 1 4 0\n", ""))
      .expect_refused(kBad, "first and last number and a step");
  NrrdFile(small(kSpacing + "data file: s%d.raw 4 1 1\n", ""))
      .expect_refused(kBad, "first and last number and a step");
  NrrdFile(small(kSpacing + "data file: s%d.raw 1 2000000000 1\n", ""))
      .expect_refused(kUnsupported, "expected at most 1000000");
  NrrdFile(small(kSpacing + "data file: s%s%n.raw 1 4 1\n", ""))
      .expect_refused(kBad, "no such file");
  NrrdFile percent(small(kSpacing + "data file: 100%.raw\n", ""));
  EXPECT_EQ(percent.with("100%.raw", counted(24)).samples(), counted(24));
}

TEST(NrrdDataFiles, OneForEachTimePoint) {
  NrrdFile nrrd(header("dimension: 4\nsizes: 2 3 4 3\nkinds: space space space time\ndata file: "
                       "t%d.raw 0 2 1\n"),
                "a.nhdr");
  nrrd.with("t0.raw", counted(24)).with("t1.raw", counted(24, 24)).with("t2.raw", counted(24, 48));
  EXPECT_EQ(nrrd.samples({.time = 1}), counted(24, 24));
  EXPECT_EQ(nrrd.samples({.time = 2}), counted(24, 48));
  NrrdFile channels(header("dimension: 4\nsizes: 2 2 3 4\nkinds: vector space space space\ndata "
                           "file: s%d.raw 0 3 1\n"),
                    "a.nhdr");
  for (std::size_t z = 0; z < 4; ++z) {
    channels.with("s" + std::to_string(z) + ".raw", counted(12, 12 * z));
  }
  EXPECT_EQ(channels.samples({.channel = "1"}), counted(24, 1, 2));
}

// ---- the header itself

TEST(NrrdHeader, ContentDecidesTheFormat) {
  for (const std::string name : {"scan.nii", "scan", "scan.mha", "scan.tif"}) {
    EXPECT_EQ(NrrdFile(small(), name).file().source.format, "NRRD") << name;
  }
}

TEST(NrrdHeader, EveryVersion) {
  for (const std::string version :
       {"NRRD00.01", "NRRD0001", "NRRD0002", "NRRD0003", "NRRD0004", "NRRD0005", "NRRD0006"}) {
    EXPECT_EQ(NrrdFile(version + small().substr(8)).samples(), counted(24)) << version;
  }
}

TEST(NrrdHeader, LinesMayEndInCrLf) {
  std::string lines;
  for (const char c : small(kSpacing, "")) {
    lines += c == '\n' ? "\r\n" : std::string(1, c);
  }
  EXPECT_EQ(NrrdFile(lines + counted(24)).samples(), counted(24));
}

TEST(NrrdHeader, GzippedAsAWhole) {
  const VolumeFile file = NrrdFile(gzipped(small()), "a.nrrd.gz").file();
  EXPECT_EQ(samples_of(file.volume), counted(24));
  EXPECT_EQ(
      NrrdFile(gzipped(small(kSpacing + "line skip: 1\nbyte skip: 2\n", "x\nyz" + counted(24))))
          .samples(),
      counted(24));
  NrrdFile(gzipped(small(kSpacing, counted(23)))).expect_refused(kBad, "the file has 23");
  NrrdFile(gzipped(small(kSpacing, gzipped(counted(24)), "gzip")))
      .expect_refused(kUnsupported, "expected one compression");
}

TEST(NrrdHeader, FieldsThatDoNotConcernTheVolume) {
  const std::string more =
      "# comment: with colons\ncontent: a:=b\nnumber: 7\nmin: 0\nmax: 255\nold min: 3\nOLDMAX: "
      "4\nsample units: HU\n"
      "labels: \"x\" \"y\" \"z\"\nmeasurement frame: (1,0,0) (0,1,0) (0,0,1)\nthicknesses: 1 1 "
      "1\nblock size: 3\n"
      "a key:=a value: with colon\ntype:=not the type\nspace dimension: 3\n";
  const VolumeFile file = NrrdFile(small(kSpacing + more)).file();
  EXPECT_EQ(samples_of(file.volume), counted(24));
  EXPECT_EQ(file.source.warnings, Strings{});
  EXPECT_EQ(NrrdFile(small(kSpacing + "my field: 7\n")).file().source.warnings,
            Strings{"has a header field that NRRD does not know: my field"});
}

TEST(NrrdHeader, NamesInAnyCaseAndWithoutBlanks) {
  EXPECT_EQ(NrrdFile("NRRD0005\nTYPE:uint8\nDimension:  3\nSIZES:\t2 3 "
                     "4\nEncoding:raw\nSpaceDimension: 3\nSPACEDIRECTIONS: (2,0,0) (0,3,0) "
                     "(0,0,4)\n\n" +
                     counted(24))
                .file()
                .volume.view.grid.spacing,
            (Vec3{2, 3, 4}));
}

TEST(NrrdHeader, RepeatedFields) {
  EXPECT_EQ(NrrdFile(small(kSpacing + kSpacing)).samples(), counted(24));
  NrrdFile(small(kSpacing + "spacings: 1 1 1\n"))
      .expect_refused(kBad, "two fields 'spacings': 0.5 1 2, and 1 1 1");
}

TEST(NrrdHeader, Wrong) {
  NrrdFile(small("what is this\n")).expect_refused(kBad, "the line 'what is this'");
  NrrdFile(header("dimension: 3\nsizes: 2 3\n\n") + counted(24))
      .expect_refused(kBad, "'sizes' is '2 3', expected 3 numbers");
  NrrdFile(header("dimension: 2\nsizes: 2 3 4\n\n") + counted(24))
      .expect_refused(kBad, "expected 2 numbers");
  NrrdFile(header("dimension: 17\nsizes: 2 3 4\n\n") + counted(24))
      .expect_refused(kBad, "'dimension' is '17', expected 1 to 16");
  NrrdFile(header("dimension: three\nsizes: 2 3 4\n\n") + counted(24))
      .expect_refused(kBad, "'dimension' is 'three'");
  NrrdFile(header("sizes: 2 3 4\n\n") + counted(24)).expect_refused(kBad, "no field 'dimension'");
  NrrdFile(header("dimension: 3\n\n") + counted(24)).expect_refused(kBad, "no field 'sizes'");
  NrrdFile(small(kSpacing + "kinds: domain domain\n"))
      .expect_refused(kBad, "'kinds' is 'domain domain', expected 3 words");
  NrrdFile(small().substr(0, 60)).expect_refused(kBad, "");
  // Cut at any place, a file gives an error at most.
  const std::string whole = small();
  for (std::size_t length = 9; length < whole.size(); ++length) {
    EXPECT_THROW(NrrdFile(whole.substr(0, length)).file(), Error) << length;
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
