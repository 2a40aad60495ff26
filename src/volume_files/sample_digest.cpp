// SPDX-License-Identifier: Apache-2.0
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <new>
#include <string>

#include "field/dense_volume.h"
#include "isoatlas/volume_file.h"

namespace isoatlas {

static_assert(std::endian::native == std::endian::little, "the digest is of little-endian samples");

std::string sample_digest(const VolumeView& any_volume) {
  const Volume volume = detail::dense_volume(any_volume);
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context(EVP_MD_CTX_new(),
                                                                   EVP_MD_CTX_free);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned digest_bytes = 0;
  const std::size_t bytes = volume.view.grid.sample_count() * bytes_per_sample(volume.view.type);
  if (!context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1 ||
      EVP_DigestUpdate(context.get(), volume.view.samples, bytes) != 1 ||
      EVP_DigestFinal_ex(context.get(), digest.data(), &digest_bytes) != 1) {
    throw std::bad_alloc();
  }
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (unsigned i = 0; i < digest_bytes; ++i) {
    text += kDigits[digest[i] >> 4U];
    text += kDigits[digest[i] & 15U];
  }
  return text;
}

}  // namespace isoatlas
