// SPDX-License-Identifier: Apache-2.0
// Folders of TIFF or PNG images, each of which is a slice.
#include <gtest/gtest.h>
#include <png.h>

#include <cstdio>
#include <cstring>

#include "isoatlas/volume_file.h"
#include "support/field_volumes.h"
#include "support/file_test_support.h"
#include "tiff_writer.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kNone;
const std::string kNoSpacing = "states no voxel size; 1 x 1 x 1 is assumed";

std::string slice(int number, const std::string& description = "", std::uint32_t width = 4) {
  return TiffWriter()
      .add({.width = width,
            .samples = std::string(width * 3, static_cast<char>(number)),
            .description = description})
      .bytes();
}

struct PngImage {
  std::uint32_t width = 4, height = 3;
  int bits = 8;
  int colours = PNG_COLOR_TYPE_GRAY;
  std::vector<std::string> rows = {};  // packed; 16 bits with the high byte first
  bool is_interlaced = false;
  bool has_display_chunks = false;  // gamma, a transparent colour and a physical size
};

void write_png(const fs::path& path, PngImage image) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, image.width, image.height, image.bits, image.colours,
               image.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const std::vector<png_color> palette(std::size_t{1} << std::min(image.bits, 8),
                                       png_color{9, 9, 9});
  if (image.colours == PNG_COLOR_TYPE_PALETTE)
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  if (image.has_display_chunks) {
    png_set_gAMA(png, info, 0.45455);
    png_set_pHYs(png, info, 100, 200, PNG_RESOLUTION_METER);
    png_color_16 transparent{};
    transparent.gray = 1;
    png_set_tRNS(png, info, nullptr, 0, &transparent);
  }
  png_write_info(png, info);
  std::vector<png_bytep> rows;
  for (std::string& row : image.rows) rows.push_back(reinterpret_cast<png_bytep>(row.data()));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

class ImageStack : public testing::Test {
 protected:
  void add(const std::string& name, int number) { write_bytes(folder_ / name, slice(number)); }
  VolumeFile read(const ReadOptions& options = {}) {
    return read_volume_file(folder_.path(), options);
  }
  void refuse(ErrorCode code, const std::string& message, const fs::path& named,
              const ReadOptions& options = {}) {
    expect_error(code, message, named, [&] { read_volume_file(folder_.path(), options); });
  }
  void refuse(ErrorCode code, const std::string& message) { refuse(code, message, folder_.path()); }
  std::vector<int> slices() {
    const VolumeFile file = read();
    std::vector<int> values;
    for (std::size_t z = 0; z < file.volume.view.grid.size[2]; ++z)
      values.push_back(static_cast<int>(sample_as_double(file.volume, z * 12)));
    return values;
  }
  TempFolder folder_;
};

