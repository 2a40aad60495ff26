// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

#include "isoatlas/volume.h"

namespace isoatlas::detail::bench {

inline int vtk_type(isoatlas::SampleType type) {
  using enum isoatlas::SampleType;
  switch (type) {
    case int8:
      return VTK_SIGNED_CHAR;
    case uint8:
      return VTK_UNSIGNED_CHAR;
    case int16:
      return VTK_SHORT;
    case uint16:
      return VTK_UNSIGNED_SHORT;
    case int32:
      return VTK_INT;
    case uint32:
      return VTK_UNSIGNED_INT;
    case int64:
      return VTK_LONG_LONG;
    case uint64:
      return VTK_UNSIGNED_LONG_LONG;
    case float32:
      return VTK_FLOAT;
    case float64:
      return VTK_DOUBLE;
  }
  return VTK_VOID;
}

/// The volume as a VTK image that uses the same samples, in coordinates of index times spacing.
inline vtkSmartPointer<vtkImageData> vtk_image(const isoatlas::VolumeView& volume) {
  const auto& grid = volume.grid;
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(static_cast<int>(grid.size[0]), static_cast<int>(grid.size[1]),
                       static_cast<int>(grid.size[2]));
  image->SetSpacing(grid.spacing.x, grid.spacing.y, grid.spacing.z);
  vtkSmartPointer<vtkDataArray> scalars;
  scalars.TakeReference(vtkDataArray::CreateDataArray(vtk_type(volume.type)));
  scalars->SetVoidArray(const_cast<void*>(volume.samples),
                        static_cast<vtkIdType>(grid.sample_count()), 1);
  image->GetPointData()->SetScalars(scalars);
  return image;
}

}  // namespace isoatlas::detail::bench
