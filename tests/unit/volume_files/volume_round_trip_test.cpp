// SPDX-License-Identifier: Apache-2.0
// Every volume format with every sample type that it can hold: written by another library, read by
// isoatlas.
#include <gtest/gtest.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkVTKImageIO.h>
#include <tiffio.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataWriter.h>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "unit/volume_files/volume_files.h"

namespace isoatlas::detail::test {
namespace {

enum class Geometry { none, spacing_only, no_direction, full };

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_same(const Volume& read, const TestVolume& written, Geometry geometry,
                 double tolerance = 1e-12) {
  ASSERT_EQ(read.view.grid.size, written.grid.size);
  ASSERT_EQ(read.view.type, written.type) << name(read.view.type);
  ASSERT_NE(read.owner, nullptr);
  EXPECT_EQ(std::string(static_cast<const char*>(read.view.samples), written.bytes.size()),
            written.bytes)
      << name(read.view.type);
  const Grid unit;
  expect_near(read.view.grid.spacing,
              geometry >= Geometry::spacing_only ? written.grid.spacing : unit.spacing, tolerance);
  expect_near(read.view.grid.origin,
              geometry >= Geometry::no_direction ? written.grid.origin : unit.origin,
              100 * tolerance);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    expect_near(read.view.grid.direction[axis],
                geometry == Geometry::full ? written.grid.direction[axis] : unit.direction[axis],
                tolerance);
  }
}

class EveryType : public testing::TestWithParam<SampleType> {
 protected:
  TempFolder folder_;
  TestVolume written_{GetParam()};

