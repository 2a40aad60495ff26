// SPDX-License-Identifier: Apache-2.0
// Invalid volume files: each gives one clear line, and never a volume of zeros, a crash or a long
// wait.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <optional>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/packed_bytes.h"

namespace isoatlas::detail::test {
namespace {

// 16 x 12 x 10 samples of noise, which no compressor makes much smaller.
constexpr std::size_t kSamples = 16 * 12 * 10;

std::string noise() {
  std::string bytes;
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < kSamples; ++i) {
    state = state * 1664525 + 1013904223;
    bytes += static_cast<char>(state >> 24);
  }
  return bytes;
}

std::string as_text(const std::string& samples) {
  std::string text;
  for (const char sample : samples) {
    text += std::to_string(static_cast<unsigned char>(sample)) + " ";
  }
  return text;
}

std::string flipped(std::string bytes, std::size_t position) {
  bytes[position] = static_cast<char>(bytes[position] ^ 0x55);
  return bytes;
}

std::string cut(const std::string& bytes, std::size_t missing) {
  return bytes.substr(0, bytes.size() - missing);
}

std::string nrrd(const std::string& body, const std::string& encoding = "raw",
                 const std::string& sizes = "16 12 10", const std::string& more = "") {
  const auto dimensions = std::to_string(1 + std::count(sizes.begin(), sizes.end(), ' '));
  return "NRRD0004\ntype: uint8\ndimension: " + dimensions + "\nsizes: " + sizes +
         "\nencoding: " + encoding + "\n" + more + "\n" + body;
}

std::string meta(const std::string& body, const std::string& more = "",
                 const std::string& size = "16 12 10", const std::string& data_file = "LOCAL") {
  const auto dimensions = std::to_string(1 + std::count(size.begin(), size.end(), ' '));
  return "ObjectType = Image\nNDims = " + dimensions + "\n" +
         (more.empty() ? "BinaryData = True\n" : more) + "DimSize = " + size +
         "\nElementType = MET_UCHAR\nElementDataFile = " + data_file + "\n" + body;
}

std::string packed_meta(const std::string& body, std::size_t stated_bytes,
                        const std::string& size = "16 12 10") {
  return meta(body,
              "BinaryData = True\nCompressedData = True\nCompressedDataSize = " +
                  std::to_string(stated_bytes) + "\n",
              size);
}

struct NiftiOptions {
  std::array<std::int16_t, 8> dimensions{3, 16, 12, 10, 1, 1, 1, 1};
  std::int16_t type = 2;
  std::array<float, 8> spacing{1, 1, 1, 1, 1, 1, 1, 1};
  bool is_pair = false;
};

std::string nifti_header(const NiftiOptions& options = {}) {
  std::string header(options.is_pair ? 348 : 352, '\0');
  const auto put = [&](std::size_t offset, const auto& value) {
    std::memcpy(header.data() + offset, &value, sizeof value);
  };
  put(0, std::int32_t{348});
  put(40, options.dimensions);
  put(70, options.type);
  put(72, std::int16_t{8});
  put(76, options.spacing);
  put(108, options.is_pair ? 0.0F : 352.0F);
  std::memcpy(header.data() + 344, options.is_pair ? "ni1" : "n+1", 4);
  return header;
}

std::string vtk(const std::string& body, const std::string& format = "BINARY",
                const std::string& size = "16 12 10",
                const std::string& attributes =
                    "POINT_DATA 1920\nSCALARS s unsigned_char 1\nLOOKUP_TABLE default\n") {
  return "# vtk DataFile Version 3.0\ntitle\n" + format +
         "\nDATASET STRUCTURED_POINTS\nDIMENSIONS " + size + "\nSPACING 1 1 1\nORIGIN 0 0 0\n" +
         attributes + body;
}

struct TiffPage {
  std::uint32_t width = 16, height = 12;
  std::string samples;
};

// A little-endian TIFF, written by hand: each page's samples, followed by its directory.
std::string tiff(const std::vector<TiffPage>& pages, std::uint32_t bits = 8,
                 std::uint32_t values_per_sample = 1) {
  std::string file("II*\0\0\0\0\0", 8);
  std::size_t link = 4;
  const auto append = [&](auto value) {
    file.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const TiffPage& page : pages) {
    const auto samples_offset = static_cast<std::uint32_t>(file.size());
    file += page.samples;
    const auto directory = static_cast<std::uint32_t>(file.size());
    std::memcpy(file.data() + link, &directory, 4);
    const std::vector<std::array<std::uint32_t, 2>> entries{
        {256, page.width},
        {257, page.height},
        {258, bits},
        {259, 1},
        {262, values_per_sample == 3 ? 2U : 1U},
        {273, samples_offset},
        {277, values_per_sample},
        {278, page.height},
        {279, static_cast<std::uint32_t>(page.samples.size())}};
    append(static_cast<std::uint16_t>(entries.size()));
    for (const auto& [tag, value] : entries) {
      append(static_cast<std::uint16_t>(tag));
      append(std::uint16_t{4});
      append(std::uint32_t{1});
      append(value);
    }
    link = file.size();
    append(std::uint32_t{0});
  }
  return file;
}

std::vector<TiffPage> tiff_pages(std::size_t bytes_per_page = 192) {
  std::vector<TiffPage> pages;
  for (std::size_t z = 0; z < 10; ++z) {
    pages.push_back(
        {.samples = (noise() + noise() + noise()).substr(z * bytes_per_page, bytes_per_page)});
  }
  return pages;
}

std::string vti(const std::string& appended, const std::string& extent = "0 15 0 11 0 9",
                const std::string& array = "UInt8", const std::string& attributes = "") {
  std::string block(8, '\0');
  const std::uint64_t bytes = appended.size();
  std::memcpy(block.data(), &bytes, 8);
  return "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<ImageData WholeExtent=\"" +
         extent + "\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n<Piece Extent=\"" + extent +
         "\">\n<PointData>\n<DataArray type=\"" + array + "\" Name=\"s\" " + attributes +
         " format=\"appended\" offset=\"0\"/>\n</PointData>\n</Piece>\n</ImageData>\n" +
         "<AppendedData encoding=\"raw\">\n_" + block + appended +
         "\n</AppendedData>\n</VTKFile>\n";
}

struct BadFile {
  std::string name;
  std::string bytes;
  ErrorCode code;
  std::string message;
};

void expect_all_errors(const std::vector<BadFile>& files) {
  for (const BadFile& file : files) {
    const TempFolder folder;
    SCOPED_TRACE(file.name + ", " + file.message);
    write_bytes(folder / file.name, file.bytes);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    expect_error(file.code, file.message, folder / file.name,
                 [&] { read_volume(folder / file.name); });
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

constexpr ErrorCode kBad = ErrorCode::bad_file;
constexpr ErrorCode kUnsupported = ErrorCode::unsupported;

TEST(BadVolumes, WholeFilesAreRead) {  // otherwise the tests below would prove nothing
  const TempFolder folder;
  const std::string gz = gzipped(noise(), true), z = gzipped(noise(), false);
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.nrrd", nrrd(noise())},
      {"b.nrrd", nrrd(gz, "gzip")},
      {"c.nrrd", nrrd(as_text(noise()), "ascii")},
      {"a.mha", meta(noise())},
      {"b.mha", packed_meta(z, z.size())},
      {"c.mha", meta(as_text(noise()), "BinaryData = False\n")},
      {"a.nii", nifti_header() + noise()},
      {"a.nii.gz", gzipped(nifti_header() + noise(), true)},
      {"plain.nii.gz",
       nifti_header() + noise()},  // a wrong extension, which the NIfTI library accepts
      {"a.vtk", vtk(noise())},
      {"b.vtk", vtk(as_text(noise()), "ASCII")},
      {"a.tif", tiff(tiff_pages())},
      {"a.vti", vti(noise())}};
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    write_bytes(folder / name, bytes);
    const Volume volume = read_volume(folder / name);
    EXPECT_EQ(std::string(static_cast<const char*>(volume.view.samples), kSamples), noise());
  }
}

TEST(BadVolumes, ErrorsAboutCompressedFilesNameTheDecompressor) {
  const TempFolder folder;
  write_bytes(folder / "a.tif.gz", gzipped(tiff(tiff_pages())));
  expect_error(kUnsupported, "is a gzipped TIFF file, expected it decompressed (gunzip)",
               folder / "a.tif.gz", [&] { read_volume(folder / "a.tif.gz"); });
  expect_all_errors(
      {{"a.vtk.bz2", "BZh91AY&SY.....", kUnsupported,
        "is compressed by bzip2 (decompress it first: bunzip2)"},
       {"a.nii.xz",
        std::string("\xFD"
                    "7zXZ\0....",
                    10),
        kUnsupported, "is compressed by xz"},
       {"a.nii.zst", "\x28\xB5\x2F\xFD....", kUnsupported, "is compressed by zstandard"}});
}

TEST(BadVolumes, AnyFormat) {
  const TempFolder folder;
  expect_error(kBad, "no such file", folder / "none.nrrd",
               [&] { read_volume(folder / "none.nrrd"); });
  expect_error(kBad, "no such file", folder / "none.xyz",
               [&] { read_volume(folder / "none.xyz"); });
  for (const char* name :
       {"e.nrrd", "e.nhdr", "e.nii", "e.nii.gz", "e.mha", "e.mhd", "e.tif", "e.vtk", "e.vti"}) {
    expect_all_errors({{name, "", kBad, "is empty"}});
    expect_all_errors({{name, noise(), kBad, ""}});
    expect_all_errors({{name, "\n\n\n", kBad, ""}});
  }
  expect_all_errors({{"a.xyz", "data", kUnsupported, "expected a volume: DICOM, NRRD, NIfTI"},
                     {"noextension", "data", kUnsupported,
                      "or a folder of Zarr or of DICOM, TIFF or PNG slices"}});
}

TEST(BadVolumes, WithoutPermission) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "root may read everything";
  }
  const TempFolder folder;
  write_bytes(folder / "a.nrrd", nrrd(noise()));
  std::filesystem::permissions(folder / "a.nrrd", std::filesystem::perms::none);
  expect_error(kBad, "Permission denied", folder / "a.nrrd",
               [&] { read_volume(folder / "a.nrrd"); });
}

