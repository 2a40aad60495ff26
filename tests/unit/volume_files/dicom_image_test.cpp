// SPDX-License-Identifier: Apache-2.0
// The frames and samples that one DICOM file can describe.
#include <gtest/gtest.h>
#include <zlib.h>

#include <functional>
#include <limits>
#include <string>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/dicom_builder.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;
using Values = std::vector<double>;
using Names = std::vector<std::string>;
using Edit = std::function<void(DicomBuilder&)>;

VolumeFile read_image(const DicomBuilder& image, std::string_view syntax = kExplicitLittle,
                      const ReadOptions& options = {}) {
  const TempFolder folder;
  image.write(folder / "a.dcm", syntax);
  return read_volume_file(folder / "a.dcm", options);
}

void expect_refused(const DicomBuilder& image, const std::string& fragment,
                    ErrorCode code = ErrorCode::unsupported) {
  const TempFolder folder;
  image.write(folder / "a.dcm");
  expect_error(code, fragment, folder / "a.dcm", [&] { read_volume(folder / "a.dcm"); });
  expect_error(code, fragment, folder.path(), [&] { read_volume(folder.path()); });
}

DicomBuilder enhanced() { return enhanced_builder({5, 7, 9}); }

// The enhanced image with other samples: three frames that begin with `first`, followed by `value`.
template <class Stored>
DicomBuilder with_samples(std::uint16_t allocated, std::uint16_t stored, std::uint16_t high,
                          bool is_signed, const std::vector<Stored>& values) {
  DicomBuilder image = enhanced();
  image.set_short(0x00280100, allocated)
      .set_short(0x00280101, stored)
      .set_short(0x00280102, high)
      .set_short(0x00280103, is_signed);
  std::string bytes;
  for (const Stored value : values) bytes += bytes_of(std::vector<Stored>(kFrameSamples, value));
  return image.set(0x7FE00010, "OW", bytes);
}

void expect_values(const DicomBuilder& image, SampleType type, const Values& values) {
  const Volume volume = read_image(image).volume;
  EXPECT_EQ(volume.view.type, type) << name(volume.view.type);
  EXPECT_EQ(slice_values(volume), values);
}

// --- samples

TEST(DicomImage, SamplesKeepTheirType) {
  expect_values(with_samples<std::uint8_t>(8, 8, 7, false, {0, 200, 255}), SampleType::uint8,
                {0, 200, 255});
  expect_values(with_samples<std::int8_t>(8, 8, 7, true, {-128, 0, 127}), SampleType::int8,
                {-128, 0, 127});
  expect_values(with_samples<std::uint16_t>(16, 16, 15, false, {0, 40000, 65535}),
                SampleType::uint16, {0, 40000, 65535});
  expect_values(with_samples<std::int16_t>(16, 16, 15, true, {-32768, 0, 32767}), SampleType::int16,
                {-32768, 0, 32767});
  expect_values(with_samples<std::uint32_t>(32, 32, 31, false, {0, 7, 4294967295U}),
                SampleType::uint32, {0, 7, 4294967295.0});
  expect_values(with_samples<std::int32_t>(32, 32, 31, true, {-70000, 0, 70000}), SampleType::int32,
                {-70000, 0, 70000});
}

TEST(DicomImage, FewerStoredBitsKeepTheAllocatedType) {
  expect_values(with_samples<std::uint16_t>(16, 8, 7, false, {0, 200, 255}), SampleType::uint16,
                {0, 200, 255});
  expect_values(with_samples<std::uint32_t>(32, 12, 11, false, {0, 200, 4095}), SampleType::uint32,
                {0, 200, 4095});
}

TEST(DicomImage, OtherAllocatedBitsAreIgnored) {
  expect_values(with_samples<std::uint16_t>(16, 12, 11, false, {0xF123, 0x0FFF, 0x1000}),
                SampleType::uint16, {0x123, 0xFFF, 0});
  expect_values(with_samples<std::uint16_t>(16, 12, 11, true, {0x0800, 0x0FFF, 0xF001}),
                SampleType::int16, {-2048, -1, 1});
  expect_values(with_samples<std::uint16_t>(16, 12, 15, false, {0x123F, 0xFFF0, 0x0010}),
                SampleType::uint16, {0x123, 0xFFF, 1});  // the stored bits are the highest
  expect_values(with_samples<std::uint16_t>(16, 10, 12, true, {0x1008, 0x0008, 0x0007}),
                SampleType::int16, {-511, 1, 0});
  expect_values(with_samples<std::uint32_t>(32, 20, 19, true, {0xFFF80000U, 5, 0xFFFFFU}),
                SampleType::int32, {-524288, 5, -1});
}

