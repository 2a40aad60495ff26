// SPDX-License-Identifier: Apache-2.0
// Folders with DICOM files: which files form a volume, which are a choice, which are skipped.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/dicom_builder.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;
using Values = std::vector<double>;
using Names = std::vector<std::string>;

const auto kUnchanged = [](DicomBuilder&, int) {};

FileChoice choice_needed(const fs::path& path, const ReadOptions& options = {}) {
  try {
    read_volume_file(path, options);
  } catch (const ChoiceNeeded& needed) {
    return needed.choice();
  }
  ADD_FAILURE() << path << ": no choice was needed";
  return {};
}

TEST(DicomFolder, SlicesAreSortedByPosition) {
  const TempFolder folder;
  write_series(folder.path(), 4, kUnchanged);
  const VolumeFile file = read_volume_file(folder.path());
  EXPECT_EQ(slice_values(file.volume), (Values{0, 100, 200, 300}));
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.5, 0.75, 2}));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{-10, 20, 5}));
  EXPECT_EQ(static_cast<const std::int16_t*>(file.volume.view.samples)[0], 1000);
  EXPECT_EQ(file.source.format, "DICOM series");
  EXPECT_EQ(file.source.choices.size(), 1U);
  EXPECT_TRUE(file.source.warnings.empty());
}

TEST(DicomFolder, OtherFilesAreSkippedWithAWarning) {
  const TempFolder folder;
  write_series(folder.path(), 3, kUnchanged);
  write_bytes(folder / "README", "Scanned on Monday.");
  write_bytes(folder / "notes.txt", "");
  write_bytes(folder / ".DS_Store", "x");
  write_bytes(folder / "data.bin",
              std::string("\x08\0\x05\0\x10\0\0\0 begins like DICOM, but is another format", 50));
  const VolumeFile file = read_volume_file(folder.path());
  EXPECT_EQ(slice_values(file.volume), (Values{0, 100, 200}));
  EXPECT_EQ(file.source.warnings,
            (Names{"3 files are skipped (not DICOM): README, data.bin, notes.txt"}));
}

TEST(DicomFolder, EmptyFilesThatMayBeSlicesAreErrors) {
  for (const std::string name : {"s9", "a.dcm", "b.IMA", "1.2.840.17"}) {
    const TempFolder folder;
    write_series(folder.path(), 3, kUnchanged);
    write_bytes(folder / name, "");
    expect_error(ErrorCode::bad_file, name + ": is empty", folder.path() / name,
                 [&] { read_volume(folder.path()); });
    expect_error(ErrorCode::bad_file, name + ": is empty", folder.path() / name,
                 [&] { read_volume(folder / "s0"); });
  }
}

TEST(DicomFolder, LoopsOfLinksToFoldersEnd) {
  const TempFolder folder;
  write_series(folder / "a", 3, kUnchanged);
  fs::create_directory_symlink(folder.path(), folder / "a" / "up");
  fs::create_directory_symlink("nowhere", folder / "b");
  EXPECT_EQ(slice_values(read_volume(folder.path())), (Values{0, 100, 200}));
  EXPECT_EQ(slice_values(read_volume(folder / "a" / "up")), (Values{0, 100, 200}));
}

TEST(DicomFolder, IndexAndObjectsWithoutImageAreSkipped) {
  const TempFolder folder;
  write_series(folder.path(), 3, kUnchanged);
  DicomBuilder index, report;
  index.set(0x00080016, "UI", "1.2.840.10008.1.3.10").write(folder / "DICOMDIR");
  report.set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.88.67")
      .set(0x00080060, "CS", "SR")
      .set(0x0020000E, "UI", "1.9")
      .write(folder / "sr");
  EXPECT_EQ(read_volume_file(folder.path()).source.warnings,
            (Names{"1 file is skipped (holds no image (SR)): sr"}));
  expect_error(ErrorCode::unsupported, "is a DICOMDIR", folder / "DICOMDIR",
               [&] { read_volume(folder / "DICOMDIR"); });
  expect_error(ErrorCode::unsupported, "holds no image (SR)", folder / "sr",
               [&] { read_volume(folder / "sr"); });
  fs::remove(folder / "s0"), fs::remove(folder / "s1"), fs::remove(folder / "s2");
  expect_error(ErrorCode::bad_file, "without DICOM images", folder.path(),
               [&] { read_volume(folder.path()); });
}