TEST(BadVolumes, Nrrd) {
  const std::string gz = gzipped(noise(), true);
  const std::string vector_axis = "spacings: nan 1 1 1\n";
  expect_all_errors(
      {{"raw.nrrd", nrrd(cut(noise(), 1)), kBad, "1919"},
       {"none.nrrd", nrrd(""), kBad, "the file has 0"},
       {"gzip.nrrd", nrrd(cut(gz, 100), "gzip"), kBad, "is cut off"},
       {"trailer.nrrd", nrrd(cut(gz, 8), "gzip"), kBad, "is cut off"},
       {"flip.nrrd", nrrd(flipped(gz, 900), "gzip"), kBad, "damaged"},
       {"crc.nrrd", nrrd(flipped(gz, gz.size() - 6), "gzip"), kBad, "damaged"},
       {"short.nrrd", nrrd(gzipped(cut(noise(), 9), true), "gzip"), kBad, "1911"},
       {"text.nrrd", nrrd(cut(as_text(noise()), 200), "ascii"), kBad, "states 1920 numbers"},
       {"huge.nrrd", nrrd("0123456789", "raw", "100000 100000 100000"), kBad,
        "states 1000000000000000 bytes"},
       {"hugegz.nrrd", nrrd(gz, "gzip", "10000 10000 10000"), kBad, "far more than a file of"},
       {"overflow.nrrd", nrrd(noise(), "raw", "4294967296 4294967296 4294967296"), kBad,
        "more than any file can hold"},
       {"negative.nrrd", nrrd(noise(), "raw", "-16 12 10"), kBad, "'sizes' is '-16 12 10'"},
       {"zero.nrrd", nrrd(noise(), "raw", "16 0 10"), kBad, "expected numbers of at least 1"},
       {"line.nrrd", nrrd(noise(), std::string(900, 'x')), kUnsupported,
        "the encoding 'xxxxx"},  // Teem aborts
       {"header.nrrd", "NRRD0004\ntype: uint8\n", kBad, "no field 'dimension'"},
       {"spacing.nrrd", nrrd(noise(), "raw", "16 12 10", "spacings: 1 0 1\n"), kBad, "spacing"},
       {"vector.nrrd",
        nrrd(noise() + noise() + noise(), "raw", "3 16 12 10",
             vector_axis + "kinds: vector domain domain domain\n"),
        kUnsupported, "has 3 channels, expected a choice"},
       {"complex.nrrd",
        nrrd(noise() + noise(), "raw", "2 16 12 10",
             vector_axis + "kinds: complex domain domain domain\n"),
        kUnsupported, "has 2 channels, expected a choice of one: 0 (real), 1 (imaginary)"},
       {"2d.nrrd", nrrd(noise(), "raw", "16 120"), kUnsupported, "16 x 120 x 1 samples"},
       {"flat.nrrd", nrrd(noise(), "raw", "16 120 1"), kUnsupported, "at least 2 along each axis"},
       {"4d.nrrd", nrrd(noise() + noise(), "raw", "16 12 10 2"), kUnsupported,
        "4 dimensions (16 x 12 x 10 x 2)"}});
}

