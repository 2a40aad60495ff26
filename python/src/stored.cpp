// SPDX-License-Identifier: Apache-2.0
#include "stored.h"

#include <tuple>
#include <utility>

#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "stored/archive.h"

namespace isoatlas::detail::python {

ISOATLAS_FIELDS(Levels::Extracted, report, context)
ISOATLAS_FIELDS(Levels, hierarchy, info, extracted)

namespace {

constexpr std::string_view kVersion = ISOATLAS_VERSION;
constexpr std::string_view kPickledData = "the pickled data";

template <class T>
T unversioned(std::string_view bytes) {
  ArchiveReader reader(bytes, kPickledData);
  std::string version;
  transfer(reader, version);
  if (version != kVersion)
    throw Error(ErrorCode::bad_argument,
                "the pickled data are from another version of isoatlas, expected " +
                    std::string(kVersion) + ": keep meshes in files, with mesh.save()");
  T it;
  transfer(reader, it);
  reader.require_end();
  return it;
}

}  // namespace

std::string stored(const Levels& levels) {
  return bytes_of(std::string(kVersion)) + bytes_of(levels);
}

std::string stored(const VolumeSource& source) {
  return bytes_of(std::string(kVersion)) + bytes_of(source);
}

std::shared_ptr<Levels> levels_from(std::string_view bytes) {
  auto levels = std::make_shared<Levels>(unversioned<Levels>(bytes));
  require_corners_in_range(levels->hierarchy, kPickledData);
  return levels;
}

VolumeSource volume_source_from(std::string_view bytes) { return unversioned<VolumeSource>(bytes); }

}  // namespace isoatlas::detail::python