TEST(DicomFolder, LocalizersAreNotSlices) {
  const TempFolder folder;
  write_series(folder.path(), 3, kUnchanged);
  slice_builder(-100, 7, 9)
      .set(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER")
      .write(folder / "scout");
  const VolumeFile file = read_volume_file(folder.path());
  EXPECT_EQ(slice_values(file.volume), (Values{0, 100, 200}));
  EXPECT_EQ(file.source.warnings, (Names{"1 file is skipped (localizer): scout"}));
}

TEST(DicomFolder, AFolderOfLocalizersIsRead) {
  const TempFolder folder;
  write_series(folder.path(), 3, [](DicomBuilder& slice, int) {
    slice.set(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER");
  });
  EXPECT_EQ(slice_values(read_volume(folder.path())), (Values{0, 100, 200}));
}

TEST(DicomFolder, SeriesAreChosenByNumberOrIdentifier) {
  const TempFolder folder;
  write_series(folder / "a", 3, [](DicomBuilder& slice, int) {
    slice.set(0x0020000E, "UI", "1.2.77.1")
        .set(0x00200011, "IS", "12")
        .set(0x0008103E, "LO", "Head  thin")
        .set(0x00100010, "PN", "Doe^Jane");
  });
  write_series(folder / "b", 4, [](DicomBuilder& slice, int) {
    slice.set(0x0020000E, "UI", "1.2.77.21").set(0x00200011, "IS", "2");
  });
  const FileChoice choice = choice_needed(folder.path());
  EXPECT_EQ(choice.name, "series");
  EXPECT_EQ(
      choice.entries,
      (Names{"series 2, CT, 4 slices of 6 x 4, UID 1.2.77.21",  // sorted by number, not by alphabet
             "series 12 Head thin, CT, 3 slices of 6 x 4, UID 1.2.77.1"}));
  for (const std::string wanted : {"0", "1.2.77.21", "77.21", "21"}) {
    EXPECT_EQ(read_volume(folder.path(), {.series = wanted}).view.grid.size[2], 4U) << wanted;
  }
  for (const std::string wanted : {"1", "1.2.77.1", "77.1"}) {
    EXPECT_EQ(read_volume(folder.path(), {.series = wanted}).view.grid.size[2], 3U) << wanted;
  }
  for (const std::string wanted : {"7", "2.77", "1.2.77", ".", "x", "-1"}) {
    expect_error(ErrorCode::bad_argument, "has no series '" + wanted + "'", folder.path(),
                 [&] { read_volume(folder.path(), {.series = wanted}); });
  }
  const VolumeFile file = read_volume_file(folder.path(), {.series = "1"});
  for (const ReadDecision& decision : file.source.decisions) {
    EXPECT_EQ(decision.value.find("Doe"), std::string::npos) << decision.key;
  }
}

TEST(DicomFolder, TheEndOfAnIdentifierMustNameOneSeries) {
  const TempFolder folder;
  for (const std::string uid : {"1.2.77.5", "1.3.77.5"}) {
    write_series(folder / uid, 3,
                 [&](DicomBuilder& slice, int) { slice.set(0x0020000E, "UI", uid); });
  }
  expect_error(ErrorCode::bad_argument, "has no series '77.5'", folder.path(),
               [&] { read_volume(folder.path(), {.series = "77.5"}); });
}

TEST(DicomFolder, AFileNamesItsSeries) {
  const TempFolder folder;
  write_series(folder.path(), 3, kUnchanged);
  slice_builder(0, 7).set(0x0020000E, "UI", "1.2.77.9").write(folder / "other");
  write_bytes(folder / "holiday.jpg", "\xFF\xD8");
  DicomBuilder(slice_builder(0, 7))
      .set(0x0020000E, "UI", "1.2.77.8")
      .write(folder / "sub" / "deep");
  const VolumeFile file = read_volume_file(folder / "s1");
  EXPECT_EQ(slice_values(file.volume), (Values{0, 100, 200}));
  EXPECT_TRUE(file.source.warnings.empty());
  expect_error(ErrorCode::unsupported, "a single slice", folder / "other",
               [&] { read_volume(folder / "other"); });
}

TEST(DicomFolder, SlicesOfDifferentSizeAreDifferentEntries) {
  const TempFolder folder;
  write_series(folder / "a", 3, kUnchanged);
  write_series(folder / "b", 2, [](DicomBuilder& slice, int) { slice.set_short(0x00280010, 2); });
  EXPECT_EQ(choice_needed(folder.path()).entries,
            (Names{"series 3, axial, CT, 3 slices of 6 x 4, UID 1.2.826.0.1.3680043.2.1125.7",
                   "series 3, axial, CT, 2 slices of 6 x 2, UID 1.2.826.0.1.3680043.2.1125.7"}));
  EXPECT_EQ(read_volume(folder.path(), {.series = "1"}).view.grid.size,
            (std::array<std::size_t, 3>{6, 2, 2}));
}

TEST(DicomFolder, SlicesOfDifferentOrientationAreDifferentEntries) {
  const TempFolder folder;
  write_series(folder / "a", 3, kUnchanged);
  write_series(folder / "b", 3, [](DicomBuilder& slice, int i) {
    slice.set_decimals(0x00200037, {0, 1, 0, 0, 0, -1}).set_decimals(0x00200032, {3.0 * i, 0, 0});
  });
  const FileChoice choice = choice_needed(folder.path());
  ASSERT_EQ(choice.entries.size(), 2U);
  EXPECT_NE(choice.entries[0].find("axial"), std::string::npos);
  EXPECT_NE(choice.entries[1].find("sagittal"), std::string::npos);
  EXPECT_EQ(read_volume(folder.path(), {.series = "1"}).view.grid.direction[1], (Vec3{0, 0, -1}));
}

// Two reconstructions in one series; some of their slices have the same position.
TEST(DicomFolder, ThinAndThickSlicesAreDifferentEntries) {
  const TempFolder folder;
  write_series(folder / "thin", 5,
               [](DicomBuilder& slice, int) { slice.set(0x00180050, "DS", "2.0"); });
  write_series(folder / "thick", 3, [](DicomBuilder& slice, int i) {
    slice.set(0x00180050, "DS", i == 0 ? "4" : "4.00")
        .set_decimals(0x00200032, {-10, 20, 5 + 4.0 * i});
  });
  const FileChoice choice = choice_needed(folder.path());
  ASSERT_EQ(choice.entries.size(), 2U);
  EXPECT_NE(choice.entries[0].find("slice thickness 2"), std::string::npos) << choice.entries[0];
  EXPECT_EQ(read_volume(folder.path(), {.series = "0"}).view.grid.spacing.z, 2);
  EXPECT_EQ(read_volume(folder.path(), {.series = "1"}).view.grid.spacing.z, 4);
}

struct TimeAttribute {
  std::uint32_t tag;
  std::string type, first, second, name;
};

TEST(DicomFolder, SlicesAtOnePositionAreTimePoints) {
  const std::vector<TimeAttribute> attributes{
      {0x00200100, "IS", "10", "9", "time point"},  // numbers are sorted by value
      {0x00181060, "DS", "120.5", "40", "trigger time"},
      {0x00180086, "IS", "2", "1", "echo"},
      {0x00200012, "IS", "2", "1", "acquisition"},
      {0x00080032, "TM", "101501", "101455.5", "acquisition time"},
      {0x00180082, "DS", "900", "50", "inversion time"}};
  for (const TimeAttribute& attribute : attributes) {
    SCOPED_TRACE(attribute.name);
    const TempFolder folder;
    write_series(folder / "a", 3, [&](DicomBuilder& slice, int) {
      slice.set(attribute.tag, attribute.type, attribute.first);
    });
    write_series(folder / "b", 3, [&](DicomBuilder& slice, int i) {
      slice.set(attribute.tag, attribute.type, attribute.second)
          .set(0x7FE00010, "OW", bytes_of(frame_samples(static_cast<std::int16_t>(7 + i))));
    });
    const FileChoice choice = choice_needed(folder.path());
    EXPECT_EQ(choice.name, "time");
    EXPECT_EQ(choice.entries, (Names{attribute.name + " " + attribute.second,
                                     attribute.name + " " + attribute.first}));
    EXPECT_EQ(slice_values(read_volume(folder.path(), {.time = 0})), (Values{7, 8, 9}));
    EXPECT_EQ(slice_values(read_volume(folder.path(), {.time = 1})), (Values{0, 100, 200}));
    EXPECT_EQ(slice_values(read_volume(folder / "b" / "s1")), (Values{7, 8, 9}));
  }
}

// Neither attribute alone distinguishes the four volumes; the time of a slice does not distinguish
// any.
TEST(DicomFolder, TwoAttributesDistinguishVolumes) {
  const TempFolder folder;
  for (int volume = 0; volume < 4; ++volume) {
    write_series(folder / std::to_string(volume), 3, [&](DicomBuilder& slice, int i) {
      slice.set(0x00180086, "IS", std::to_string(volume % 2))
          .set(0x00181060, "DS", std::to_string(volume / 2 * 50));
      slice.set(0x00080033, "TM", std::string("1015") + std::to_string(10 + i * 4 + volume));
      slice.set(0x7FE00010, "OW",
                bytes_of(frame_samples(static_cast<std::int16_t>(10 * volume + i))));
    });
  }
  const FileChoice choice = choice_needed(folder.path());
  EXPECT_EQ(choice.entries, (Names{"trigger time 0, echo 0", "trigger time 0, echo 1",
                                   "trigger time 50, echo 0", "trigger time 50, echo 1"}));
  EXPECT_EQ(slice_values(read_volume(folder.path(), {.time = 2})), (Values{20, 21, 22}));
}

TEST(DicomFolder, TheOrderOfImagesDistinguishesVolumesIfNoAttributeDoes) {
  const TempFolder folder;
  for (int volume = 0; volume < 2; ++volume) {
    write_series(folder / std::to_string(volume), 3, [&](DicomBuilder& slice, int i) {
      slice.set(0x00200013, "IS", std::to_string(1 + volume * 3 + i))
          .set(0x7FE00010, "OW",
               bytes_of(frame_samples(static_cast<std::int16_t>(10 * volume + i))));
    });
  }
  EXPECT_EQ(choice_needed(folder.path()).entries, (Names{"images 1 to 3", "images 4 to 6"}));
  EXPECT_EQ(slice_values(read_volume(folder.path(), {.time = 1})), (Values{10, 11, 12}));
}

TEST(DicomFolder, VolumesWithDifferentNumbersOfSlicesAreRefused) {
  const TempFolder folder;
  write_series(folder / "a", 3, [](DicomBuilder& slice, int) { slice.set(0x00200100, "IS", "1"); });
  write_series(folder / "b", 2, [](DicomBuilder& slice, int) {
    slice.set(0x00200100, "IS", "2").set(0x00200013, "IS", "40");
  });
  expect_error(ErrorCode::unsupported, "two slices at one position: a/s2, b/s1", folder.path(),
               [&] { read_volume(folder.path()); });
}

TEST(DicomFolder, CopiesOfAFileAreOneSlice) {
  const TempFolder folder;
  write_series(folder.path(), 3, kUnchanged);
  fs::copy(folder / "s1", folder / "s1 (1)");
  const VolumeFile file = read_volume_file(folder.path());
  EXPECT_EQ(slice_values(file.volume), (Values{0, 100, 200}));
  EXPECT_EQ(file.source.warnings, (Names{"1 file is a copy of another and skipped: s1 (1)"}));
}

TEST(DicomFolder, ColourImagesOfOtherSeriesAreSkipped) {
  const TempFolder folder;
  write_series(folder.path(), 3, kUnchanged);
  DicomBuilder screenshot = slice_builder(0, 0, 50);
  screenshot.set(0x0020000E, "UI", "1.2.77.9")
      .set_short(0x00280002, 3)
      .set(0x00280004, "CS", "RGB")
      .remove(0x00200032);
  screenshot.write(folder / "screen");
  EXPECT_EQ(read_volume_file(folder.path()).source.warnings,
            (Names{"1 file is skipped (is a colour image (RGB)): screen"}));
  expect_error(ErrorCode::unsupported, "is a colour image (RGB)", folder / "screen",
               [&] { read_volume(folder / "screen"); });
}

TEST(DicomFolder, ASliceWithoutPositionIsAnError) {
  const TempFolder folder;
  write_series(folder.path(), 4, [](DicomBuilder& slice, int i) {
    if (i == 3) slice.remove(0x00200032);
  });
  expect_error(ErrorCode::unsupported, "no position (ImagePositionPatient)", folder / "s0",
               [&] { read_volume(folder.path()); });
}

TEST(DicomFolder, DamageMattersOnlyInTheFilesThatAreRead) {
  const TempFolder folder;
  write_series(folder / "good", 3, kUnchanged);
  write_series(folder / "bad", 3, [](DicomBuilder& slice, int) {
    slice.set(0x0020000E, "UI", "1.2.77.9").set(0x00200011, "IS", "9");
  });
  const std::string whole = read_bytes(folder / "bad" / "s1");
  write_bytes(folder / "bad" / "s1", whole.substr(0, whole.size() - 10));
  EXPECT_EQ(slice_values(read_volume(folder.path(), {.series = "0"})), (Values{0, 100, 200}));
  EXPECT_EQ(slice_values(read_volume(folder / "good" / "s1")), (Values{0, 100, 200}));
  expect_error(ErrorCode::bad_file, "is cut off", folder / "bad" / "s1",
               [&] { read_volume(folder.path(), {.series = "1"}); });
}

TEST(DicomFolder, PixelSpacingMustBeTheSameEverywhere) {
  const TempFolder folder;
  write_series(folder.path(), 3, [](DicomBuilder& slice, int i) {
    if (i == 1) slice.set_decimals(0x00280030, {0.75, 0.6});
  });
  expect_error(ErrorCode::bad_file, "differs in pixel spacing (0.6 x 0.75, not 0.5 x 0.75) from s2",
               folder / "s1", [&] { read_volume(folder.path()); });
}

// Two volumes of four slices in one series, the second from `first` on. Together they may look like
// one even stack.
void write_two_volumes(const fs::path& folder, double first,
                       const std::function<void(DicomBuilder&, int)>& change) {
  for (int volume = 0; volume < 2; ++volume) {
    for (int i = 0; i < 4; ++i) {
      const double z = (volume == 0 ? 5 : first) + 2.0 * i;
      DicomBuilder slice =
          slice_builder(z, static_cast<std::int16_t>(100 * i + 1000 * volume), 1 + i + 4 * volume);
      change(slice, volume);
      slice.write(folder / (std::string("v") + std::to_string(volume) + "s" + std::to_string(i)));
    }
  }
}

const std::vector<std::pair<std::string, std::function<void(DicomBuilder&, int)>>>
    kVolumeAttributes{
        {"time point", [](DicomBuilder& slice,
                          int volume) { slice.set(0x00200100, "IS", std::to_string(volume + 1)); }},
        {"echo", [](DicomBuilder& slice,
                    int volume) { slice.set(0x00180086, "IS", std::to_string(volume + 1)); }},
        {"echo time",
         [](DicomBuilder& slice, int volume) {
           slice.set(0x00180081, "DS", std::to_string(10 * volume + 10));
         }},
    };

TEST(DicomFolder, InterleavedVolumesAreDistinguished) {
  for (const auto& [name, change] : kVolumeAttributes) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    write_two_volumes(folder.path(), 6, change);
    const FileChoice choice = choice_needed(folder.path());
    EXPECT_EQ(choice.name, "time");
    ASSERT_EQ(choice.entries.size(), 2U);
    EXPECT_TRUE(choice.entries[0].starts_with(name + " ")) << choice.entries[0];
    const Volume second = read_volume(folder.path(), {.time = 1});
    EXPECT_EQ(slice_values(second), (Values{1000, 1100, 1200, 1300}));
    EXPECT_EQ(second.view.grid.spacing.z, 2);
    EXPECT_EQ(second.view.grid.origin.z, 6);
  }
}

TEST(DicomFolder, AdjoiningVolumesAreDistinguished) {
  for (const auto& [name, change] : kVolumeAttributes) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    write_two_volumes(folder.path(), 13, change);
    EXPECT_EQ(choice_needed(folder.path()).name, "series");
    EXPECT_EQ(slice_values(read_volume(folder.path(), {.series = "1"})),
              (Values{1000, 1100, 1200, 1300}));
  }
  const TempFolder folder;  // one long volume
  write_two_volumes(folder.path(), 13, [](DicomBuilder& slice, int volume) {
    slice.set(0x00200012, "IS", std::to_string(volume));
  });
  EXPECT_EQ(read_volume(folder.path()).view.grid.size[2], 8U);
}