TEST(BadVolumes, MetaImage) {
  const std::string z = gzipped(noise(), false);
  const std::string text = "BinaryData = False\n";
  expect_all_errors(
      {{"raw.mha", meta(cut(noise(), 1)), kBad, "states 1920 bytes of samples, the file has 1919"},
       {"none.mha", meta(""), kBad, "the file has 0"},
       {"cut.mha", packed_meta(cut(z, 100), z.size()), kBad, "is cut off"},
       {"cut2.mha", packed_meta(cut(z, 100), z.size() - 100), kBad, "is cut off"},
       {"flip.mha", packed_meta(flipped(z, 900), z.size()), kBad, "damaged"},
       {"short.mha", packed_meta(gzipped(cut(noise(), 9), false), 1911), kBad,
        "states 1920 bytes of samples, the file has 1911"},
       {"text.mha", meta(cut(as_text(noise()), 300), text), kBad, "states 1920 numbers"},
       {"huge.mha", meta(noise(), "", "100000 100000 100000"), kBad,
        "states 1000000000000000 bytes"},
       {"hugez.mha", packed_meta(z, z.size(), "10000 10000 10000"), kBad,
        "far more than a file of"},
       {"overflow.mha", meta(noise(), "", "4294967296 4294967296 4294967296"), kBad,
        "more than any file can hold"},
       {"negative.mha", meta(noise(), "", "-16 12 10"), kBad, "DimSize is '-16 12 10'"},
       {"header.mha", "ObjectType = Image\nNDims = 3\n", kBad, "no ElementDataFile"},
       {"spacing.mha", meta(noise(), "ElementSpacing = 1 0 1\n"), kBad, "spacing along y is 0"},
       {"singular.mha", meta(noise(), "TransformMatrix = 1 0 0 1 0 0 0 0 1\n"), kBad, "direction"},
       {"vector.mha", meta(noise() + noise(), "ElementNumberOfChannels = 2\n"), kUnsupported,
        "has 2 channels"},
       {"2d.mha", meta(noise(), "", "16 120"), kUnsupported, "16 x 120 x 1"},
       {"4d.mha", meta(noise() + noise(), "", "16 12 10 2"), kUnsupported, "has 2 time points"},
       {"missing.mhd", meta("", "", "16 12 10", "none.raw"), kBad, "none.raw: no such file"},
       {"list.mhd", meta("a.raw\nb.raw\n", "", "16 12 10", "LIST"), kBad,
        "names 2 data files, expected 10"},
       {"pattern.mhd", meta("", "", "16 12 10", "s%02d.raw 1 10 1"), kBad,
        "s01.raw: no such file"}});
}