  void check(itk::ImageIOBase& image_io, const std::string& file_name, Geometry geometry,
             double tolerance, bool compress = false) {
    const auto path = folder_ / file_name;
    write_with(image_io, path, written_.grid, written_.type, written_.bytes, compress);
    SCOPED_TRACE(file_name);
    expect_same(read_volume(path), written_, geometry, tolerance);
  }
};

INSTANTIATE_TEST_SUITE_P(Types, EveryType, testing::ValuesIn(kAllTypes),
                         [](const auto& test) { return std::string(name(test.param)); });

TEST_P(EveryType, Nrrd) {
  check(*itk::NrrdImageIO::New(), "plain.nrrd", Geometry::full, 1e-12);
  check(*itk::NrrdImageIO::New(), "packed.NRRD", Geometry::full, 1e-12, true);
  check(*itk::NrrdImageIO::New(), "detached.nhdr", Geometry::full, 1e-12);
}

// Written by isoatlas, read by isoatlas and by ITK.
TEST_P(EveryType, WrittenNrrd) {
  VolumeView view;
  view.grid = written_.grid;
  view.type = written_.type;
  view.samples = written_.bytes.data();
  const auto path = folder_ / "written.nrrd";
  write_nrrd(view, path);
  expect_same(read_volume(path), written_, Geometry::full);
  const auto itk = itk::NrrdImageIO::New();
  itk->SetFileName(path.string());
  itk->ReadImageInformation();
  EXPECT_EQ(itk->GetComponentSize(), bytes_per_sample(written_.type));
  std::string bytes(written_.bytes.size(), 0);
  itk->Read(bytes.data());
  EXPECT_EQ(bytes, written_.bytes);
  const Grid& grid = written_.grid;
  expect_near({itk->GetSpacing(0), itk->GetSpacing(1), itk->GetSpacing(2)}, grid.spacing, 1e-12);
  expect_near({itk->GetOrigin(0), itk->GetOrigin(1), itk->GetOrigin(2)}, grid.origin, 1e-12);
  for (unsigned axis = 0; axis < 3; ++axis) {
    const std::vector<double> d = itk->GetDirection(axis);
    expect_near({d[0], d[1], d[2]}, grid.direction[axis], 1e-12);
  }
}

TEST_P(EveryType, MetaImage) {
  check(*itk::MetaImageIO::New(), "plain.mha", Geometry::full, 1e-9);
  check(*itk::MetaImageIO::New(), "packed.mha", Geometry::full, 1e-9, true);
  check(*itk::MetaImageIO::New(), "detached.mhd", Geometry::full, 1e-9);
  check(*itk::MetaImageIO::New(), "detached_packed.mhd", Geometry::full, 1e-9, true);
}

TEST_P(EveryType, Nifti) {  // its header holds floats
  check(*itk::NiftiImageIO::New(), "plain.nii", Geometry::full, 1e-6);
  check(*itk::NiftiImageIO::New(), "packed.nii.gz", Geometry::full, 1e-6);
  check(*itk::NiftiImageIO::New(), "pair.hdr", Geometry::full, 1e-6);
  expect_same(read_volume(folder_ / "pair.img"), written_, Geometry::full, 1e-6);
}

TEST_P(EveryType, LegacyVtk) {
  const auto binary = itk::VTKImageIO::New();
  binary->SetFileTypeToBinary();
  check(*binary, "binary.vtk", Geometry::no_direction, 1e-9);
  if (GetParam() == SampleType::float32 || GetParam() == SampleType::float64) {
    return;  // ITK writes six digits as text
  }
  const auto ascii = itk::VTKImageIO::New();
  ascii->SetFileTypeToASCII();
  check(*ascii, "ascii.vtk", Geometry::no_direction, 1e-9);
}

TEST_P(EveryType, Tiff) {
  for (const bool tiled : {false, true}) {
    for (const char* mode : {"wl", "wb", "w8"}) {  // little endian, big endian, BigTIFF
      const auto path = folder_ / "stack.tif";
      TIFF* tiff = TIFFOpen(path.c_str(), mode);
      const std::size_t sample_bytes = bytes_per_sample(written_.type);
      const std::size_t row_bytes = written_.grid.size[0] * sample_bytes;
      for (std::size_t z = 0; z < written_.grid.size[2]; ++z) {
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 5);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 4);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sample_bytes));
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
        const bool is_float =
            written_.type == SampleType::float32 || written_.type == SampleType::float64;
        const bool is_signed = name(written_.type).starts_with("int");
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT,
                     is_float    ? SAMPLEFORMAT_IEEEFP
                     : is_signed ? SAMPLEFORMAT_INT
                                 : SAMPLEFORMAT_UINT);
        std::string rows = written_.bytes.substr(z * 4 * row_bytes, 4 * row_bytes);
        if (tiled) {
          TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
          TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
          std::string tile(256 * sample_bytes, '\0');
          for (std::size_t y = 0; y < 4; ++y) {
            tile.replace(y * 16 * sample_bytes, row_bytes, rows, y * row_bytes, row_bytes);
          }
          TIFFWriteEncodedTile(tiff, 0, tile.data(), static_cast<tmsize_t>(tile.size()));
        } else {
          TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);  // two strips, the last one shorter
          TIFFWriteEncodedStrip(tiff, 0, rows.data(), static_cast<tmsize_t>(3 * row_bytes));
          TIFFWriteEncodedStrip(tiff, 1, rows.data() + 3 * row_bytes,
                                static_cast<tmsize_t>(row_bytes));
        }
        TIFFWriteDirectory(tiff);
      }
      TIFFClose(tiff);
      SCOPED_TRACE(std::string(mode) + (tiled ? " tiled" : " strips"));
      expect_same(read_volume(path), written_, Geometry::none);
    }
  }
}