TEST(DicomImage, WholeRescalesGiveIntegers) {
  struct Case {
    double slope, intercept;
    SampleType type;
    Values values;
  };
  const std::vector<Case> cases{{1, -1024, SampleType::int16, {-1024, 76, 3071}},
                                {1, 0, SampleType::uint16, {0, 1100, 4095}},
                                {2, 5, SampleType::uint16, {5, 2205, 8195}},
                                {-1, 0, SampleType::int16, {0, -1100, -4095}},
                                {-1, 4095, SampleType::uint16, {4095, 2995, 0}},
                                {100, -7, SampleType::int32, {-7, 109993, 409493}},
                                {1e6, 0, SampleType::uint32, {0, 1.1e9, 4.095e9}},
                                {2e6, 0, SampleType::float64, {0, 2.2e9, 8.19e9}},
                                {1, 1e10, SampleType::float64, {1e10, 1e10 + 1100, 1e10 + 4095}}};
  for (const Case& one : cases) {
    SCOPED_TRACE(decimals({one.slope, one.intercept}));
    DicomBuilder image = with_samples<std::uint16_t>(16, 12, 11, false, {0, 1100, 4095});
    image.set_decimals(0x00281053, {one.slope}).set_decimals(0x00281052, {one.intercept});
    expect_values(image, one.type, one.values);
  }
}

TEST(DicomImage, FractionalRescalesGiveFloats) {
  DicomBuilder image = with_samples<std::int16_t>(16, 16, 15, true, {-4, 0, 10});
  expect_values(image.set(0x00281053, "DS", "+0.25 ").set(0x00281052, "DS", "1e1"),
                SampleType::float64, {9, 10, 12.5});
}

TEST(DicomImage, ARescaleSlopeOfZeroIsIgnored) {
  DicomBuilder image = enhanced();
  const VolumeFile file = read_image(image.set(0x00281053, "DS", "0").set(0x00281052, "DS", "-5"));
  EXPECT_EQ(slice_values(file.volume), (Values{-5, 95, 195}));
  EXPECT_EQ(file.source.warnings, (Names{"states a rescale slope of 0; 1 is used"}));
}

TEST(DicomImage, ARescaleThatIsNotANumberIsRefused) {
  DicomBuilder image = enhanced();
  expect_refused(image.set(0x00281053, "DS", "one"),
                 "has a RescaleSlope of 'one', expected a number");
}

TEST(DicomImage, SignedAndUnsignedSlicesAreOneVolume) {
  const TempFolder folder;
  write_series(folder.path(), 3, [](DicomBuilder& slice, int i) {
    if (i == 1)
      slice.set_short(0x00280103, 0)
          .set(0x7FE00010, "OW", bytes_of(std::vector<std::uint16_t>(kFrameSamples, 60000)));
  });
  const Volume volume = read_volume(folder.path());
  EXPECT_EQ(volume.view.type, SampleType::int32);
  EXPECT_EQ(slice_values(volume), (Values{0, 60000, 200}));
}

TEST(DicomImage, FloatingPixelData) {
  DicomBuilder image = enhanced();
  std::string floats, doubles;
  for (const float value : {-1.5F, 0.25F, 1e30F})
    floats += bytes_of(std::vector<float>(kFrameSamples, value));
  for (const double value : {-1.5, 0.25, 1e300})
    doubles += bytes_of(std::vector<double>(kFrameSamples, value));
  image.remove(0x7FE00010)
      .remove(0x00280100)
      .remove(0x00280101)
      .remove(0x00280102)
      .remove(0x00280103);
  expect_values(DicomBuilder(image).set(0x7FE00008, "OF", floats), SampleType::float32,
                {-1.5, 0.25, static_cast<double>(1e30F)});
  expect_values(DicomBuilder(image).set(0x7FE00009, "OD", doubles), SampleType::float64,
                {-1.5, 0.25, 1e300});
}

TEST(DicomImage, PaddingIsKeptAndReported) {
  DicomBuilder image = enhanced();
  const VolumeFile file = read_image(image.set(0x00280120, "SS", bytes_of<std::int16_t>({-2000})));
  EXPECT_EQ(file.source.decisions.back().key, "padding value");
  EXPECT_EQ(file.source.decisions.back().value, "-2000; kept as samples");
}