TEST(BadVolumes, DetachedDataFiles) {
  const TempFolder folder;
  write_bytes(folder / "short.raw", cut(noise(), 20));
  write_bytes(folder / "whole.raw", noise());
  write_bytes(folder / "short.gz", cut(gzipped(noise(), true), 20));
  const auto expect = [&](const std::string& name, const std::string& header,
                          const std::string& message) {
    write_bytes(folder / name, header);
    expect_error(kBad, message, folder / name, [&] { read_volume(folder / name); });
  };
  expect("short.mhd", meta("", "", "16 12 10", "short.raw"), "short.raw: is cut off");
  expect("skip.mhd", meta("", "HeaderSize = 100\n", "16 12 10", "whole.raw"), "the file has 1820");
  expect("missing.nhdr", nrrd("", "raw", "16 12 10", "data file: none.raw\n"), "none.raw");
  expect("short.nhdr", nrrd("", "raw", "16 12 10", "data file: short.raw\n"), "1900");
  expect("gzip.nhdr", nrrd("", "gzip", "16 12 10", "data file: short.gz\n"),
         "short.gz: is cut off");
  expect("huge.nhdr", nrrd("", "raw", "100000 100000 100000", "data file: whole.raw\n"),
         "the file has 1920");
  expect("alone.hdr", nifti_header({.is_pair = true}), "no .img file");
  write_bytes(folder / "pair.img", cut(noise(), 5));
  expect("pair.hdr", nifti_header({.is_pair = true}), "pair.img: is cut off");
}