TEST_P(EveryType, Vti) {
  constexpr std::array kVtkTypes{
      VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT,     VTK_UNSIGNED_SHORT,
      VTK_INT,         VTK_UNSIGNED_INT,  VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
      VTK_FLOAT,       VTK_DOUBLE};
  const auto samples = vtkSmartPointer<vtkDataArray>::Take(
      vtkDataArray::CreateDataArray(kVtkTypes[static_cast<std::size_t>(written_.type)]));
  samples->SetNumberOfTuples(static_cast<vtkIdType>(written_.grid.sample_count()));
  std::memcpy(samples->GetVoidPointer(0), written_.bytes.data(), written_.bytes.size());
  samples->SetName("density");
  const Grid& grid = written_.grid;
  vtkNew<vtkImageData> image;
  // VTK's origin is the position of index 0, and this image begins at index (2, -1, 7).
  const std::array<int, 3> begin{2, -1, 7};
  image->SetExtent(begin[0], begin[0] + 4, begin[1], begin[1] + 3, begin[2], begin[2] + 2);
  image->SetSpacing(grid.spacing.x, grid.spacing.y, grid.spacing.z);
  const auto& d = grid.direction;
  image->SetDirectionMatrix(d[0].x, d[1].x, d[2].x, d[0].y, d[1].y, d[2].y, d[0].z, d[1].z, d[2].z);
  const double x = begin[0] * grid.spacing.x, y = begin[1] * grid.spacing.y,
               z = begin[2] * grid.spacing.z;
  image->SetOrigin(grid.origin.x - (d[0].x * x + d[1].x * y + d[2].x * z),
                   grid.origin.y - (d[0].y * x + d[1].y * y + d[2].y * z),
                   grid.origin.z - (d[0].z * x + d[1].z * y + d[2].z * z));
  image->GetPointData()->SetScalars(samples);
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
    const auto path = folder_ / "image.vti";
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(image);
    writer->SetDataMode(mode);
    writer->Write();
    SCOPED_TRACE(mode);
    expect_same(read_volume(path), written_, Geometry::full, 1e-9);
  }
}

TEST_P(EveryType, Raw) {
  const auto path = folder_ / "samples.raw";
  RawLayout layout;
  layout.size = written_.grid.size;
  layout.type = written_.type;
  layout.spacing = {0.5, 1.25, 3};
  write_bytes(path, written_.bytes);
  expect_same(read_volume(path, {.raw = layout}), written_, Geometry::spacing_only);

  std::string swapped = written_.bytes;
  const auto step = static_cast<std::ptrdiff_t>(bytes_per_sample(written_.type));
  for (auto first = swapped.begin(); first != swapped.end(); first += step) {
    std::reverse(first, first + step);
  }
  write_bytes(path, swapped);
  layout.big_endian = true;
  expect_same(read_volume(path, {.raw = layout}), written_, Geometry::spacing_only);
}

TEST(VolumeGeometry, NegativeSpacingReversesTheAxis) {
  const TempFolder folder;
  write_bytes(folder / "turned.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 -2 3\nencoding: "
              "raw\n\n12345678");
  const Grid grid = read_volume(folder / "turned.nrrd").view.grid;
  EXPECT_EQ(grid.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(grid.direction[1], (Vec3{0, -1, 0}));
}

TEST(VolumeGeometry, LengthOfAnAxisIsMovedToTheSpacing) {
  const TempFolder folder;
  write_bytes(folder / "long.mha",
              "ObjectType = Image\nNDims = 3\nBinaryData = True\nTransformMatrix = 0 2 0 -1 0 0 0 "
              "0 1\nOffset = 1 2 3\n"
              "ElementSpacing = 1 1 1\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = "
              "LOCAL\n12345678");
  const Grid grid = read_volume(folder / "long.mha").view.grid;
  EXPECT_EQ(grid.spacing, (Vec3{2, 1, 1}));
  EXPECT_EQ(grid.direction[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(grid.direction[1], (Vec3{-1, 0, 0}));
  EXPECT_EQ(grid.origin, (Vec3{1, 2, 3}));
}

TEST(VolumeGeometry, NrrdInRasIsReadInLps) {
  const TempFolder folder;
  write_bytes(folder / "ras.nrrd",
              "NRRD0005\ntype: uint8\ndimension: 3\nspace: right-anterior-superior\nsizes: 2 2 2\n"
              "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\nencoding: "
              "raw\n\n12345678");
  const Grid grid = read_volume(folder / "ras.nrrd").view.grid;
  EXPECT_EQ(grid.origin, (Vec3{-10, -20, 30}));
  EXPECT_EQ(grid.direction[0], (Vec3{-1, 0, 0}));
  EXPECT_EQ(grid.direction[1], (Vec3{0, -1, 0}));
  EXPECT_EQ(grid.spacing, (Vec3{2, 3, 4}));
}

TEST(VolumeGeometry, ImageJStackHasItsSliceDistance) {
  const TempFolder folder;
  const auto path = folder / "imagej.tif";
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  for (int z = 0; z < 2; ++z) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 2);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 2);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 4.0);
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 2.0);
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION,
                 "ImageJ=1.53\nimages=2\nslices=2\nunit=micron\nspacing=1.5\n");
    std::string rows = "abcd";
    TIFFWriteEncodedStrip(tiff, 0, rows.data(), 4);
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
  EXPECT_EQ(read_volume(path).view.grid.spacing, (Vec3{0.25, 0.5, 1.5}));
}

