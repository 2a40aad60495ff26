// SPDX-License-Identifier: Apache-2.0
// All headers of the library that reads and writes volumes, meshes, reports and text files: CMake
// target isoatlas::io.
#pragma once

#include "isoatlas/block_file.h"
#include "isoatlas/json.h"
#include "isoatlas/mesh_file.h"
#include "isoatlas/neuroglancer.h"
#include "isoatlas/text_file.h"
#include "isoatlas/volume_file.h"
#include "isoatlas/volume_reader.h"