TEST(BadVolumes, Nifti) {
  const std::string gz = gzipped(nifti_header() + noise(), true);
  expect_all_errors(
      {{"raw.nii", nifti_header() + cut(noise(), 1), kBad,
        "states 1920 bytes of samples, the file has 1919"},
       {"gzip.nii.gz", cut(gz, 100), kBad, "is cut off"},
       {"trailer.nii.gz", cut(gz, 8), kBad, "is cut off"},
       {"short.nii.gz", gzipped(nifti_header() + cut(noise(), 9), true), kBad, "is cut off"},
       {"flip.nii.gz", flipped(gz, 1200), kBad, ""},
       {"crc.nii.gz", flipped(gz, gz.size() - 6), kBad, ""},
       {"header.nii", nifti_header().substr(0, 100), kBad, "not a NIfTI file"},
       {"huge.nii", nifti_header({.dimensions = {3, 32000, 32000, 32000, 1, 1, 1, 1}}) + noise(),
        kBad, "states 32768000000000"},
       {"huge.nii.gz",
        gzipped(nifti_header({.dimensions = {3, 32000, 32000, 32000, 1, 1, 1, 1}}), true), kBad,
        "far more"},
       {"negative.nii", nifti_header({.dimensions = {3, -16, 12, 10, 1, 1, 1, 1}}) + noise(), kBad,
        "-16 samples along axis 1"},
       {"dimensions.nii", nifti_header({.dimensions = {9, 16, 12, 10, 1, 1, 1, 1}}) + noise(), kBad,
        ""},
       {"spacing.nii", nifti_header({.spacing = {1, 1, 0, 1, 1, 1, 1, 1}}) + noise(), kBad,
        "spacing along axis 2 is 0"},
       {"rgb.nii", nifti_header({.type = 128}) + noise() + noise() + noise(), kUnsupported,
        "RGB24"},
       {"bit.nii", nifti_header({.type = 1}) + noise(), kUnsupported, "BINARY"},
       {"unknown.nii", nifti_header({.type = 77}) + noise(), kUnsupported, "type 77"},
       {"4d.nii", nifti_header({.dimensions = {4, 16, 12, 5, 2, 1, 1, 1}}) + noise(), kUnsupported,
        "2 time points"},
       {"vector.nii", nifti_header({.dimensions = {5, 16, 12, 5, 1, 2, 1, 1}}) + noise(),
        kUnsupported, ""},
       {"2d.nii", nifti_header({.dimensions = {2, 16, 120, 1, 1, 1, 1, 1}}) + noise(), kUnsupported,
        "16 x 120 x 1"}});
}

