// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cover/covering.h"
#include "partition/certificate.h"

namespace isoatlas {

/// Checks the covering's partition and adds sites where the certificate fails, until it passes. Always ends: where every
/// c-vertex is a site the dual is the complex itself, which is simplicial.
///
/// @return the passed check, whose triangles are the mesh
/// @throws Error(internal) if a round adds nothing, which would be a bug
PartitionCheck certify_and_repair(const SurfaceComplex& complex, Covering& covering, CertificateReport& report, const RunControl& control);

}  // namespace isoatlas