TEST(VolumeSamples, NiftiScaleIsApplied) {
  const TempFolder folder;
  const TestVolume written(SampleType::uint8);
  write_with(*itk::NiftiImageIO::New(), folder / "scaled.nii", written.grid, written.type,
             written.bytes);
  std::string bytes = read_bytes(folder / "scaled.nii");
  const std::array<float, 2> scale{2.5F, -7.0F};
  std::memcpy(bytes.data() + 112, scale.data(), sizeof scale);
  write_bytes(folder / "scaled.nii", bytes);
  const Volume volume = read_volume(folder / "scaled.nii");
  ASSERT_EQ(volume.view.type, SampleType::float32);
  for (std::size_t i = 0; i < written.bytes.size(); ++i) {
    EXPECT_EQ(static_cast<const float*>(volume.view.samples)[i],
              static_cast<unsigned char>(written.bytes[i]) * 2.5F - 7.0F);
  }
}

TEST(VolumeSamples, NiftiKeepsNaNAndInfinity) {  // the library behind ITK reads them as 0
  const TempFolder folder;
  const TestVolume written(SampleType::float32);
  write_with(*itk::NiftiImageIO::New(), folder / "holes.nii", written.grid, written.type,
             written.bytes);
  std::string bytes = read_bytes(folder / "holes.nii");
  const std::array<float, 3> holes{std::numeric_limits<float>::quiet_NaN(),
                                   -std::numeric_limits<float>::infinity(),
                                   std::numeric_limits<float>::infinity()};
  std::memcpy(bytes.data() + 352 + 4 * 5, holes.data(), sizeof holes);
  write_bytes(folder / "holes.nii", bytes);
  const Volume volume = read_volume(folder / "holes.nii");
  const SampleSummary summary = summarize(volume);
  EXPECT_EQ(summary.nan_count, 1u);
  EXPECT_EQ(summary.infinity_count, 2u);
  EXPECT_EQ(summary.first_non_finite,
            (std::array<std::size_t, 3>{5 % written.grid.size[0], 5 / written.grid.size[0], 0}));
  EXPECT_EQ(static_cast<const float*>(volume.view.samples)[6], holes[1]);
  EXPECT_EQ(static_cast<const float*>(volume.view.samples)[7], holes[2]);
}

TEST(VolumeSamples, FourDimensionsWithOneVolumeAreAVolume) {
  const TempFolder folder;
  write_bytes(folder / "one.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 1\nencoding: raw\n\n12345678");
  EXPECT_EQ(read_volume(folder / "one.nrrd").view.grid.size, (std::array<std::size_t, 3>{2, 2, 2}));
}

TEST(VolumeSamples, OutliveTheirVolume) {  // a view and the owner are enough
  const TempFolder folder;
  write_bytes(folder / "a.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n12345678");
  std::shared_ptr<const void> owner;
  VolumeView view;
  {
    const Volume volume = read_volume(folder / "a.nrrd");
    owner = volume.owner;
    view = volume;
  }
  EXPECT_EQ(std::memcmp(view.samples, "12345678", 8), 0);
}

}  // namespace
}  // namespace isoatlas::detail::test
