// SPDX-License-Identifier: Apache-2.0
// Zarr folders written by hand: what zarr-python does not write (tests/hosts/zarr reads what it
// writes), and damaged and hostile ones.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "isoatlas/io.h"
#include "support/file_test_support.h"
#include "support/volume_bytes.h"

namespace isoatlas::detail::test {
namespace {

namespace fs = std::filesystem;

// An array of 2 x 3 x 4 samples in one chunk; `more` are more entries.
std::string version_2(const std::string& more = "", const std::string& shape = "[2, 3, 4]",
                      const std::string& dtype = R"("|u1")",
                      const std::string& chunks = "[2, 3, 4]") {
  return R"({"zarr_format": 2, "shape": )" + shape + R"(, "chunks": )" + chunks + R"(, "dtype": )" +
         dtype + R"(, "order": "C", "fill_value": 9, "filters": null, "compressor": null)" + more +
         "}";
}

std::string version_3(const std::string& codecs, const std::string& more = "") {
  return R"({"zarr_format": 3, "node_type": "array", "shape": [2, 3, 4], "data_type": "uint8",
    "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 3, 4]}},
    "chunk_key_encoding": {"name": "default"}, "fill_value": 0, "codecs": )" +
         codecs + more + "}";
}

const std::string kSamples = bytes_of(ramp<std::uint8_t>(24));
const std::string kOmeAxes =
    R"("axes": [{"name": "z", "type": "space", "unit": "millimeter"},
                {"name": "y", "type": "space", "unit": "micrometer"},
                {"name": "x", "type": "space", "unit": "nanometer"}])";

class ZarrFolder : public testing::Test {
 protected:
  TempFolder folder_;

  fs::path put(const std::string& file, const std::string& bytes) {
    const fs::path path = folder_.path() / file;
    fs::create_directories(path.parent_path());
    write_bytes(path, bytes);
    return path;
  }
  VolumeFile read(const std::string& name, const ReadOptions& options = {}) {
    return read_volume_file(folder_ / name, options);
  }
  std::string samples(const VolumeFile& file) {
    const VolumeView& view = file.volume.view;
    return {static_cast<const char*>(static_cast<const void*>(view.samples)),
            view.grid.sample_count() * bytes_per_sample(view.type)};
  }
  static double sample_at(const VolumeView& view, std::size_t index) {
    if (view.type == SampleType::uint8)
      return static_cast<const std::uint8_t*>(view.samples)[index];
    return view.type == SampleType::float32 ? static_cast<const float*>(view.samples)[index]
                                            : static_cast<const double*>(view.samples)[index];
  }
  void refuse(const std::string& metadata, ErrorCode code, const std::string& message,
              const std::string& chunk = kSamples) {
    SCOPED_TRACE(message);
    const bool is_2 = metadata.find("zarr_format\": 2") != std::string::npos;
    fs::remove_all(folder_ / "bad");
    put(is_2 ? "bad/.zarray" : "bad/zarr.json", metadata);
    put(is_2 ? "bad/0.0.0" : "bad/c/0/0/0", chunk);
    expect_error(code, message, folder_ / "bad", [&] { read("bad"); });
  }
};

TEST_F(ZarrFolder, PlainArrays) {
  put("a/.zarray", version_2());
  put("a/0.0.0", kSamples);
  const VolumeFile file = read("a");
  EXPECT_EQ(samples(file), kSamples);
  EXPECT_EQ(file.volume.view.grid.size, (Size3{4, 3, 2}));
  EXPECT_EQ(file.source.format, "Zarr 2");
  EXPECT_FALSE(file.source.has_spacing);
  put("b/zarr.json", version_3(R"([{"name": "bytes"}])"));
  put("b/c/0/0/0", kSamples);
  EXPECT_EQ(samples(read("b")), kSamples);
}

