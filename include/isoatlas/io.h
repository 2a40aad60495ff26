// SPDX-License-Identifier: Apache-2.0
// Files in and out: volumes, meshes and text.
#pragma once

#include "isoatlas/mesh_file.h"
#include "isoatlas/text_file.h"
#include "isoatlas/volume_file.h"