TEST(DicomFolder, PositionsOfOtherPatientsStudiesAndFramesOfReferenceAreNotCompared) {
  for (const auto& [tag, type] :
       {std::pair{0x00200052U, "UI"}, {0x0020000DU, "UI"}, {0x00100020U, "LO"}}) {
    SCOPED_TRACE(tag);
    const TempFolder folder;
    write_two_volumes(folder.path(), 6, [&](DicomBuilder& slice, int volume) {
      slice.set(tag, type, std::string("1.") + std::to_string(volume));
    });
    EXPECT_EQ(choice_needed(folder.path()).name, "series");
    EXPECT_EQ(slice_values(read_volume(folder.path(), {.series = "1"})),
              (Values{1000, 1100, 1200, 1300}));
  }
  const TempFolder folder;  // anonymized slice by slice
  write_series(folder.path(), 4, [](DicomBuilder& slice, int i) {
    slice.set(0x00200052, "UI", std::string("1.") + std::to_string(i));
  });
  EXPECT_EQ(slice_values(read_volume(folder.path())), (Values{0, 100, 200, 300}));
}

TEST(DicomFolder, VolumesThatMovedALittleAreTimePoints) {
  const TempFolder folder;
  write_two_volumes(folder.path(), 5.3, kVolumeAttributes[0].second);
  EXPECT_EQ(choice_needed(folder.path()).entries, (Names{"time point 1", "time point 2"}));
  EXPECT_EQ(read_volume(folder.path(), {.time = 0}).view.grid.origin.z, 5);
  EXPECT_EQ(read_volume(folder.path(), {.time = 1}).view.grid.origin.z, 5.3);
}

