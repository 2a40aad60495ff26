// SPDX-License-Identifier: Apache-2.0
// All headers of the core library, CMake target isoatlas::isoatlas. To read and write files,
// include isoatlas/io.h.
#pragma once

#include "isoatlas/blocks.h"
#include "isoatlas/certificate.h"
#include "isoatlas/component_extents.h"
#include "isoatlas/error.h"
#include "isoatlas/extract.h"
#include "isoatlas/field.h"
#include "isoatlas/hierarchy.h"
#include "isoatlas/length_unit.h"
#include "isoatlas/mask_field.h"
#include "isoatlas/measure.h"
#include "isoatlas/mesh.h"
#include "isoatlas/normals.h"
#include "isoatlas/options.h"
#include "isoatlas/refine.h"
#include "isoatlas/report.h"
#include "isoatlas/run_control.h"
#include "isoatlas/self_intersections.h"
#include "isoatlas/version.h"
#include "isoatlas/volume.h"
