// SPDX-License-Identifier: Apache-2.0
// Based on: DICOM PS3.5 annex G (RLE).
#include "volume_files/dicom_decoders.h"

#include <charls/charls.h>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmjpeg/djcparam.h>
#include <dcmtk/dcmjpeg/djdijg12.h>
#include <dcmtk/dcmjpeg/djdijg16.h>
#include <dcmtk/dcmjpeg/djdijg8.h>
#include <openjpeg.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <memory>
#include <sstream>
#include <vector>

namespace isoatlas::detail::io {

namespace {

// Captures DCMTK's messages while an object of this class exists. DCMTK fills a JPEG stream that
// ends too early with grey, and only a message reports it.
class MessageCapture {
 public:
  MessageCapture() : original_(std::cerr.rdbuf(text_.rdbuf())) {}
  ~MessageCapture() { std::cerr.rdbuf(original_); }
  MessageCapture(const MessageCapture&) = delete;
  MessageCapture& operator=(const MessageCapture&) = delete;

  bool reports_damage() const { return text_.str().find("Corrupt JPEG data") != std::string::npos; }

 private:
  std::ostringstream text_;
  std::streambuf* original_;
};

std::unique_ptr<DJDecoder> jpeg_decoder(const DJCodecParameter& parameters, unsigned bits) {
  if (bits <= 8) return std::make_unique<DJDecompressIJG8Bit>(parameters, OFFalse);
  if (bits <= 12) return std::make_unique<DJDecompressIJG12Bit>(parameters, OFFalse);
  return std::make_unique<DJDecompressIJG16Bit>(parameters, OFFalse);
}

/// The memory from which OpenJPEG reads a codestream.
struct StreamPosition {
  const std::string* stream = nullptr;
  std::size_t at = 0;
};

OPJ_SIZE_T read_codestream(void* to, OPJ_SIZE_T count, void* position) {
  auto& [stream, at] = *static_cast<StreamPosition*>(position);
  const std::size_t used = std::min<std::size_t>(count, stream->size() - at);
  std::memcpy(to, stream->data() + at, used);
  at += used;
  return used == 0 ? static_cast<OPJ_SIZE_T>(-1) : used;
}

OPJ_OFF_T skip_codestream(OPJ_OFF_T count, void* position) {
  auto& [stream, at] = *static_cast<StreamPosition*>(position);
  const std::size_t used =
      std::min(static_cast<std::size_t>(std::max<OPJ_OFF_T>(count, 0)), stream->size() - at);
  at += used;
  return static_cast<OPJ_OFF_T>(used);
}

OPJ_BOOL seek_codestream(OPJ_OFF_T to, void* position) {
  auto& [stream, at] = *static_cast<StreamPosition*>(position);
  if (to < 0 || static_cast<std::size_t>(to) > stream->size()) {
    return OPJ_FALSE;
  }
  at = static_cast<std::size_t>(to);
  return OPJ_TRUE;
}

void ignore_message(const char*, void*) {}

using CodecPointer = std::unique_ptr<opj_codec_t, void (*)(opj_codec_t*)>;
using StreamPointer = std::unique_ptr<opj_stream_t, void (*)(opj_stream_t*)>;
using ImagePointer = std::unique_ptr<opj_image_t, void (*)(opj_image_t*)>;

// Null if the codestream is not complete.
ImagePointer decoded_codestream(StreamPosition& position) {
  const CodecPointer codec(opj_create_decompress(OPJ_CODEC_J2K), opj_destroy_codec);
  const StreamPointer stream(opj_stream_default_create(OPJ_TRUE), opj_stream_destroy);
  opj_image_t* image = nullptr;
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  opj_set_info_handler(codec.get(), ignore_message, nullptr);
  opj_set_warning_handler(codec.get(), ignore_message, nullptr);
  opj_set_error_handler(codec.get(), ignore_message, nullptr);
  opj_stream_set_user_data(stream.get(), &position, nullptr);
  opj_stream_set_user_data_length(stream.get(), position.stream->size());
  opj_stream_set_read_function(stream.get(), read_codestream);
  opj_stream_set_skip_function(stream.get(), skip_codestream);
  opj_stream_set_seek_function(stream.get(), seek_codestream);
  const bool has_header = opj_setup_decoder(codec.get(), &parameters) != 0 &&
                          opj_read_header(stream.get(), codec.get(), &image) != 0;
  ImagePointer result(image, opj_image_destroy);
  if (!has_header || opj_decode(codec.get(), stream.get(), result.get()) == 0) {
    result.reset();
  }
  return result;
}

template <class Sample>
void copy_samples(const OPJ_INT32* samples, std::size_t count, char* to) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto sample = static_cast<Sample>(samples[i]);
    std::memcpy(to + i * sizeof sample, &sample, sizeof sample);
  }
}