TEST_F(ZarrFolder, AxesByTheirNames) {
  put("a/zarr.json",
      version_3(R"([{"name": "bytes"}])", R"(, "dimension_names": ["x", "z", "y"])"));
  put("a/c/0/0/0", kSamples);
  const VolumeFile file = read("a");
  EXPECT_EQ(file.volume.view.grid.size, (Size3{2, 4, 3}));
  EXPECT_EQ(samples(file).substr(0, 4), (std::string{0, 12, 1, 13}));
  put("b/.zarray", version_2("", "[1, 2, 3, 4]", R"("|u1")", "[1, 2, 3, 4]"));
  put("b/.zattrs", R"({"_ARRAY_DIMENSIONS": ["wavelength", "z", "y", "x"]})");
  put("b/0.0.0.0", kSamples);
  EXPECT_EQ(samples(read("b")), kSamples);
  fs::remove(folder_ / "b/.zattrs");
  EXPECT_EQ(samples(read("b")), kSamples);
  put("c/.zarray", version_2("", "[2, 1, 3, 2, 2]", R"("|u1")", "[2, 1, 3, 2, 2]"));
  put("c/0.0.0.0.0", kSamples);
  expect_error(ErrorCode::unsupported, "has 4 axes without names and with several entries",
               folder_ / "c", [&] { read("c"); });
}

TEST_F(ZarrFolder, ChunksThatAreNotStoredHaveTheFillValue) {
  put("a/.zarray", version_2("", "[2, 3, 4]", R"("|u1")", "[2, 3, 2]"));
  put("a/0.0.1", std::string(12, 5));
  std::string expected;
  for (int row = 0; row < 6; ++row) expected += std::string{9, 9, 5, 5};
  EXPECT_EQ(samples(read("a")), expected);
  fs::remove(folder_ / "a/0.0.1");
  expect_error(ErrorCode::bad_file, "has none of its chunks", folder_ / "a", [&] { read("a"); });
}

TEST_F(ZarrFolder, FillValuesThatAreText) {
  const auto fill = [&](const std::string& type, std::size_t bytes, const std::string& value) {
    put("a/.zarray", R"({"zarr_format": 2, "shape": [2, 2, 2], "chunks": [2, 2, 1], "dtype": ")" +
                         type + R"(", "order": "C", "filters": null, "compressor": null,
                         "fill_value": )" +
                         value + "}");
    put("a/0.0.0", std::string(4 * bytes, '\0'));
    return sample_at(read("a").volume, 1);
  };
  EXPECT_EQ(fill("<f4", 4, R"("Infinity")"), INFINITY);
  EXPECT_EQ(fill("<f8", 8, R"("-Infinity")"), -INFINITY);
  EXPECT_TRUE(std::isnan(fill("<f4", 4, R"("NaN")")));
  EXPECT_EQ(fill("<f4", 4, R"("0x3fc00000")"), 1.5);
  EXPECT_EQ(fill("<f8", 8, R"("0x3ff8000000000000")"), 1.5);
  EXPECT_EQ(fill("<f2", 2, R"("0x3e00")"), 1.5);
  EXPECT_EQ(fill("|u1", 1, "300.0"), 0);  // no sample: undefined
  for (const char* value : {R"("0x3fc0")", R"("few")", R"("0x3fc0000g")"})
    expect_error(ErrorCode::unsupported, "has the fill value", folder_ / "a",
                 [&] { fill("<f4", 4, value); });
}

TEST_F(ZarrFolder, WithoutAScaleThereIsAWarning) {
  put("image/.zattrs", R"({"multiscales": [{)" + kOmeAxes + R"(, "datasets": [{"path": "0"}]}]})");
  put("image/0/.zarray", version_2());
  put("image/0/0.0.0", kSamples);
  const VolumeFile file = read("image");
  EXPECT_FALSE(file.source.has_spacing);
  EXPECT_EQ(file.source.warnings.size(), 1u);
}