TEST(DicomImage, OtherValuesThanGreyAreRefused) {
  const auto refuse = [](const Edit& edit, const std::string& fragment) {
    DicomBuilder image = enhanced();
    edit(image);
    expect_refused(image, fragment);
  };
  refuse([](DicomBuilder& d) { d.set_short(0x00280002, 3).set(0x00280004, "CS", "YBR_FULL_422"); },
         "colour image (YBR_FULL_422)");
  refuse([](DicomBuilder& d) { d.set(0x00280004, "CS", "PALETTE COLOR"); },
         "colour image (PALETTE COLOR)");
  refuse([](DicomBuilder& d) { d.set(0x00080008, "CS", "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC"); },
         "is a mosaic");
  refuse(
      [](DicomBuilder& d) {
        d.set(0x00190010, "LO", "SIEMENS MR HEADER").set_short(0x0019100A, 36);
      },
      "is a mosaic");
  refuse(
      [](DicomBuilder& d) {
        d.set_items(0x00283000, {DicomBuilder().set(0x00283006, "US", "ab")});
      },
      "modality lookup table");
  refuse([](DicomBuilder& d) { d.set_short(0x00280100, 12); },
         "12 bits per sample (BitsAllocated)");
  refuse([](DicomBuilder& d) { d.set_short(0x00280100, 1); }, "1 bits per sample (BitsAllocated)");
  refuse([](DicomBuilder& d) { d.remove(0x00280100); }, "0 bits per sample (BitsAllocated)");
  refuse([](DicomBuilder& d) { d.set_short(0x00280102, 7); },
         "contradictory bits: 16 stored of 16 allocated, high bit 7");
  refuse([](DicomBuilder& d) { d.set_short(0x00280101, 17); }, "contradictory bits");
  refuse([](DicomBuilder& d) { d.set_short(0x00280010, 0); }, "states no image size");
}

TEST(DicomImage, OtherMakersMayUseTheMosaicElement) {
  DicomBuilder image = enhanced();
  image.set(0x00190010, "LO", "GEMS_ACQU_01").set_short(0x0019100A, 36);
  EXPECT_EQ(slice_values(read_image(image).volume), (Values{0, 100, 200}));
}

TEST(DicomImage, PixelDataMustHaveAllItsFrames) {
  DicomBuilder image = enhanced();
  const std::string frame(kFrameSamples * 2, 'x');
  expect_refused(image.set(0x7FE00010, "OW", frame + frame + frame.substr(2)),
                 "its pixel data has 142 bytes, its header states 3 x 48", ErrorCode::bad_file);
  const VolumeFile file = read_image(image.set(0x7FE00010, "OW", frame + frame + frame + "more"));
  EXPECT_EQ(file.source.warnings,
            (Names{"has 4 bytes of pixel data more than its frames need; they are ignored"}));
}

TEST(DicomImage, AnOddNumberOfBytesIsPadded) {
  DicomBuilder image = with_samples<std::uint8_t>(8, 8, 7, false, {});
  image.set_short(0x00280010, 3).set_short(0x00280011, 3);  // 27 bytes and one of padding
  std::string bytes;
  for (const char value : {'\1', '\2', '\3'}) bytes += std::string(9, value);
  const VolumeFile file = read_image(image.set(0x7FE00010, "OB", bytes));
  EXPECT_EQ(slice_values(file.volume), (Values{1, 2, 3}));
  EXPECT_TRUE(file.source.warnings.empty());
}

TEST(DicomImage, ManyFramesStatedByAFewBytesAreNotAllocated) {
  DicomBuilder image = image_builder();
  image.set(0x00280008, "IS", "2147483647")
      .set_short(0x00280010, 65535)
      .set_short(0x00280011, 65535);
  image.set_decimals(0x00200032, {0, 0, 0})
      .set_decimals(0x00200037, {1, 0, 0, 0, 1, 0})
      .set_decimals(0x00180088, {1});
  expect_refused(image.set(0x7FE00010, "OW", std::string(100, 'x')), "is cut off",
                 ErrorCode::bad_file);
}

// --- encodings

TEST(DicomImage, EveryEncodingIsTheSameVolume) {
  const VolumeFile reference = read_image(enhanced());
  for (const std::string_view syntax : {kImplicitLittle, kExplicitBig}) {
    const VolumeFile file = read_image(enhanced(), syntax);
    EXPECT_EQ(sample_digest(file.volume), sample_digest(reference.volume)) << syntax;
    EXPECT_EQ(file.volume.view.grid.spacing, reference.volume.view.grid.spacing) << syntax;
  }
}

TEST(DicomImage, BytesInBigEndianWordsAreSwapped) {
  DicomBuilder image = with_samples<std::uint8_t>(8, 8, 7, false, {});
  image.set_short(0x00280010, 3).set_short(0x00280011, 3);
  std::string bytes(28, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i);
  for (const std::string type : {"OW", "OB"}) {  // the builder swaps the bytes of words
    const Volume volume = read_image(image.set(0x7FE00010, type, bytes), kExplicitBig).volume;
    const auto* samples = static_cast<const std::uint8_t*>(volume.view.samples);
    for (std::size_t i = 0; i < 27; ++i) ASSERT_EQ(samples[i], i) << type;
  }
}

