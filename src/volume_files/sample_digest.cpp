// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "field/dense_volume.h"
#include "files/sha256.h"
#include "isoatlas/volume_file.h"

namespace isoatlas {

static_assert(std::endian::native == std::endian::little, "the digest is of little-endian samples");

std::string sample_digest(const VolumeView& any_volume) {
  const Volume volume = detail::dense_volume(any_volume);
  detail::io::Sha256 digest;
  digest.add(volume.view.samples,
             volume.view.grid.sample_count() * bytes_per_sample(volume.view.type));
  return digest.digits();
}

}  // namespace isoatlas