TEST_F(ZarrFolder, LengthsOfOmeZarr) {
  put("image/.zattrs", R"({"multiscales": [{"version": "0.4", )" + kOmeAxes +
                           R"(, "datasets": [{"path": "0", "coordinateTransformations":
              [{"type": "scale", "scale": [0.001, 2, 3000]},
               {"type": "translation", "translation": [0.01, 0.5, 1000]}]}],
             "coordinateTransformations": [{"type": "scale", "scale": [2, 2, 2]}]}]})");
  put("image/0/.zarray", version_2());
  put("image/0/0.0.0", kSamples);
  for (const char* name : {"image", "image/0", "image/"}) {
    const Grid grid = read(name).volume.view.grid;
    EXPECT_EQ(grid.unit, LengthUnit::nanometre);
    EXPECT_DOUBLE_EQ(grid.spacing.x, 6000);
    EXPECT_DOUBLE_EQ(grid.spacing.y, 4000);
    EXPECT_DOUBLE_EQ(grid.spacing.z, 2000);
    EXPECT_DOUBLE_EQ(grid.origin.x, 2000);
    EXPECT_DOUBLE_EQ(grid.origin.y, 1000);
    EXPECT_DOUBLE_EQ(grid.origin.z, 20000);
  }
}

TEST_F(ZarrFolder, RegionWithAnotherSpacing) {
  put("a/.zarray", version_2());
  put("a/0.0.0", kSamples);
  ReadOptions options;
  options.region = {{1, 1, 0}, {2, 2, Region::kEnd}};
  options.spacing = Vec3{2, 3, 4};
  const VolumeFile file = read("a", options);
  EXPECT_EQ(samples(file), (std::string{5, 6, 9, 10, 17, 18, 21, 22}));
  EXPECT_EQ(file.volume.view.grid.origin, (Vec3{2, 3, 0}));
  options.region = {{1, 1, 0}, {2, 3, Region::kEnd}};
  expect_error(ErrorCode::bad_argument, "along y, expected two or more of 0 to 2", folder_ / "a",
               [&] { read("a", options); });
}

TEST_F(ZarrFolder, GroupsWithoutAnImage) {
  put("group/.zgroup", R"({"zarr_format": 2})");
  expect_error(ErrorCode::unsupported, "without arrays", folder_ / "group", [&] { read("group"); });
  put("group/one/.zarray", version_2());
  put("group/one/0.0.0", kSamples);
  put("group/OME/.zgroup", R"({"zarr_format": 2})");  // as bioformats2raw writes it
  EXPECT_EQ(samples(read("group")), kSamples);
  put("group/two/.zarray", version_2());
  expect_error(ErrorCode::unsupported, "several members, expected one of them: ", folder_ / "group",
               [&] { read("group"); });
  put("group/.zattrs", R"({"plate": {}})");
  expect_error(ErrorCode::unsupported, "is a plate", folder_ / "group", [&] { read("group"); });
}

TEST_F(ZarrFolder, DatasetsOutsideTheFolderAreRefused) {
  put("secret/.zarray", version_2());
  put("secret/0.0.0", kSamples);
  const std::string absolute = folder_ / "secret";
  for (const std::string& path :
       {std::string("../secret"), std::string("a/../../secret"), absolute, std::string()}) {
    put("image/.zattrs",
        R"({"multiscales": [{)" + kOmeAxes + R"(, "datasets": [{"path": ")" + path + R"("}]}]})");
    expect_error(ErrorCode::bad_file, "expected the path of an array in its folder",
                 folder_ / "image", [&] { read("image"); });
  }
}