// Decodes one segment of run lengths into every `stride`-th byte. False if it ends before `count`
// bytes.
bool decode_runs(std::string_view runs, char* to, std::size_t count, std::size_t stride) {
  std::size_t made = 0;
  for (std::size_t at = 0; made < count && at < runs.size();) {
    const auto code = static_cast<signed char>(runs[at++]);
    const bool is_literal = code >= 0, is_nothing = code == -128;
    const std::size_t length = is_nothing   ? 0
                               : is_literal ? static_cast<std::size_t>(code) + 1
                                            : static_cast<std::size_t>(1 - code);
    const std::size_t used = is_nothing ? 0 : is_literal ? length : 1;
    if (used > runs.size() - at) {
      return false;
    }
    for (std::size_t i = 0; i < std::min(length, count - made); ++i) {
      to[(made + i) * stride] = runs[at + (is_literal ? i : 0)];
    }
    made += length;
    at += used;
  }
  return made >= count;
}

}  // namespace

bool decode_jpeg(const std::string& stream, const FrameSize& frame, char* to) {
  const DJCodecParameter parameters(ECC_lossyYCbCr, EDC_never, EUC_default, EPC_default);
  const std::unique_ptr<DJDecoder> decoder = jpeg_decoder(parameters, frame.bits);
  std::string bytes = stream;  // a copy, because the decoder takes a pointer that is not const
  const MessageCapture messages;
  return decoder->init().good() &&
         decoder
             ->decode(reinterpret_cast<Uint8*>(bytes.data()), static_cast<Uint32>(bytes.size()),
                      reinterpret_cast<Uint8*>(to), static_cast<Uint32>(frame.bytes()),
                      frame.is_signed ? OFTrue : OFFalse)
             .good() &&
         !messages.reports_damage();
}

bool decode_jpeg_ls(const std::string& stream, const FrameSize& frame, char* to) {
  try {
    charls::jpegls_decoder decoder(stream, true);
    if (decoder.destination_size() != frame.bytes()) {
      return false;
    }
    decoder.decode(to, frame.bytes());
    return true;
  } catch (const charls::jpegls_error&) {
    return false;
  }
}

bool decode_jpeg_2000(const std::string& stream, const FrameSize& frame, char* to) {
  StreamPosition position{&stream, 0};
  const ImagePointer image = decoded_codestream(position);
  if (image == nullptr || image->numcomps != 1 || image->comps[0].data == nullptr) {
    return false;
  }
  const opj_image_comp_t& samples = image->comps[0];
  if (samples.w != frame.columns || samples.h != frame.rows || samples.prec != frame.bits) {
    return false;
  }
  const std::size_t count = frame.columns * frame.rows;
  if (frame.sample_bytes() == 1) {
    copy_samples<std::uint8_t>(samples.data, count, to);
  } else if (frame.sample_bytes() == 2) {
    copy_samples<std::uint16_t>(samples.data, count, to);
  } else {
    copy_samples<std::uint32_t>(samples.data, count, to);
  }
  return true;
}

// Each segment holds one byte of every sample, the most significant first.
bool decode_run_lengths(std::string_view stream, const FrameSize& frame, char* to) {
  constexpr std::size_t kHeader = 64;
  const std::size_t sample_bytes = frame.sample_bytes(), count = frame.columns * frame.rows;
  std::array<std::uint32_t, 16> header{};
  if (stream.size() < kHeader) {
    return false;
  }
  std::memcpy(header.data(), stream.data(), kHeader);
  if (header[0] != sample_bytes) {
    return false;
  }
  for (std::size_t segment = 0; segment < sample_bytes; ++segment) {
    const std::size_t start = header[1 + segment];
    const std::size_t end = segment + 1 < sample_bytes ? header[2 + segment] : stream.size();
    if (start < kHeader || start > end || end > stream.size() ||
        !decode_runs(stream.substr(start, end - start), to + (sample_bytes - 1 - segment), count,
                     sample_bytes)) {
      return false;
    }
  }
  return true;
}

std::string jpeg_decoder_name() { return "DCMTK " PACKAGE_VERSION; }
std::string jpeg_ls_decoder_name() { return std::string("CharLS ") + charls_get_version_string(); }
std::string jpeg_2000_decoder_name() { return std::string("OpenJPEG ") + opj_version(); }

}  // namespace isoatlas::detail::io
