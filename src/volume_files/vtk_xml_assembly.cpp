// SPDX-License-Identifier: Apache-2.0
#include "volume_files/vtk_xml_assembly.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "field/sample_type.h"
#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace {

std::string place_of(const std::array<std::size_t, 3>& at) {
  return "sample (" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " +
         std::to_string(at[2]) + ")";
}

// The absolute difference; infinite if only one of the two is a number.
double difference(SampleType type, const std::byte* a, const std::byte* b) {
  return visit_sample_type(type, [&](auto* sample) {
    std::remove_const_t<std::remove_pointer_t<decltype(sample)>> x{}, y{};
    std::memcpy(&x, a, sizeof x);
    std::memcpy(&y, b, sizeof y);
    const double distance = std::abs(static_cast<double>(x) - static_cast<double>(y));
    const bool are_same = x == y || (x != x && y != y);
    return are_same               ? 0.0
           : std::isnan(distance) ? std::numeric_limits<double>::infinity()
                                  : distance;
  });
}

}  // namespace

PieceAssembly::PieceAssembly(const std::filesystem::path& path,
                             const std::array<std::size_t, 3>& size, SampleType type,
                             std::byte* samples)
    : path_(path),
      size_(size),
      type_(type),
      samples_(samples),
      states_(size[0] * size[1] * size[2], State::missing) {}

void PieceAssembly::add(VtkValues& values, std::uint64_t components, std::uint64_t component,
                        const SampleBox& stored, const SampleBox& wanted,
                        const std::vector<bool>& is_copy) {
  const std::size_t sample_bytes = bytes_per_sample(type_);
  std::vector<std::byte> row(stored.size[0] * sample_bytes);
  const auto is_wanted = [&](std::size_t axis, std::size_t i) {
    return i >= wanted.first[axis] && i - wanted.first[axis] < wanted.size[axis];
  };
  std::size_t number = 0;
  for (std::size_t z = stored.first[2]; z < stored.first[2] + stored.size[2]; ++z) {
    for (std::size_t y = stored.first[1]; y < stored.first[1] + stored.size[1]; ++y) {
      read_component(values, type_, components, component, stored.size[0], row.data());
      for (std::size_t i = 0; i < stored.size[0]; ++i, ++number) {
        const std::size_t x = stored.first[0] + i;
        if (is_wanted(0, x) && is_wanted(1, y) && is_wanted(2, z)) {
          store({x, y, z}, row.data() + i * sample_bytes, !is_copy.empty() && is_copy[number]);
        }
      }
    }
  }
}

void PieceAssembly::store(const std::array<std::size_t, 3>& at, const std::byte* sample,
                          bool is_copy) {
  const std::size_t index = index_of(at);
  const std::size_t sample_bytes = bytes_per_sample(type_);
  std::byte* const to = samples_ + index * sample_bytes;
  State& state = states_[index];
  if (state == State::missing || (state == State::copied && !is_copy)) {
    std::memcpy(to, sample, sample_bytes);
    state = is_copy ? State::copied : State::original;
  } else if (state == State::original && !is_copy && std::memcmp(to, sample, sample_bytes) != 0) {
    if (const double distance = difference(type_, to, sample); distance > largest_difference_) {
      largest_difference_ = distance;
      largest_difference_at_ = at;
    }
  }
}

void PieceAssembly::finish(VolumeSource& source) const {
  if (const auto gap = std::ranges::find(states_, State::missing); gap != states_.end()) {
    const auto index = static_cast<std::size_t>(gap - states_.begin());
    throw bad_file(
        path_,
        "has no piece with " +
            place_of({index % size_[0], index / size_[0] % size_[1], index / size_[0] / size_[1]}) +
            ", expected pieces that cover its WholeExtent; is it itself a piece of another file?");
  }
  if (largest_difference_ == 0) {
    return;
  }
  constexpr double kRounding = 1e-5;  // times the range of all samples
  const SampleSummary summary = summarize({{.size = size_}, type_, samples_});
  if (!(largest_difference_ <= kRounding * (summary.maximum - summary.minimum))) {
    throw bad_file(path_, "its pieces contradict each other: two of them differ by " +
                              std::to_string(largest_difference_) + " at " +
                              place_of(largest_difference_at_));
  }
  source.warnings.push_back(
      "its pieces differ by rounding where they overlap; the first piece's samples are used there");
}

}  // namespace isoatlas::detail::io
