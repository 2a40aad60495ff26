// SPDX-License-Identifier: Apache-2.0
#include "files/decompressor.h"

#include <bzlib.h>
#include <zlib.h>

#include <new>

namespace isoatlas::detail::io {
namespace {

class Inflater final : public Decompressor {
 public:
  Inflater() {
    constexpr int kGzipOrZlib = 15 + 32;
    if (inflateInit2(&stream_, kGzipOrZlib) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() override { inflateEnd(&stream_); }
  Step step(const char* from, std::size_t available, char* to, std::size_t room) override {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from));
    stream_.avail_in = static_cast<uInt>(available);
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(room);
    const int result = inflate(&stream_, Z_NO_FLUSH);
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) throw "damaged";
    return {available - stream_.avail_in, room - stream_.avail_out, result == Z_STREAM_END};
  }
  void start_next_member() override { inflateReset(&stream_); }

 private:
  z_stream stream_{};
};

class Bunzipper final : public Decompressor {
 public:
  Bunzipper() { start(); }
  ~Bunzipper() override { BZ2_bzDecompressEnd(&stream_); }
  Step step(const char* from, std::size_t available, char* to, std::size_t room) override {
    stream_.next_in = const_cast<char*>(from);
    stream_.avail_in = static_cast<unsigned>(available);
    stream_.next_out = to;
    stream_.avail_out = static_cast<unsigned>(room);
    const int result = BZ2_bzDecompress(&stream_);
    if (result != BZ_OK && result != BZ_STREAM_END) throw "damaged";
    return {available - stream_.avail_in, room - stream_.avail_out, result == BZ_STREAM_END};
  }
  void start_next_member() override {
    BZ2_bzDecompressEnd(&stream_);
    start();
  }

 private:
  void start() {
    stream_ = {};
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  bz_stream stream_{};
};

}  // namespace

std::unique_ptr<Decompressor> decompressor_for(Packing packing) {
  if (packing == Packing::deflate) return std::make_unique<Inflater>();
  if (packing == Packing::bzip2) return std::make_unique<Bunzipper>();
  return nullptr;
}

}  // namespace isoatlas::detail::io