TEST(DicomImage, SamplesOfFourBytesAreSwapped) {
  DicomBuilder image = with_samples<std::uint32_t>(32, 32, 31, false, {1, 0x01020304, 70000});
  const TempFolder folder;
  std::string file = image.remove(0x7FE00010).file(kExplicitBig);
  file += std::string("\x7F\xE0\0\x10OB\0\0\0\0\x01\x20", 12);
  for (const std::uint32_t value : {1U, 0x01020304U, 70000U}) {
    for (std::size_t i = 0; i < kFrameSamples; ++i) {
      for (int bit = 24; bit >= 0; bit -= 8) file += static_cast<char>(value >> bit & 255U);
    }
  }
  write_bytes(folder / "a.dcm", file);
  EXPECT_EQ(slice_values(read_volume(folder / "a.dcm")), (Values{1, 0x01020304, 70000}));
}

TEST(DicomImage, FilesWithoutPreambleAreRead) {
  for (const std::string_view syntax : {kImplicitLittle, kExplicitLittle}) {
    const TempFolder folder;
    write_bytes(folder / "a.dcm", enhanced().data_set(syntax));
    write_bytes(folder / "sub", "");
    fs::remove(folder / "sub");
    EXPECT_EQ(slice_values(read_volume(folder / "a.dcm")), (Values{0, 100, 200})) << syntax;
    EXPECT_EQ(slice_values(read_volume(folder.path())), (Values{0, 100, 200})) << syntax;
  }
}

TEST(DicomImage, AWrongTransferSyntaxIsDetected) {
  const std::string head(128, '\0');
  for (const auto& [stated, real] :
       {std::pair(kExplicitLittle, kImplicitLittle), std::pair(kImplicitLittle, kExplicitLittle)}) {
    const TempFolder folder;
    const std::string data = enhanced().data_set(real), file = enhanced().file(stated);
    write_bytes(folder / "a.dcm",
                file.substr(0, file.size() - enhanced().data_set(stated).size()) + data);
    EXPECT_EQ(slice_values(read_volume(folder / "a.dcm")), (Values{0, 100, 200})) << stated;
  }
}