TEST(DicomFolder, SmallDifferencesMustNotAddUp) {
  const TempFolder folder;
  double z = 0;
  for (int i = 0; i <= 40;
       ++i) {  // each gap is near 2, but the middle slice is almost a step off its position
    slice_builder(z, 0, i + 1).write(folder / (std::string("s") + std::to_string(100 + i)));
    z += i < 20 ? 1.91 : 2.09;
  }
  expect_error(
      ErrorCode::bad_file,
      "not evenly spaced: s120 is 1.8 from its position in an even stack of slices 2 apart",
      folder.path(), [&] { read_volume(folder.path()); });
}

TEST(DicomFolder, SlicesOffTheLineAreNamed) {
  const TempFolder folder;
  write_series(folder.path(), 5, [](DicomBuilder& slice, int i) {
    if (i == 2) slice.set_decimals(0x00200032, {-9.7, 20, 9});
  });
  expect_error(ErrorCode::bad_file,
               "not in line: s2 lies 0.3 from the line through the first and the last slice",
               folder.path(), [&] { read_volume(folder.path()); });
}

TEST(DicomFolder, DifferencesThatMayMeanSeveralVolumesGiveAWarning) {
  const TempFolder folder;
  write_series(folder.path(), 4, [](DicomBuilder& slice, int i) {
    slice.set(0x00181314, "DS", std::to_string(10 + 5 * (i % 2)))
        .set(0x00080008, "CS", "ORIGINAL\\PRIMARY");
  });
  EXPECT_EQ(read_volume_file(folder.path()).source.warnings,
            (Names{"its slices differ in flip angle (10, 15); they are read as one volume"}));
}