TEST(ImageStackField, FolderOfTiffSlices) {
  const VolumeFile file = read_volume_file(field_file("tifslices"));
  expect_size_and_spacing(file.volume, {24, 20, 16}, {1, 1, 1});
  EXPECT_EQ(sample_digest(file.volume),
            "a78a42af8528cf3edb01d11a1d936d0d1399c6755e7281beffae27d955831b1d");
  EXPECT_EQ(file.source.format, "TIFF slices");
  EXPECT_EQ(file.source.warnings, std::vector<std::string>{kNoSpacing});
  EXPECT_FALSE(file.source.has_spacing);
  const VolumeFile spaced =
      read_volume_file(field_file("tifslices"), {.spacing = Vec3{0.5, 0.5, 2}});
  EXPECT_EQ(spaced.volume.view.grid.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(spaced.source.warnings, kNone);
}

TEST_F(ImageStack, SlicesAreSortedByNumberNotByName) {
  for (const int number : {10, 8, 9, 11, 12}) add("s" + std::to_string(number) + "b.tif", number);
  EXPECT_EQ(slices(), (std::vector{8, 9, 10, 11, 12}));
  // Other files in the folder.
  write_bytes(folder_ / "._s8b.tif", "resource fork");
  write_bytes(folder_ / ".DS_Store", "x");
  write_bytes(folder_ / "Thumbs.db", "x");
  write_bytes(folder_ / "settings.txt", "voxel 0.2");
  EXPECT_EQ(slices(), (std::vector{8, 9, 10, 11, 12}));
}

TEST_F(ImageStack, NumbersOfAnyWidthAndStep) {
  for (const int number : {0, 50, 100, 150})
    add("z_" + std::to_string(number) + (number == 50 ? ".TIF" : ".tiff"), number);
  EXPECT_EQ(slices(), (std::vector{0, 50, 100, 150}));
}

TEST_F(ImageStack, ADateThatIsInAllNames) {
  for (const int number : {1, 2, 3}) {
    add("scan2024_" + std::to_string(1000 + 17 * number) + "_99999999999999999999999" +
            std::to_string(number) + ".tif",
        number);
  }
  EXPECT_EQ(slices(), (std::vector{1, 2, 3}));
}

TEST_F(ImageStack, MissingSlice) {
  for (const int number : {1, 2, 4, 5}) add("s" + std::to_string(number) + ".tif", number);
  refuse(ErrorCode::bad_file, "slices are missing between 's2.tif' and 's4.tif'");
}

TEST_F(ImageStack, MissingSliceAmongLongNumbers) {
  for (const int number : {1, 2, 9})
    add("s2023110512305900000000" + std::to_string(number) + ".tif", number);
  refuse(ErrorCode::bad_file,
         "slices are missing between 's20231105123059000000002.tif' and "
         "'s20231105123059000000009.tif'");
}

TEST_F(ImageStack, ANumberTwice) {
  add("s1.tif", 1);
  add("s2.tif", 2);
  add("s02.tif", 2);
  refuse(ErrorCode::bad_file, "have the same number");
}

TEST_F(ImageStack, ChannelsAmongSlices) {
  for (const int channel : {0, 1}) {
    for (const int z : {0, 1, 2})
      add("c" + std::to_string(channel) + "_z" + std::to_string(z) + ".tif", z);
  }
  refuse(ErrorCode::unsupported, "its images differ in 2 numbers of their names");
}

TEST_F(ImageStack, NamesThatAreNotAlike) {
  for (const int z : {0, 1, 2}) {
    add("DAPI_" + std::to_string(z) + ".tif", z);
    add("GFP_" + std::to_string(z) + ".tif", z);
  }
  refuse(ErrorCode::unsupported, "its images 'DAPI_0.tif' and 'GFP_0.tif' are not named alike");
}

TEST_F(ImageStack, TiffAndPngTogether) {
  add("s1.tif", 1);
  write_png(folder_ / "s2.png", {.rows = {"aaaa", "bbbb", "cccc"}});
  refuse(ErrorCode::unsupported, "are not named alike");
}

TEST_F(ImageStack, OneImageIsRefused) {
  add("s1.tif", 1);
  refuse(ErrorCode::unsupported, "is a folder with one image, 's1.tif'");
}

TEST_F(ImageStack, SlicesThatDiffer) {
  add("s1.tif", 1);
  write_bytes(folder_ / "s2.tif", slice(2, "", 5));
  refuse(ErrorCode::unsupported, "has 5 x 3 samples of uint8, s1.tif has 4 x 3 samples of uint8",
         folder_ / "s2.tif");
  write_bytes(folder_ / "s2.tif",
              TiffWriter().add({.samples = std::string(24, 'a'), .bits = 16}).bytes());
  refuse(ErrorCode::unsupported, "has 4 x 3 samples of uint16, s1.tif has 4 x 3 samples of uint8",
         folder_ / "s2.tif");
  write_bytes(folder_ / "s2.tif", TiffWriter()
                                      .add({.samples = std::string(12, 'a')})
                                      .add({.samples = std::string(12, 'a')})
                                      .bytes());
  refuse(ErrorCode::unsupported, "has 2 pages, expected one slice in each file",
         folder_ / "s2.tif");
  write_bytes(folder_ / "s2.tif", slice(2).substr(0, 100));
  refuse(ErrorCode::bad_file, "", folder_ / "s2.tif");
  write_bytes(folder_ / "s2.tif", "this is text");
  refuse(ErrorCode::bad_file, "is not a TIFF file", folder_ / "s2.tif");
  write_bytes(folder_ / "s2.tif", "");
  refuse(ErrorCode::bad_file, "is empty", folder_ / "s2.tif");
}

TEST_F(ImageStack, ImageJsLengths) {
  // An image sequence saved by ImageJ states lengths along x and y.
  TiffPage page{.samples = std::string(12, 'a'),
                .description = "ImageJ=1.53t\nunit=um\n",
                .more = {{282, 5, {4, 1}}, {283, 5, {4, 1}}, {296, 3, {1}}}};
  for (const char* name : {"s1.tif", "s2.tif"})
    write_bytes(folder_ / name, TiffWriter().add(page).bytes());
  const VolumeFile file = read();
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.25, 0.25, 1}));
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::micrometre);
  EXPECT_EQ(file.source.warnings,
            std::vector<std::string>{"states no voxel size along z; 1 um is assumed there"});
}