TEST(DicomImage, DeflatedDataSetsAreRead) {
  const std::string data = enhanced().data_set();
  std::string packed(data.size() + 100, '\0');
  z_stream stream{};
  ASSERT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  ASSERT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  const TempFolder folder;
  const std::string head = DicomBuilder().file("1.2.840.10008.1.2.1.99");
  write_bytes(folder / "a.dcm", head + packed);
  EXPECT_EQ(slice_values(read_volume(folder / "a.dcm")), (Values{0, 100, 200}));
  write_bytes(folder / "a.dcm", head + packed.substr(0, packed.size() / 2));
  expect_error(ErrorCode::bad_file, "deflated data set is damaged or cut off", folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm"); });
  write_bytes(folder / "a.dcm", head + packed);
  expect_error(ErrorCode::out_of_memory, "larger than the limit", folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm", {.max_memory = 500}); });
}

TEST(DicomImage, SequencesMayHaveNoLengthsOrAnUnknownType) {
  DicomBuilder orientation, measures, shared, content;
  orientation.set_decimals(0x00200037, {1, 0, 0, 0, 1, 0});
  measures.set_decimals(0x00280030, {0.75, 0.5});
  shared.set_items(0x00209116, {orientation}, false).set_items(0x00289110, {measures}, false);
  DicomBuilder image = enhanced();
  image.set_items(0x52009229, {shared}, false);
  image.set_items(0x00081140,
                  {DicomBuilder().set_items(0x00081199, {DicomBuilder(), DicomBuilder()}, false)},
                  false);  // not used by the reader
  EXPECT_EQ(read_image(image).volume.view.grid.spacing, (Vec3{0.5, 0.75, 2}));
  // A writer that does not know an element copies it unchanged: implicit and of type UN.
  const std::string item = shared.data_set(kImplicitLittle);
  const auto length = static_cast<std::uint32_t>(item.size());
  image.set(0x52009229, "UN",
            std::string("\xFE\xFF\0\xE0", 4) + bytes_of<std::uint32_t>({length}) + item);
  EXPECT_EQ(read_image(image).volume.view.grid.spacing, (Vec3{0.5, 0.75, 2}));
}

// An icon compressed by JPEG: its pixel data has fragments instead of a length, within a sequence.
TEST(DicomImage, IconsMayBeCompressed) {
  const std::string fragments = std::string("\xE0\x7F\x10\0OB\0\0\xFF\xFF\xFF\xFF", 12) +
                                std::string("\xFE\xFF\0\xE0\0\0\0\0", 8) +
                                std::string("\xFE\xFF\0\xE0\x04\0\0\0\xFF\xD8\xFF\xD9", 12) +
                                std::string("\xFE\xFF\xDD\xE0\0\0\0\0", 8);
  DicomBuilder size;
  size.set_short(0x00280010, 1).set_short(0x00280011, 1);
  const std::string item = std::string("\xFE\xFF\0\xE0\xFF\xFF\xFF\xFF", 8) + size.data_set() +
                           fragments + std::string("\xFE\xFF\x0D\xE0\0\0\0\0", 8);
  DicomBuilder image = enhanced();
  image.set(0x00880200, "SQ", item);
  EXPECT_EQ(slice_values(read_image(image).volume), (Values{0, 100, 200}));
}

TEST(DicomImage, FilesCutOffAnywhereAreErrors) {
  const std::string whole = enhanced().file();
  const TempFolder folder;
  for (std::size_t length = 140; length < whole.size(); ++length) {
    write_bytes(folder / "a.dcm", whole.substr(0, length));
    try {
      read_volume(folder / "a.dcm");
      ADD_FAILURE() << "cut at " << length;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("a.dcm"), std::string::npos) << error.what();
    }
  }
}

TEST(DicomImage, LengthsBeyondTheFileAreErrors) {
  DicomBuilder image = enhanced();
  const std::string whole = image.file();
  const TempFolder folder;
  for (std::size_t at = 132; at + 4 < whole.size(); at += 2) {  // elements begin at even offsets
    std::string changed = whole;
    for (const char byte : {'\xFF', '\x7F', '\0'}) {
      changed.replace(at, 4, 4, byte);
      write_bytes(folder / "a.dcm", changed);
      try {
        read_volume(folder / "a.dcm");  // correct or refused, never a crash
      } catch (const Error& error) {
        EXPECT_TRUE(std::string(error.what()).find("a.dcm") != std::string::npos) << error.what();
      }
    }
  }
}

TEST(DicomImage, SequencesNestedWithoutEndAreErrors) {
  const TempFolder folder;
  std::string deep = DicomBuilder().file();
  for (int i = 0; i < 100000; ++i)
    deep += std::string("\x08\0\x40\x11SQ\0\0\xFF\xFF\xFF\xFF\xFE\xFF\0\xE0\xFF\xFF\xFF\xFF", 20);
  write_bytes(folder / "a.dcm", deep);
  expect_error(ErrorCode::bad_file, "not valid", folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm"); });
}

TEST(DicomImage, OtherFilesWithTheExtensionAreRefused) {
  const TempFolder folder;
  write_bytes(folder / "a.dcm", "hello, this is no DICOM file at all");
  expect_error(ErrorCode::bad_file, "is not a DICOM file", folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm"); });
}

// --- positions

TEST(DicomImage, TheFramesOwnPlanePrecedesTheSharedOne) {
  DicomBuilder image = enhanced();
  std::vector<DicomBuilder> frames;
  for (const double z : {5.0, 7.5, 10.0}) {
    DicomBuilder position, orientation, measures, frame;
    position.set_decimals(0x00200032, {1, 2, z});
    orientation.set_decimals(0x00200037, {0, 1, 0, -1, 0, 0});
    measures.set_decimals(0x00280030, {0.25, 0.125});
    frames.push_back(frame.set_items(0x00209113, {position})
                         .set_items(0x00209116, {orientation})
                         .set_items(0x00289110, {measures}));
  }
  const Grid grid = read_image(image.set_items(0x52009230, frames)).volume.view.grid;
  EXPECT_EQ(grid.spacing, (Vec3{0.125, 0.25, 2.5}));
  EXPECT_EQ(grid.direction, (std::array<Vec3, 3>{Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}));
}

TEST(DicomImage, FramesAreSortedAndCheckedLikeSlices) {
  EXPECT_EQ(slice_values(read_image(enhanced_builder({9, 5, 7})).volume), (Values{100, 200, 0}));
  expect_refused(enhanced_builder({5, 7, 11, 13, 15}),
                 "not evenly spaced: 4 from frame 2 of a.dcm to frame 3 of a.dcm",
                 ErrorCode::bad_file);
  expect_refused(enhanced_builder({5, 7, 7}),
                 "two slices at one position: frame 2 of a.dcm, frame 3 of a.dcm");
}

TEST(DicomImage, AttributesOfADifferentNumberOfFramesAreRefused) {
  DicomBuilder image = enhanced();
  expect_refused(image.set(0x00280008, "IS", "2"), "has 2 frames, but attributes of 3");
}

// Sets an attribute in the frame content group of each frame.
DicomBuilder with_frame_content(const std::vector<double>& places,
                                const std::function<void(DicomBuilder&, std::size_t)>& fill) {
  DicomBuilder image = enhanced_builder(places);
  std::vector<DicomBuilder> frames;
  for (std::size_t i = 0; i < places.size(); ++i) {
    DicomBuilder position, content, frame;
    position.set_decimals(0x00200032, {-10, 20, places[i]});
    fill(content, i);
    frames.push_back(frame.set_items(0x00209113, {position}).set_items(0x00209111, {content}));
  }
  return image.set_items(0x52009230, frames);
}

FileChoice choice_of(const DicomBuilder& image) {
  try {
    read_image(image);
  } catch (const ChoiceNeeded& needed) {
    return needed.choice();
  }
  ADD_FAILURE() << "no choice was needed";
  return {};
}

TEST(DicomImage, StacksAreSeries) {
  const DicomBuilder image =
      with_frame_content({5, 7, 9, 11, 13}, [](DicomBuilder& content, std::size_t i) {
        content.set(0x00209056, "SH", i < 2 ? "A" : "B");
      });
  const FileChoice choice = choice_of(image);
  EXPECT_EQ(choice.name, "series");
  ASSERT_EQ(choice.entries.size(), 2U);
  EXPECT_NE(choice.entries[0].find("stack A, axial, CT, 2 slices"), std::string::npos)
      << choice.entries[0];
  EXPECT_EQ(slice_values(read_image(image, kExplicitLittle, {.series = "1"}).volume),
            (Values{200, 300, 400}));
}

TEST(DicomImage, AStackForEachFrameIsIgnored) {
  const DicomBuilder image =
      with_frame_content({5, 7, 9}, [](DicomBuilder& content, std::size_t i) {
        content.set(0x00209056, "SH", std::to_string(i));
      });
  EXPECT_EQ(slice_values(read_image(image).volume), (Values{0, 100, 200}));
}

TEST(DicomImage, TemporalPositionsAreTimePoints) {
  const DicomBuilder image = with_frame_content({5, 5, 7, 7, 9, 9}, [](DicomBuilder& content,
                                                                       std::size_t i) {
    content.set(0x00209128, "UL", bytes_of<std::uint32_t>({static_cast<std::uint32_t>(2 - i % 2)}));
  });
  EXPECT_EQ(choice_of(image).entries, (Names{"time point 1", "time point 2"}));
  EXPECT_EQ(slice_values(read_image(image, kExplicitLittle, {.time = 0}).volume),
            (Values{100, 300, 500}));
}

TEST(DicomImage, TheWritersOwnDimensionsDistinguishVolumes) {
  DicomBuilder image = with_frame_content({5, 5, 7, 7}, [](DicomBuilder& content, std::size_t i) {
    content.set(0x00209157, "UL",
                bytes_of<std::uint32_t>({1, static_cast<std::uint32_t>(i / 2 + 1),
                                         static_cast<std::uint32_t>(i % 2 + 1)}));
  });
  DicomBuilder stack, place, phase;
  stack.set(0x00209165, "AT", bytes_of<std::uint16_t>({0x0020, 0x9056}));
  place.set(0x00209165, "AT", bytes_of<std::uint16_t>({0x0020, 0x0032}));
  phase.set(0x00209165, "AT", bytes_of<std::uint16_t>({0x2005, 0x1011}))
      .set(0x00209421, "LO", "Image type");
  image.set_items(0x00209222, {stack, place, phase});
  EXPECT_EQ(choice_of(image).entries, (Names{"Image type 1", "Image type 2"}));
  EXPECT_EQ(slice_values(read_image(image, kExplicitLittle, {.time = 1}).volume),
            (Values{100, 300}));
}

TEST(DicomImage, PositionsInAnUltrasoundVolume) {
  DicomBuilder image = enhanced(), orientation, shared, measures;
  orientation.set(0x00209302, "FD", bytes_of<double>({1, 0, 0, 0, 1, 0}));
  measures.set_decimals(0x00280030, {0.75, 0.5});
  image.set_items(0x52009229,
                  {shared.set_items(0x0020930F, {orientation}).set_items(0x00289110, {measures})});
  std::vector<DicomBuilder> frames;
  for (const double z : {0.0, 3.0, 6.0}) {
    DicomBuilder position, frame;
    frames.push_back(
        frame.set_items(0x0020930E, {position.set(0x00209301, "FD", bytes_of<double>({0, 0, z}))}));
  }
  const VolumeFile file = read_image(image.set_items(0x52009230, frames));
  EXPECT_EQ(file.volume.view.grid.spacing.z, 3);
  EXPECT_EQ(file.source.warnings,
            (Names{"states positions in the ultrasound volume, not in the patient"}));
}

// Frames without functional groups: one position for all.
DicomBuilder plain_multi_frame() {
  DicomBuilder image = enhanced();
  image.remove(0x52009229).remove(0x52009230).set_decimals(0x00280030, {0.75, 0.5});
  return image.set_decimals(0x00200032, {1, 2, 3})
      .set_decimals(0x00200037, {1, 0, 0, 0, 0, 1});  // coronal; normal -y
}

TEST(DicomImage, FramesMayFollowEachOtherAtADistance) {
  DicomBuilder image = plain_multi_frame();
  const VolumeFile file = read_image(image.set_decimals(0x00180088, {2.5}));
  EXPECT_EQ(slice_values(file.volume), (Values{0, 100, 200}));
  EXPECT_EQ(file.volume.view.grid.spacing.z, 2.5);
  EXPECT_EQ(file.volume.view.grid.direction[2], (Vec3{0, -1, 0}));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{1, 2, 3}));
  const VolumeFile reversed = read_image(image.set_decimals(0x00180088, {-2.5}));
  EXPECT_EQ(slice_values(reversed.volume), (Values{200, 100, 0}));
  EXPECT_EQ(reversed.volume.view.grid.origin, (Vec3{1, 7, 3}));
}

TEST(DicomImage, FramesInTimeAreNotSlices) {
  DicomBuilder image = plain_multi_frame();
  image.set_decimals(0x00180088, {2.5})
      .set(0x00280009, "AT", bytes_of<std::uint16_t>({0x0018, 0x1063}));
  expect_refused(image, "3 frames that follow each other in time");
  expect_refused(plain_multi_frame(),
                 "state no positions (ImagePositionPatient) and no SpacingBetweenSlices");
}

DicomBuilder dose(const std::vector<double>& offsets) {
  DicomBuilder image = plain_multi_frame();
  image.set_decimals(0x00200037, {1, 0, 0, 0, 1, 0})
      .set(0x00280009, "AT", bytes_of<std::uint16_t>({0x3004, 0x000C}));
  return image.set(0x3004000E, "DS", "0.5").set_decimals(0x3004000C, offsets);
}

TEST(DicomImage, OffsetsOfADoseGrid) {
  const VolumeFile from_first = read_image(dose({0, 2, 4}));
  EXPECT_EQ(slice_values(from_first.volume), (Values{0, 50, 100}));
  EXPECT_EQ(from_first.volume.view.grid.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(from_first.volume.view.grid.spacing.z, 2);
  const VolumeFile downwards = read_image(dose({0, -2, -4}));
  EXPECT_EQ(slice_values(downwards.volume), (Values{100, 50, 0}));
  EXPECT_EQ(downwards.volume.view.grid.origin, (Vec3{1, 2, -1}));
  const VolumeFile coordinates = read_image(dose({3, 6, 9}));
  EXPECT_EQ(coordinates.volume.view.grid.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(coordinates.volume.view.grid.spacing.z, 3);
  expect_refused(dose({0, 2, 4.5}), "not evenly spaced", ErrorCode::bad_file);
  expect_refused(dose({0, 2}), "3 frames, but 2 offsets");
  expect_refused(dose({10, 12, 14}),
                 "GridFrameOffsetVector that starts at 10, expected 0 or its position's z, 3");
}

DicomBuilder nuclear(const std::string& type) {
  DicomBuilder image = plain_multi_frame(), detector;
  detector.set_decimals(0x00200032, {7, 8, 9}).set_decimals(0x00200037, {1, 0, 0, 0, 1, 0});
  image.set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.20")
      .set(0x00080060, "CS", "NM")
      .set(0x00080008, "CS", "ORIGINAL\\PRIMARY\\" + type);
  return image.remove(0x00200032)
      .remove(0x00200037)
      .set_decimals(0x00180088, {4})
      .set_items(0x00540022, {detector});
}

TEST(DicomImage, NuclearMedicineVolumes) {
  const VolumeFile file = read_image(nuclear("RECON TOMO\\EMISSION"));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{7, 8, 9}));
  EXPECT_EQ(file.volume.view.grid.spacing.z, 4);
  for (const std::string type : {"STATIC", "TOMO", "WHOLE BODY", "DYNAMIC"}) {
    expect_refused(nuclear(type), "nuclear medicine image of type ORIGINAL\\PRIMARY\\" + type);
  }
}

TEST(DicomImage, GatedNuclearMedicineIsAChoice) {
  DicomBuilder image = nuclear("RECON GATED TOMO");
  std::string samples;
  for (const int value : {0, 1, 2, 3})
    samples += bytes_of(frame_samples(static_cast<std::int16_t>(value)));
  image.set(0x00280008, "IS", "4").set(0x7FE00010, "OW", samples);
  image.set(0x00540080, "US", bytes_of<std::uint16_t>({1, 2, 1, 2}))
      .set(0x00540070, "US", bytes_of<std::uint16_t>({1, 1, 2, 2}));
  EXPECT_EQ(choice_of(image).entries, (Names{"time slot 1", "time slot 2"}));
  EXPECT_EQ(slice_values(read_image(image, kExplicitLittle, {.time = 1}).volume), (Values{2, 3}));
}

TEST(DicomImage, ParametricMapsHaveRealWorldValues) {
  DicomBuilder image = enhanced(), mapping;
  image.set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.30");
  mapping.set(0x00409225, "FD", bytes_of<double>({0.5}))
      .set(0x00409224, "FD", bytes_of<double>({-1}));
  expect_values(DicomBuilder(image).set_items(0x00409096, {mapping}), SampleType::float64,
                {-1, 49, 99});
  mapping.set(0x00409212, "FD", bytes_of<double>({0.5, 1}));
  expect_refused(DicomBuilder(image).set_items(0x00409096, {mapping}),
                 "by a table (RealWorldValueLUTData)");
}

TEST(DicomImage, InvalidOrientationsAreRefused) {
  const auto refuse = [](const std::vector<double>& cosines, const std::string& fragment) {
    DicomBuilder image = plain_multi_frame();
    expect_refused(image.set_decimals(0x00180088, {2}).set_decimals(0x00200037, cosines), fragment);
  };
  refuse({}, "no orientation (ImageOrientationPatient)");
  refuse({1, 0, 0, 0, 1}, "no orientation (ImageOrientationPatient)");
  refuse({1, 0, 0, 1, 0, 0}, "not perpendicular");
  refuse({1, 0, 0, 0, 0, 0}, "not perpendicular");
  refuse({1, 0, 0, 0.5, 0.866, 0}, "not perpendicular");
}

// Scanners write cosines with six digits: as doubles, the axes are neither of length 1 nor
// perpendicular.
TEST(DicomImage, RoundedOrientationsAreMadeOrthonormal) {
  DicomBuilder image = plain_multi_frame();
  image.set_decimals(0x00180088, {2})
      .set_decimals(0x00200037, {0.984808, 0.173648, 0, -0.1736, 0.9848, 0.0001});
  const std::array<Vec3, 3> axes = read_image(image).volume.view.grid.direction;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = axes[i], b = axes[k];
      EXPECT_NEAR(a.x * b.x + a.y * b.y + a.z * b.z, i == k ? 1 : 0, 1e-15);
    }
  }
  EXPECT_NEAR(axes[0].x, 0.984808, 1e-4);
}

