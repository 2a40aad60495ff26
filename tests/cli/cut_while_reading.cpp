// SPDX-License-Identifier: Apache-2.0
// Preloaded into the tool by the tests: truncates the file CUT_FILE to CUT_LENGTH bytes after it
// was opened or read CUT_AFTER times, as another program may do.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace {

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool is_the_file(int descriptor) {
  const char* path = std::getenv("CUT_FILE");
  struct stat wanted {
  }, found{};
  return path != nullptr && stat(path, &wanted) == 0 && fstat(descriptor, &found) == 0 &&
         wanted.st_ino == found.st_ino && wanted.st_dev == found.st_dev;
}

void count(int descriptor) {
  static std::atomic<int> uses{0};
  if (descriptor < 0 || !is_the_file(descriptor) || ++uses != std::atoi(std::getenv("CUT_AFTER")))
    return;
  if (truncate(std::getenv("CUT_FILE"), std::atol(std::getenv("CUT_LENGTH"))) != 0) std::abort();
}

}  // namespace

extern "C" {

FILE* fopen64(const char* path, const char* mode) {
  static const auto original = next<FILE* (*)(const char*, const char*)>("fopen64");
  FILE* file = original(path, mode);
  if (file != nullptr) count(fileno(file));
  return file;
}

FILE* fopen(const char* path, const char* mode) { return fopen64(path, mode); }

int open64(const char* path, int flags, ...) {
  static const auto original = next<int (*)(const char*, int, ...)>("open64");
  va_list rest;
  va_start(rest, flags);
  const int descriptor =
      original(path, flags, (flags & O_CREAT) != 0 ? va_arg(rest, unsigned) : 0U);
  va_end(rest);
  count(descriptor);
  return descriptor;
}

ssize_t read(int descriptor, void* to, size_t bytes) {
  static const auto original = next<ssize_t (*)(int, void*, size_t)>("read");
  const ssize_t result = original(descriptor, to, bytes);
  count(descriptor);
  return result;
}

ssize_t pread64(int descriptor, void* to, size_t bytes, off64_t offset) {
  static const auto original = next<ssize_t (*)(int, void*, size_t, off64_t)>("pread64");
  const ssize_t result = original(descriptor, to, bytes, offset);
  count(descriptor);
  return result;
}

size_t fread(void* to, size_t size, size_t items, FILE* file) {
  static const auto original = next<size_t (*)(void*, size_t, size_t, FILE*)>("fread");
  const size_t result = original(to, size, items, file);
  count(fileno(file));
  return result;
}

}  // extern "C"