TEST(BadVolumes, LegacyVtk) {
  expect_all_errors(
      {{"raw.vtk", vtk(cut(noise(), 1)), kBad, "states 1920 bytes of samples, the file has 1919"},
       {"none.vtk", vtk(""), kBad, "the file has 0"},
       {"text.vtk", vtk(cut(as_text(noise()), 300), "ASCII"), kBad, "states 1920 numbers"},
       {"huge.vtk", vtk(noise(), "BINARY", "100000 100000 100000"), kBad,
        "require 1000000000000000"},
       {"overflow.vtk", vtk(noise(), "BINARY", "4294967296 4294967296 4294967296"), kBad,
        "more than any file can hold"},
       {"negative.vtk", vtk(noise(), "BINARY", "-16 12 10"), kBad, ""},
       {"zero.vtk", vtk(noise(), "BINARY", "16 0 10"), kBad, "16 x 0 x 10"},
       {"flat.vtk", vtk(noise(), "BINARY", "16 120 1"), kUnsupported, "16 x 120 x 1"},
       {"cells.vtk",
        vtk(noise(), "BINARY", "16 12 10",
            "CELL_DATA 1920\nSCALARS s unsigned_char 1\nLOOKUP_TABLE default\n"),
        kBad, "CELL_DATA states 1920 values"},
       {"colour.vtk",
        vtk(noise() + noise() + noise(), "BINARY", "16 12 10",
            "POINT_DATA 1920\nCOLOR_SCALARS s 3\n"),
        kUnsupported, "3 channels"},
       {"two.vtk",
        vtk(noise() + noise(), "BINARY", "16 12 10",
            "POINT_DATA 1920\nSCALARS s unsigned_char 2\nLOOKUP_TABLE default\n"),
        kUnsupported, "2 channels"},
       {"poly.vtk",
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\n",
        kUnsupported, "is a mesh file"}});
}

TEST(BadVolumes, Tiff) {
  const std::string whole = tiff(tiff_pages());
  // Cut at any place, also where the file ends after a directory and only the link to the next page
  // is missing.
  for (const std::size_t missing : {314U, 313U, 312U, 311U}) {
    expect_all_errors({{"link.tif", cut(whole, missing), kBad, "cut off or damaged"}});
  }
  for (std::size_t missing = 1; missing < whole.size(); missing += missing < 10 ? 1 : 53) {
    expect_all_errors({{"cut" + std::to_string(missing) + ".tif", cut(whole, missing), kBad, ""}});
  }
  std::vector<TiffPage> mixed = tiff_pages();
  mixed[5].width = 8;
  expect_all_errors(
      {{"mixed.tif", tiff(mixed), kUnsupported, "page 6 has 8 x 12 samples"},
       {"single.tif", tiff({tiff_pages()[0]}), kUnsupported, "16 x 12 x 1"},
       {"colour.tif", tiff(tiff_pages(3 * 192), 8, 3), kUnsupported,
        "has 3 channels, expected a choice of one: 0 (red), 1 (green), 2 (blue)"},
       {"bits.tif", tiff(tiff_pages(24), 24), kUnsupported, "unsigned integer samples of 24 bits"},
       {"huge.tif",
        tiff({{.width = 100000, .height = 100000, .samples = "x"},
              {.width = 100000, .height = 100000, .samples = "x"}}),
        kBad, "far more than a file of"}});
}