TEST(DicomImage, PixelSpacings) {
  const auto with = [](const Edit& edit) {
    DicomBuilder image = plain_multi_frame();
    image.set_decimals(0x00180088, {2}).remove(0x00280030);
    edit(image);
    return image;
  };
  const VolumeFile at_detector = read_image(with([](DicomBuilder& d) {
    d.set_decimals(0x00181164, {0.2, 0.1});
  }));
  EXPECT_EQ(at_detector.volume.view.grid.spacing, (Vec3{0.1, 0.2, 2}));
  EXPECT_EQ(
      at_detector.source.warnings,
      (Names{"states no PixelSpacing; ImagerPixelSpacing, measured at the detector, is used"}));
  for (const std::string spacing : {"0\\1", "-1\\1", "1", "wide\\1"}) {
    expect_refused(with([&](DicomBuilder& d) { d.set(0x00280030, "DS", spacing); }),
                   "has a pixel spacing of '" + spacing + "'");
  }
}

TEST(DicomImage, ATextMayBeOfAnyCharacterSet) {
  DicomBuilder image = enhanced();
  const VolumeFile file = read_image(image.set(0x0008103E, "LO",
                                               "Sch\xE4"
                                               "del \xC3\xA4\x1B[31m"));
  EXPECT_TRUE(file.source.decisions.front().value.starts_with("series 3 Sch?del \xC3\xA4 [31m, CT"))
      << file.source.decisions.front().value;
}

TEST(DicomImage, SegmentationsAreRefused) {
  DicomBuilder image = enhanced();
  expect_refused(image.set(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4"),
                 "is a DICOM segmentation (SEG)");
}

TEST(DicomImage, SamplesMustFitInMemory) {
  const TempFolder folder;
  enhanced().write(folder / "a.dcm");
  expect_error(ErrorCode::out_of_memory, "144 bytes, more than the limit of 143", folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm", {.max_memory = 143}); });
}

}  // namespace
}  // namespace isoatlas::detail::test