TEST_F(ImageStack, ImageJsSignedSamples) {
  TiffPage page{.description = "ImageJ=1.53t\ncf=0\nc0=-32768\nc1=1\nvunit=Gray Value\n",
                .bits = 16};
  for (int i = 0; i < 12; ++i) page.samples += std::string("\x01\x80", 2);
  for (const char* name : {"s1.tif", "s2.tif"})
    write_bytes(folder_ / name, TiffWriter().add(page).bytes());
  const VolumeFile file = read();
  EXPECT_EQ(file.volume.view.type, SampleType::int16);
  EXPECT_EQ(sample_as_double(file.volume, 0), 1);
  page.description = "ImageJ=1.53t\ncf=0\nc0=-32767\nc1=1\nvunit=Gray Value\n";
  write_bytes(folder_ / "s2.tif", TiffWriter().add(page).bytes());
  refuse(ErrorCode::unsupported, "has another calibration function than s1.tif",
         folder_ / "s2.tif");
}

TEST_F(ImageStack, ImagesAfterAPageAreDetected) {
  add("s1.tif", 1);
  TiffPage page{.samples = std::string(24, 'a'),
                .description = "ImageJ=1.53t\nimages=2\nslices=2\n",
                .strip_bytes = 12};
  write_bytes(folder_ / "s2.tif", TiffWriter().add(page).bytes());
  refuse(ErrorCode::unsupported, "has 2 images after one page", folder_ / "s2.tif");
}

TEST_F(ImageStack, RedGreenBlue) {
  for (const char* name : {"s1.tif", "s2.tif"}) {
    TiffPage page{.values = 3, .photometric = 2};
    for (int i = 0; i < 12; ++i) page.samples += "rgb";
    write_bytes(folder_ / name, TiffWriter().add(page).bytes());
  }
  refuse(ErrorCode::unsupported,
         "has 3 channels, expected a choice of one: 0 (red), 1 (green), 2 (blue)");
  EXPECT_EQ(sample_as_double(read({.channel = "1"}).volume, 13), 'g');
}

TEST_F(ImageStack, MemoryLimit) {
  add("s1.tif", 1);
  add("s2.tif", 2);
  refuse(ErrorCode::out_of_memory, "more than the limit of 20", folder_.path(), {.max_memory = 20});
}

// ---------------------------------------------------------------- PNG

TEST_F(ImageStack, PngChunksAboutDisplayChangeNothing) {
  for (const char* name : {"s1.png", "s2.png"})
    write_png(folder_ / name,
              {.rows = {"\x01\xFF\x7F\x80", "aaaa", "bbbb"}, .has_display_chunks = true});
  const VolumeFile file = read();
  EXPECT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{4, 3, 2}));
  for (const auto& [i, value] : {std::pair{0, 1}, {1, 255}, {2, 127}, {3, 128}})
    EXPECT_EQ(sample_as_double(file.volume, static_cast<std::size_t>(i)), value);
  EXPECT_FALSE(file.source.has_spacing);
}

TEST_F(ImageStack, PngOfAnyDepth) {
  struct Depth {
    int bits;
    std::vector<std::string> rows;
    std::vector<double> values;  // samples of the first row
    SampleType type;
  };
  const std::vector<Depth> depths{
      {1, {"\xA0", "\x50", "\xF0"}, {1, 0, 1, 0}, SampleType::uint8},
      {2, {"\x1B", "\x1B", "\xFF"}, {0, 1, 2, 3}, SampleType::uint8},
      {4, {"\x1F\x28", "\x11\x11", "\x22\x22"}, {1, 15, 2, 8}, SampleType::uint8},
      {8, {"\x01\xFF\x7F\x80", "aaaa", "bbbb"}, {1, 255, 127, 128}, SampleType::uint8},
      {16,
       {std::string("\x00\x01\xFF\xFE\x12\x34\x80\x00", 8), "aaaaaaaa", "bbbbbbbb"},
       {1, 0xFFFE, 0x1234, 0x8000},
       SampleType::uint16}};
  for (const Depth& depth : depths) {
    for (const bool is_interlaced : {false, true}) {
      for (const int colours : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_PALETTE}) {
        if (colours == PNG_COLOR_TYPE_PALETTE && depth.bits == 16) continue;
        SCOPED_TRACE(depth.bits);
        for (const char* name : {"s1.png", "s2.png"}) {
          write_png(folder_ / name, {.bits = depth.bits,
                                     .colours = colours,
                                     .rows = depth.rows,
                                     .is_interlaced = is_interlaced});
        }
        const VolumeFile file = read();
        EXPECT_EQ(file.volume.view.type, depth.type);
        ASSERT_EQ(file.volume.view.grid.size, (std::array<std::size_t, 3>{4, 3, 2}));
        for (std::size_t i = 0; i < 4; ++i) {
          EXPECT_EQ(sample_as_double(file.volume, i), depth.values[i]);
          EXPECT_EQ(sample_as_double(file.volume, 12 + i), depth.values[i]);
        }
      }
    }
  }
}