TEST(BadVolumes, Vti) {
  const std::string whole = vti(noise());
  expect_all_errors(
      {{"cut.vti", cut(whole, 500), kBad, "does not end with </VTKFile>"},
       {"cut2.vti", cut(whole, 10), kBad, "does not end with </VTKFile>"},
       {"header.vti", whole.substr(0, 150), kBad, ""},
       {"huge.vti", vti(noise(), "0 99999 0 99999 0 99999"), kBad, "far more than a file of"},
       {"more.vti", vti(noise(), "0 999 0 99 0 9"), kBad, ""},
       {"inverse.vti", vti(noise(), "15 0 0 11 0 9"), kUnsupported, "0 x 12 x 10"},
       {"flat.vti", vti(noise(), "0 15 0 119 0 0"), kUnsupported, "16 x 120 x 1"},
       {"vector.vti", vti(noise() + noise(), "0 15 0 11 0 9", "UInt8", "NumberOfComponents=\"2\""),
        kUnsupported, "2 channels"},
       {"bit.vti", vti(noise(), "0 15 0 11 0 9", "Bit"), kBad,
        "has 1920 bytes of values, expected 240"},
       {"string.vti", vti(noise(), "0 15 0 11 0 9", "String"), kUnsupported, "no array of numbers"},
       {"unknown.vti", vti(noise(), "0 15 0 11 0 9", "Foo"), kBad, "unknown data type 'Foo'"}});
  std::string no_blocks = whole;  // VTK 9.1 divides by the block size
  no_blocks.insert(no_blocks.find(" header_type"), " compressor=\"vtkZLibDataCompressor\"");
  no_blocks.replace(no_blocks.find("\n_") + 2, 16,
                    std::string("\1\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 16));
  std::string many_blocks = no_blocks;
  many_blocks.replace(many_blocks.find("\n_") + 2, 16, std::string(16, '\x7f'));
  expect_all_errors({{"zero.vti", no_blocks, kBad, "1 blocks of 0 bytes"},
                     {"many.vti", many_blocks, kBad, "is damaged"}});
  std::string two = whole;
  const std::string array =
      "<DataArray type=\"UInt8\" Name=\"t\" format=\"appended\" offset=\"0\"/>\n";
  two.insert(two.find("</PointData>"), array);
  expect_all_errors({{"two.vti", two, kUnsupported,
                      "has 2 arrays, expected a choice of one: 0 (s: uint8), 1 (t: uint8)"}});
}

TEST(BadVolumes, Raw) {
  const TempFolder folder;
  const auto path = folder / "samples.raw";
  write_bytes(path, noise());
  RawLayout layout{.size = {16, 12, 11}};
  expect_error(kBad, "has 1920 bytes, but 16 x 12 x 11 samples of uint8 are 2112 bytes", path,
               [&] { read_volume(path, {.raw = layout}); });
  layout.size = {std::size_t{1} << 40, std::size_t{1} << 40, 4};
  expect_error(kBad, "more than any file can hold", path,
               [&] { read_volume(path, {.raw = layout}); });
  layout.size = {16, 120, 1};
  expect_error(kUnsupported, "at least 2 along each axis", path,
               [&] { read_volume(path, {.raw = layout}); });
  layout = {.size = {16, 12, 10}, .spacing = {1, 0, 1}};
  expect_error(ErrorCode::bad_argument, "spacing", path,
               [&] { read_volume(path, {.raw = layout}); });
  layout = {.size = {16, 12, 10}};
  expect_error(kBad, "no such file", folder / "none.raw",
               [&] { read_volume(folder / "none.raw", {.raw = layout}); });
  expect_error(kBad, "is a folder", folder.path(),
               [&] { read_volume(folder.path(), {.raw = layout}); });
}

}  // namespace
}  // namespace isoatlas::detail::test