TEST_F(ZarrFolder, BadMetadataIsRefused) {
  refuse(R"({"zarr_format": 2)", ErrorCode::bad_file, "is not a JSON object");
  refuse(R"({"zarr_format": 2})", ErrorCode::bad_file, "has no list of numbers 'shape'");
  refuse(version_2("", "[2, -3, 4]"), ErrorCode::bad_file, "has no list of numbers 'shape'");
  refuse(version_2("", "[2, 3]"), ErrorCode::bad_file, "chunks of 3 axes, but 2 axes");
  refuse(version_2("", "[]"), ErrorCode::unsupported, "has 0 axes");
  refuse(version_2("", "[2, 3, 1]"), ErrorCode::unsupported, "at least 2 along each axis");
  refuse(version_2("", "[2, 3, 4]", R"("<c8")"), ErrorCode::unsupported, "<c8");
  refuse(version_2("", "[2, 3, 4]", R"([["r", "|u1"]])"), ErrorCode::unsupported, "of type");
  refuse(version_2("", "[2, 3, 4]", R"("|u1")", "[0, 3, 4]"), ErrorCode::bad_file, "is 0");
  refuse(version_2("", "[2, 3, 4]", R"("|u1")", "[4294967296, 4294967296, 4294967296]"),
         ErrorCode::bad_file, "overflows");
  refuse(version_2("", "[2, 3, 4]", R"("|u1")", "[9007199254740992, 3, 4]"),
         ErrorCode::out_of_memory, "more than the limit");
  refuse(version_2("", "[9007199254740992, 3, 4]"), ErrorCode::out_of_memory,
         "more than the limit");
  refuse(version_2(R"(, "compressor": {"id": "webp"})"), ErrorCode::unsupported, "codec 'webp'");
  refuse(version_2(R"(, "filters": [{"id": "delta"}])"), ErrorCode::unsupported, "has filters");
  refuse(version_3("[]", R"(, "data_type": "string")"), ErrorCode::unsupported, "string");
  refuse(version_3("[]", R"(, "chunk_grid": {"name": "rectilinear"})"), ErrorCode::unsupported,
         "not regular");
  refuse(version_3(R"([{"name": "transpose", "configuration": {"order": [0, 0, 1]}}])"),
         ErrorCode::bad_file, "no permutation");
  refuse(
      version_3(R"([{"name": "sharding_indexed", "configuration": {"chunk_shape": [2, 2, 4]}}])"),
      ErrorCode::bad_file, "do not fill their shard");
  refuse(version_3(R"([{"name": "sharding_indexed", "configuration": {"chunk_shape": [1, 3, 4],
                       "index_codecs": [{"name": "zstd"}]}}])"),
         ErrorCode::unsupported, "compressed indices");
}

TEST_F(ZarrFolder, BadChunksAreRefused) {
  const auto with = [](const std::string& id) {
    return version_2(R"(, "compressor": {"id": ")" + id + R"("})");
  };
  refuse(version_2(), ErrorCode::bad_file, "chunk (0, 0, 0) is damaged: its size", kSamples + "1");
  refuse(version_2(), ErrorCode::bad_file, "chunk (0, 0, 0) is damaged: its size", "123");
  for (const char* id : {"gzip", "zlib", "bz2", "zstd", "lz4", "blosc"}) {
    for (const std::string& chunk : {kSamples, std::string(3, 'x'), std::string(40, '\xff')})
      refuse(with(id), ErrorCode::bad_file, "chunk (0, 0, 0) is damaged: ", chunk);
  }
  const std::string sharded =
      version_3(R"([{"name": "sharding_indexed", "configuration": {"chunk_shape": [1, 3, 4],
                     "codecs": [{"name": "bytes"}], "index_codecs": [{"name": "bytes"}]}}])");
  using Numbers = std::vector<std::uint64_t>;
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  refuse(sharded, ErrorCode::bad_file, "without its index", "short");
  for (const Numbers& index :
       {Numbers{0, 12, 12, 60}, Numbers{0, 12, kMost - 3, 12}, Numbers{0, 12, 13, kMost}})
    refuse(sharded, ErrorCode::bad_file, "chunk (1, 0, 0) is damaged: it is cut off",
           kSamples + bytes_of(index));
  put("good/zarr.json", sharded);
  put("good/c/0/0/0", kSamples + bytes_of(Numbers{12, 12, 0, 12}));
  EXPECT_EQ(samples(read("good")), kSamples.substr(12) + kSamples.substr(0, 12));
}

}  // namespace
}  // namespace isoatlas::detail::test
