// SPDX-License-Identifier: Apache-2.0
// HDF5 files that its library writes; tests/hosts/zarr/test_hdf5.py reads those of h5py.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <string>
#include <vector>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/volume_bytes.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;
using Sizes = std::vector<hsize_t>;

class Hdf5 : public testing::Test {
 protected:
  TempFolder folder_;
  fs::path path_ = folder_ / "a.h5";
  hid_t file_ = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);

  ~Hdf5() override { close(); }
  void close() {
    if (file_ >= 0) H5Fclose(file_);
    file_ = -1;
  }
  // A dataset of counting numbers, stored as `stored`, with chunks and checksums if wanted.
  template <class T>
  void put(const char* name, const Sizes& sizes, hid_t stored, hid_t memory,
           const Sizes& chunks = {}) {
    std::size_t count = 1;
    for (const hsize_t n : sizes) count *= n;
    const std::vector<T> values = ramp<T>(count);
    const hid_t space = H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
    const hid_t options = H5Pcreate(H5P_DATASET_CREATE);
    if (!chunks.empty()) {
      H5Pset_chunk(options, static_cast<int>(chunks.size()), chunks.data());
      H5Pset_fletcher32(options);
    }
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t data = H5Dcreate2(file_, name, stored, space, links, options, H5P_DEFAULT);
    H5Dwrite(data, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(data);
    H5Pclose(links);
    H5Pclose(options);
    H5Sclose(space);
  }
  void put_bytes(const char* name, const Sizes& sizes = {2, 3, 4}, const Sizes& chunks = {}) {
    put<std::uint8_t>(name, sizes, H5T_STD_U8LE, H5T_NATIVE_UINT8, chunks);
  }
  void state_lengths(const char* dataset, std::array<double, 3> lengths) {
    const hid_t data = H5Dopen2(file_, dataset, H5P_DEFAULT);
    const hsize_t count = 3;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t attribute =
        H5Acreate2(data, "element_size_um", H5T_IEEE_F32LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, lengths.data());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Dclose(data);
  }
  VolumeFile read(const ReadOptions& options = {}) {
    close();
    return read_volume_file(path_, options);
  }
  template <class T>
  void expect_type(hid_t stored, hid_t memory, SampleType type) {
    put<T>("a", {2, 3, 4}, stored, memory);
    const VolumeFile file = read();
    EXPECT_EQ(file.volume.view.type, type);
    EXPECT_EQ(sample_digest(file.volume), sample_digest(view_of(ramp<T>(24))));
    file_ = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  }
  template <class T>
  static Volume view_of(const std::vector<T>& values) {
    Volume out;
    const auto kept = std::make_shared<std::vector<T>>(values);
    out.view = VolumeView::of(std::span<const T>(*kept), {4, 3, 2});
    out.owner = kept;
    return out;
  }
};

TEST_F(Hdf5, TypesInBothByteOrders) {
  expect_type<std::int8_t>(H5T_STD_I8BE, H5T_NATIVE_INT8, SampleType::int8);
  expect_type<std::uint8_t>(H5T_STD_U8LE, H5T_NATIVE_UINT8, SampleType::uint8);
  expect_type<std::int16_t>(H5T_STD_I16BE, H5T_NATIVE_INT16, SampleType::int16);
  expect_type<std::uint16_t>(H5T_STD_U16LE, H5T_NATIVE_UINT16, SampleType::uint16);
  expect_type<std::int32_t>(H5T_STD_I32LE, H5T_NATIVE_INT32, SampleType::int32);
  expect_type<std::uint32_t>(H5T_STD_U32BE, H5T_NATIVE_UINT32, SampleType::uint32);
  expect_type<std::int64_t>(H5T_STD_I64LE, H5T_NATIVE_INT64, SampleType::int64);
  expect_type<std::uint64_t>(H5T_STD_U64BE, H5T_NATIVE_UINT64, SampleType::uint64);
  expect_type<float>(H5T_IEEE_F32BE, H5T_NATIVE_FLOAT, SampleType::float32);
  expect_type<double>(H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, SampleType::float64);
}

