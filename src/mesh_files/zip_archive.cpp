// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/zip_archive.h"

#include <zip.h>

#include <algorithm>

#include "files/file_error.h"

namespace isoatlas::detail::io {

namespace {

// The first day of MS-DOS: an archive has a date for every part, and the bytes must not depend on
// the current date.
constexpr zip_uint16_t kTime = 0;
constexpr zip_uint16_t kDate = (0 << 9) | (1 << 5) | 1;  // 1980-01-01

struct Source {
  zip_source_t* source;
  ~Source() { zip_source_free(source); }
};

[[noreturn]] void fail_writing(const std::filesystem::path& path, const char* reason) {
  throw bad_file(path, std::string("cannot be written: its archive: ") + reason);
}

// Adds parts to `archive`, which owns its sources once it is closed without an error.
void add_part(zip_t* archive, const std::string& name, const std::string& content,
              const std::filesystem::path& path) {
  zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
  const zip_int64_t index =
      source == nullptr ? -1 : zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    fail_writing(path, zip_strerror(archive));
  }
  const auto part = static_cast<zip_uint64_t>(index);
  if (zip_set_file_compression(archive, part, ZIP_CM_DEFLATE, 0) != 0 ||
      zip_file_set_dostime(archive, part, kTime, kDate, 0) != 0) {
    fail_writing(path, zip_strerror(archive));
  }
}

std::string content_of(zip_source_t* source, const std::filesystem::path& path) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  std::string bytes;
  if (zip_source_stat(source, &stat) == 0 && (stat.valid & ZIP_STAT_SIZE) != 0 &&
      zip_source_open(source) == 0) {
    bytes.resize(stat.size);
    const zip_int64_t count = zip_source_read(source, bytes.data(), bytes.size());
    zip_source_close(source);
    if (count == static_cast<zip_int64_t>(bytes.size())) {
      return bytes;
    }
  }
  fail_writing(path, zip_error_strerror(zip_source_error(source)));
}

}  // namespace

std::string zip_bytes(const std::vector<std::pair<std::string, std::string>>& parts,
                      const std::filesystem::path& path) {
  zip_error_t error;
  zip_error_init(&error);
  const Source source{zip_source_buffer_create(nullptr, 0, 0, &error)};
  zip_t* archive = source.source == nullptr
                       ? nullptr
                       : zip_open_from_source(source.source, ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    fail_writing(path, zip_error_strerror(&error));
  }
  zip_source_keep(source.source);  // the source is needed after the archive is closed
  try {
    for (const auto& [name, content] : parts) {
      add_part(archive, name, content, path);
    }
    if (zip_close(archive) != 0) {
      fail_writing(path, zip_strerror(archive));
    }
  } catch (...) {
    zip_discard(archive);
    throw;
  }
  return content_of(source.source, path);
}

struct ZipReader::Archive {
  zip_t* archive;
  ~Archive() { zip_discard(archive); }

  zip_stat_t stat(const std::string& name, const std::filesystem::path& path) const {
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_stat(archive, name.c_str(), ZIP_FL_NOCASE, &stat) != 0 ||
        (stat.valid & ZIP_STAT_SIZE) == 0) {
      throw bad_file(path, "has no part " + one_line(name, 80));
    }
    return stat;
  }

  std::string read(const zip_stat_t& stat, std::uint64_t bytes,
                   const std::filesystem::path& path) const {
    zip_file_t* file = zip_fopen_index(archive, stat.index, 0);
    if (file == nullptr) {
      throw bad_file(
          path, std::string("its part ") + stat.name + " cannot be read: " + zip_strerror(archive));
    }
    std::string content(bytes, '\0');
    // One byte more than there is: libzip compares the checksum at the end of the part.
    zip_int64_t count = zip_fread(file, content.data(), bytes);
    char beyond = 0;
    if (count == static_cast<zip_int64_t>(bytes) && bytes == stat.size &&
        zip_fread(file, &beyond, 1) != 0) {
      count = -1;
    }
    const std::string reason = one_line(zip_file_strerror(file));
    zip_fclose(file);
    if (count != static_cast<zip_int64_t>(bytes)) {
      throw bad_file(path,
                     std::string("its part ") + stat.name + " is damaged or cut off: " + reason);
    }
    return content;
  }
};

ZipReader::ZipReader(const std::filesystem::path& path) : path_(path) {
  int code = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY, &code);
  if (archive == nullptr) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string reason = one_line(zip_error_strerror(&error));
    zip_error_fini(&error);
    throw bad_file(path, "is not a ZIP archive that can be read: " + reason);
  }
  archive_.reset(new Archive{archive});
}

ZipReader::~ZipReader() = default;

std::string ZipReader::part(const std::string& name, std::uint64_t most_bytes) const {
  const zip_stat_t stat = archive_->stat(name, path_);
  constexpr std::uint64_t kMostPerStoredByte = 1100;  // deflate shrinks nothing below 1/1032
  if (stat.size / kMostPerStoredByte > readable_file_size(path_)) {
    throw bad_file(path_, "states " + std::to_string(stat.size) + " bytes in its part " + name +
                              ", more than a file of its size can hold");
  }
  if (stat.size > most_bytes) {
    throw out_of_memory(path_, stat.size);
  }
  return archive_->read(stat, stat.size, path_);
}

std::string ZipReader::beginning_of_part(const std::string& name, std::uint64_t bytes) const {
  const zip_stat_t stat = archive_->stat(name, path_);
  return archive_->read(stat, std::min<std::uint64_t>(bytes, stat.size), path_);
}

}  // namespace isoatlas::detail::io