TEST(DicomFolder, TimesOfTheClockKeepTheirDigits) {
  const TempFolder folder;
  write_two_volumes(folder.path(), 5, [](DicomBuilder& slice, int volume) {
    slice.set(0x00080033, "TM", volume == 0 ? "080000" : "100000");
  });
  EXPECT_EQ(choice_needed(folder.path()).entries,
            (Names{"content time 080000", "content time 100000"}));
}

TEST(DicomFolder, InvalidNumbersAreNotPositions) {
  const TempFolder folder;
  write_series(folder.path(), 4, [](DicomBuilder& slice, int i) {
    const double z = i == 2 ? std::nan("") : 5 + 2.0 * i;
    slice.set(0x00200032, "FD", bytes_of<double>({z, 20, 9}));
  });
  expect_error(ErrorCode::unsupported, "no position (ImagePositionPatient)", folder / "s1",
               [&] { read_volume(folder.path()); });
}

// Found by review: the product of such sizes was 0, and the length of the samples was divided by
// it.
TEST(DicomFolder, SizesBeyondTheStandardsAreRefused) {
  const TempFolder folder;
  DicomBuilder slice = slice_builder(0, 0);
  slice.set(0x00280010, "UL", bytes_of<std::uint32_t>({0x80000000U}))
      .set(0x00280011, "UL", bytes_of<std::uint32_t>({0x80000000U}));
  slice.write(folder / "a.dcm");
  expect_error(ErrorCode::unsupported, "2147483648 x 2147483648, expected at most 65535",
               folder / "a.dcm", [&] { read_volume(folder / "a.dcm"); });
}

}  // namespace
}  // namespace isoatlas::detail::test
