// SPDX-License-Identifier: Apache-2.0
// The VTK filter vtkIsoAtlas in a pipeline: three levels of detail of a smooth field.
#include <isoatlas/vtkIsoAtlas.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPolyData.h>
#include <vtkRTAnalyticSource.h>

#include <iostream>

int main() {
  vtkNew<vtkRTAnalyticSource> wavelet;
  wavelet->SetWholeExtent(-20, 20, -20, 20, -20, 20);

  vtkNew<vtkIsoAtlas> surface;
  surface->SetInputConnection(wavelet->GetOutputPort());
  surface->SetIsoValue(157.5);
  surface->AddCoarserLevel(1);    // a level within one voxel
  surface->SetMaxDistance(0.25);  // the finest level
  surface->Update();

  vtkPartitionedDataSetCollection* levels = surface->GetOutput();
  for (unsigned int k = 0; k < levels->GetNumberOfPartitionedDataSets(); ++k) {
    auto* mesh = vtkPolyData::SafeDownCast(levels->GetPartition(k, 0));
    vtkFieldData* facts = mesh->GetFieldData();
    std::cout << "level " << k << ": " << mesh->GetNumberOfPolys() << " triangles, "
              << *facts->GetArray("components")->GetTuple(0) << " components\n";
  }
}