TEST_F(ImageStack, PngChannelsAndAlpha) {
  const auto write_both = [&](int colours, const std::string& row) {
    for (const char* name : {"s1.png", "s2.png"})
      write_png(folder_ / name, {.colours = colours, .rows = {row, row, row}});
  };
  write_both(PNG_COLOR_TYPE_RGB, "rgbrgbrgbrgb");
  refuse(ErrorCode::unsupported, "0 (red), 1 (green), 2 (blue)");
  EXPECT_EQ(sample_as_double(read({.channel = "2"}).volume, 23), 'b');
  write_both(PNG_COLOR_TYPE_RGB_ALPHA, "rgb\xFFrgb\xFFrgb\xFFrgb\xFF");
  EXPECT_EQ(sample_as_double(read({.channel = "1"}).volume, 23), 'g');
  write_both(PNG_COLOR_TYPE_GRAY_ALPHA,
             "a\xFF"
             "b\xFF"
             "c\xFF"
             "d\xFF");
  EXPECT_EQ(sample_as_double(read().volume, 2), 'c');
  write_both(PNG_COLOR_TYPE_GRAY_ALPHA,
             "a\xFF"
             "b\xFE"
             "c\xFF"
             "d\xFF");
  refuse(ErrorCode::unsupported, "has transparent samples (an alpha channel)", folder_ / "s1.png");
}

TEST_F(ImageStack, PngSlicesThatDiffer) {
  write_png(folder_ / "s1.png", {.rows = {"aaaa", "bbbb", "cccc"}});
  write_png(folder_ / "s2.png", {.width = 3, .rows = {"aaa", "bbb", "ccc"}});
  refuse(ErrorCode::unsupported, "has 3 x 3 samples of 8-bit grey values, s1.png has 4 x 3",
         folder_ / "s2.png");
  write_png(folder_ / "s2.png", {.bits = 16, .rows = {"aaaaaaaa", "bbbbbbbb", "cccccccc"}});
  refuse(ErrorCode::unsupported, "16-bit grey values", folder_ / "s2.png");
}

TEST_F(ImageStack, PngCutAnywhere) {
  write_png(folder_ / "s1.png", {.rows = {"abcd", "efgh", "ijkl"}});
  write_png(folder_ / "s2.png", {.rows = {"abcd", "efgh", "ijkl"}});
  const std::string whole = read_bytes(folder_ / "s2.png");
  EXPECT_EQ(read().volume.view.grid.size[2], 2U);
  for (std::size_t bytes = 1; bytes < whole.size(); ++bytes) {
    write_bytes(folder_ / "s2.png", whole.substr(0, bytes));
    refuse(ErrorCode::bad_file, "is cut off or damaged", folder_ / "s2.png");
  }
  for (std::size_t at = 41; at + 16 < whole.size();
       ++at) {  // the compressed rows and their checksum
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    write_bytes(folder_ / "s2.png", damaged);
    refuse(ErrorCode::bad_file, "is cut off or damaged", folder_ / "s2.png");
  }
}

TEST_F(ImageStack, PngThatStatesTooLargeSizes) {
  write_png(folder_ / "s1.png", {.rows = {"abcd", "efgh", "ijkl"}});
  write_png(folder_ / "s2.png", {.rows = {"abcd", "efgh", "ijkl"}});
  for (const char* name : {"s1.png", "s2.png"}) {
    std::string bytes = read_bytes(folder_ / name);
    bytes.replace(16, 8, std::string("\x7F\xFF\xFF\xFF\x7F\xFF\xFF\xFF", 8));
    write_bytes(folder_ / name, bytes);
  }
  expect_error(ErrorCode::bad_file, "", folder_.path(), [&] { read(); });
}

TEST_F(ImageStack, OneImageByItself) {
  write_png(folder_ / "s1.png", {.rows = {"aaaa", "bbbb", "cccc"}});
  expect_error(ErrorCode::unsupported, "is a 2-D PNG image (give the folder with all slices)",
               folder_ / "s1.png", [&] { read_volume_file(folder_ / "s1.png"); });
  add("t1.tif", 1);
  expect_error(
      ErrorCode::unsupported,
      "a 2-D image; expected a volume: a stack of slices, or the folder that holds all slices",
      folder_ / "t1.tif", [&] { read_volume_file(folder_ / "t1.tif"); });
}

// A preview image next to a DICOM series does not make its folder a folder of images.
TEST_F(ImageStack, DicomPrecedesImages) {
  write_png(folder_ / "preview1.png", {.rows = {"aaaa", "bbbb", "cccc"}});
  write_png(folder_ / "preview2.png", {.rows = {"aaaa", "bbbb", "cccc"}});
  EXPECT_EQ(read().source.format, "PNG slices");
  fs::copy_file(field_file("one.dcm"), folder_ / "IM0001");
  try {
    EXPECT_NE(read().source.format, "PNG slices");
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("PNG"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace isoatlas::detail::test