TEST_F(Hdf5, ADatasetOfSeveralIsChosen) {
  put_bytes("raw");
  put_bytes("more/cells", {1, 2, 3, 4, 1});
  put_bytes("flat", {3, 4});
  put_bytes("many", {2, 2, 3, 4});
  H5Lcreate_soft("/", file_, "loop", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_external("/etc/passwd", "/a", file_, "elsewhere", H5P_DEFAULT, H5P_DEFAULT);
  close();
  try {
    read();
    ADD_FAILURE() << "no error";
  } catch (const ChoiceNeeded& needed) {
    EXPECT_EQ(needed.choice().name, "array");
    EXPECT_EQ(needed.choice().entries, (std::vector<std::string>{"/many", "/more/cells", "/raw"}));
  }
  ReadOptions options;
  for (const char* name : {"/raw", "/more/cells"}) {
    options.array = name;
    EXPECT_EQ(sample_digest(read(options).volume), sample_digest(view_of(ramp<std::uint8_t>(24))));
  }
  options.array = "/many";
  expect_error(ErrorCode::unsupported, "has 4 axes with several entries, expected 3", path_,
               [&] { read(options); });
}

TEST_F(Hdf5, LengthsOfFiji) {
  put_bytes("a");
  state_lengths("a", {2, 0.5, 0.25});
  const VolumeFile file = read();
  EXPECT_TRUE(file.source.has_spacing);
  EXPECT_EQ(file.volume.view.grid.spacing, (Vec3{0.25, 0.5, 2}));
  EXPECT_EQ(file.volume.view.grid.unit, LengthUnit::micrometre);
}

TEST_F(Hdf5, WithoutLengthsThereIsAWarning) {
  put_bytes("a");
  const VolumeFile file = read();
  EXPECT_FALSE(file.source.has_spacing);
  ASSERT_EQ(file.source.warnings.size(), 1u);
  EXPECT_EQ(file.source.warnings[0], "states no voxel size; 1 x 1 x 1 is assumed");
}

TEST_F(Hdf5, ADamagedChunkIsNamed) {
  put_bytes("a", {4, 6, 8}, {2, 3, 4});
  close();
  std::string bytes = read_bytes(path_);
  // The samples of the second chunk along x begin with 4, 5, 6, 7 and 12.
  const std::size_t at = bytes.find(std::string{4, 5, 6, 7, 12, 13, 14, 15});
  ASSERT_NE(at, std::string::npos);
  bytes[at + 2] = 99;
  write_bytes(path_, bytes);
  expect_error(ErrorCode::bad_file, "'/a' cannot be read: chunk (0, 0, 1): ", path_,
               [&] { read(); });
  ReadOptions options;
  options.region = {{0, 0, 0}, {3, 5, 3}};
  EXPECT_EQ(read(options).volume.view.grid.size, (Size3{4, 6, 4}));
  write_bytes(path_, bytes.substr(0, 700));
  expect_error(ErrorCode::bad_file, "cannot be opened: ", path_, [&] { read(); });
}

TEST_F(Hdf5, BoxesAreReadFromTheFile) {
  put_bytes("a", {4, 6, 8}, {2, 3, 4});
  close();
  const VolumeReader reader(path_);
  const Volume whole = read_volume(path_);
  const Volume box = reader.box({1, 2, 0}, {6, 4, 3});
  EXPECT_EQ(sample_digest(box), sample_digest(whole.view.box({1, 2, 0}, {6, 4, 3})));
  EXPECT_EQ(reader.digest(), sample_digest(whole));
}

TEST_F(Hdf5, WithoutAVolumeIsRefused) {
  put_bytes("flat", {3, 4});
  expect_error(ErrorCode::unsupported, "has no dataset of numbers with three axes or more", path_,
               [&] { read(); });
}

}  // namespace
}  // namespace isoatlas::detail::test
