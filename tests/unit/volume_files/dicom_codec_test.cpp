// SPDX-License-Identifier: Apache-2.0
// Compressed DICOM files: tests/data/dicom has one image in every compression; invalid files are
// derived from them here.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/dicom_builder.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFiles = fs::path(ISOATLAS_DICOM_DATA);
// int16, -918 .. 2475: the samples that pydicom reads from plain.dcm.
const std::string kSamples = "341ab6f05700f7a20eae2b71b5981ba8ceee901122ca781fe46127b7e186378b";

/// A compressed file split into everything before the first fragment, the fragments, and the end of
/// the sequence.
struct Compressed {
  std::string head, tail;
  std::vector<std::string> fragments;

  explicit Compressed(const std::string& file) {
    const std::string item("\xFE\xFF\0\xE0", 4);
    std::size_t at = file.rfind(std::string("\xE0\x7F\x10\0OB\0\0\xFF\xFF\xFF\xFF", 12)) + 12;
    at += 8 + length_at(file, at);  // the offset table
    head = file.substr(0, at);
    for (; file.compare(at, 4, item) == 0; at += 8 + length_at(file, at))
      fragments.push_back(file.substr(at + 8, length_at(file, at)));
    tail = file.substr(at);
  }

  static std::uint32_t length_at(const std::string& file, std::size_t at) {
    std::uint32_t length = 0;
    std::memcpy(&length, file.data() + at + 4, sizeof length);
    return length;
  }

  std::string file() const {
    std::string all = head;
    for (std::string fragment : fragments) {
      fragment += fragment.size() % 2 == 1 ? std::string(1, '\0') : "";
      all += std::string("\xFE\xFF\0\xE0", 4) +
             bytes_of<std::uint32_t>({static_cast<std::uint32_t>(fragment.size())}) + fragment;
    }
    return all + tail;
  }
};

void expect_damaged(const std::string& bytes, const std::string& fragment) {
  const TempFolder folder;
  write_bytes(folder / "a.dcm", bytes);
  expect_error(ErrorCode::bad_file, fragment, folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm"); });
}

TEST(DicomCodec, LosslessCompressionKeepsTheSamples) {
  for (const std::string name :
       {"plain", "jpeg_lossless", "jpeg_lossless_14", "jpeg_ls", "jpeg_ls_gdcm", "rle",
        "fragments_with_offsets", "fragments_without_offsets"}) {
    const VolumeFile file = read_volume_file(kFiles / (name + ".dcm"));
    EXPECT_EQ(file.volume.view.type, SampleType::int16) << name;
    EXPECT_EQ(sample_digest(file.volume), kSamples) << name;
    const std::string reader = name == "plain" || name == "rle" ? "isoatlas"
                               : name.starts_with("jpeg_ls")    ? "CharLS "
                                                                : "DCMTK ";
    EXPECT_TRUE(file.source.reader.starts_with(reader)) << name << ": " << file.source.reader;
  }
}

// The stored bits are the upper 12 of 16, as in an uncompressed file.
TEST(DicomCodec, StoredBitsNeedNotBeTheLowest) {
  const auto read_with_high_bit_15 = [](const std::string& name) {
    std::string bytes = read_bytes(kFiles / (name + ".dcm"));
    const std::size_t high_bit = bytes.find(std::string("\x28\0\x02\x01US", 6));
    bytes[high_bit + 8] = 15;
    const TempFolder folder;
    write_bytes(folder / "a.dcm", bytes);
    return sample_digest(read_volume(folder / "a.dcm"));
  };
  const std::string expected = read_with_high_bit_15("plain");
  EXPECT_NE(expected, kSamples);
  for (const std::string name : {"jpeg_lossless", "jpeg_ls", "rle"})
    EXPECT_EQ(read_with_high_bit_15(name), expected) << name;
}

// The codestream has 16 bits per sample, so samples could be larger than the 12 bits that the
// header states.
TEST(DicomCodec, Jpeg2000StatesItsBits) {
  const Volume plain = read_volume(kFiles / "plain.dcm"),
               volume = read_volume(kFiles / "jpeg_2000_lossless.dcm");
  ASSERT_EQ(volume.view.type, SampleType::int32);
  for (std::size_t i = 0; i < plain.view.grid.sample_count(); ++i) {
    ASSERT_EQ(static_cast<const std::int32_t*>(volume.view.samples)[i],
              static_cast<const std::int16_t*>(plain.view.samples)[i])
        << i;
  }
}

TEST(DicomCodec, LossyCompressionIsReported) {
  const VolumeFile file = read_volume_file(kFiles / "jpeg_extended_lossy.dcm");
  ASSERT_EQ(file.volume.view.type, SampleType::int16);
  EXPECT_EQ(
      sample_digest(file.volume),
      "fcfef3e07127b5bf9338e413f30029e372931762a92f0bbffd98c114dc7c189e");  // as DCMTK decodes it
  EXPECT_EQ(file.source.decisions[3].key, "compression");
  EXPECT_EQ(file.source.decisions[3].value, "JPEG");
  EXPECT_EQ(file.source.decisions[4].key, "lossy");
}

TEST(DicomCodec, AFrameThatIsCutOffIsAnError) {
  for (const std::string name : {"jpeg_lossless", "jpeg_lossless_14", "jpeg_ls",
                                 "jpeg_2000_lossless", "rle", "jpeg_extended_lossy"}) {
    SCOPED_TRACE(name);
    const Compressed whole(read_bytes(kFiles / (name + ".dcm")));
    ASSERT_EQ(whole.fragments.size(), 3U);
    for (const std::size_t frame : {0U, 2U}) {
      const std::string& stream = whole.fragments[frame];
      for (const std::size_t length :
           {stream.size() / 10, stream.size() / 2, stream.size() - 30, stream.size() - 4}) {
        Compressed cut = whole;
        cut.fragments[frame] = stream.substr(0, length);
        expect_damaged(cut.file(), "a.dcm");
        if (name != "rle") {  // any bytes are valid run lengths
          cut.fragments[frame] =
              stream.substr(0, length) + std::string(stream.size() - length + 20, '\0');
          expect_damaged(cut.file(), "a.dcm");
          cut.fragments[frame] =
              stream.substr(0, length) + "\xFF\xD9";  // a complete stream without some samples
          expect_damaged(cut.file(), "a.dcm");
        }
      }
    }
  }
}

TEST(DicomCodec, FramesAndFragmentsMustMatch) {
  const Compressed whole(read_bytes(kFiles / "jpeg_ls.dcm"));
  Compressed changed = whole;
  changed.fragments.pop_back();
  expect_damaged(changed.file(), "it has 2 compressed frames of 3");
  changed.fragments.push_back(whole.fragments.front());
  changed.fragments.push_back(whole.fragments.back());
  expect_damaged(changed.file(),
                 "4 compressed fragments, which cannot be assigned to its 3 frames");
  changed = whole;
  changed.fragments[1] = "";
  expect_damaged(changed.file(), "not a JPEG-LS image");
}

TEST(DicomCodec, AnImageOfAnotherSizeIsAnError) {
  for (const std::string name : {"jpeg_lossless", "jpeg_ls", "jpeg_2000_lossless"}) {
    std::string file = read_bytes(kFiles / (name + ".dcm"));
    const std::size_t rows = file.find(std::string("\x28\0\x10\0US\x02\0", 8)) + 8;
    file[rows] = 19;
    expect_damaged(
        file, "has a compressed frame of 24 x 20 with 1 components, but states 24 x 19 with 1");
  }
}

TEST(DicomCodec, OtherCompressionsAreRefused) {
  std::string file = read_bytes(kFiles / "jpeg_ls.dcm");
  const std::size_t syntax = file.find("1.2.840.10008.1.2.4.80");
  file.replace(syntax, 22, "1.2.840.10008.1.2.4.92");  // JPEG 2000 of several components
  const TempFolder folder;
  write_bytes(folder / "a.dcm", file);
  expect_error(ErrorCode::unsupported,
               "compressed with a method that isoatlas does not decode (transfer syntax "
               "1.2.840.10008.1.2.4.92)",
               folder / "a.dcm", [&] { read_volume(folder / "a.dcm"); });
}

TEST(DicomCodec, PixelDataThatIsNotCompressedIsRefused) {
  std::string file = read_bytes(kFiles / "plain.dcm");
  const std::size_t syntax = file.find(std::string("\x02\0\x10\0UI\x14\0", 8));
  ASSERT_NE(syntax, std::string::npos);
  const std::size_t group_length = file.find(std::string("\x02\0\0\0UL\x04\0", 8)) + 8;
  file[group_length] = static_cast<char>(file[group_length] + 2);
  file.replace(syntax, 28, std::string("\x02\0\x10\0UI\x16\0", 8) + "1.2.840.10008.1.2.4.90");
  const TempFolder folder;
  write_bytes(folder / "a.dcm", file);
  EXPECT_EQ(sample_digest(read_volume(folder / "a.dcm")), kSamples);
  DicomBuilder image = enhanced_builder({1, 2});
  image.set(0x7FE00010, "OB", std::string(200, 'x'))
      .write(folder / "a.dcm", "1.2.840.10008.1.2.4.90");
  expect_error(ErrorCode::bad_file, "but its pixel data is not", folder / "a.dcm",
               [&] { read_volume(folder / "a.dcm"); });
}

}  // namespace
}  // namespace isoatlas::detail::test
