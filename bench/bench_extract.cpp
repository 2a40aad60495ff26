// SPDX-License-Identifier: Apache-2.0
// bench_extract VOLUME ISOVALUE [REPEATS] : one JSON line with the CPU time of isoatlas and of VTK's contour filters on the same
// samples, in the same process, one thread each, best of REPEATS taken in turns.
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>

#include "isoatlas/extract.h"
#include "isoatlas/io.h"

namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

int vtk_type(isoatlas::SampleType type) {
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

// The whole job of a contour filter without normals and scalars, which isoatlas does not compute either.
template <class Filter>
double contour(vtkImageData* image, double isovalue, long long& triangles) {
  const double start = cpu_seconds();
  vtkNew<Filter> filter;
  filter->SetInputData(image);
  filter->SetValue(0, isovalue);
  filter->ComputeNormalsOff();
  filter->ComputeGradientsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  triangles = filter->GetOutput()->GetNumberOfPolys();
  return cpu_seconds() - start;
}

constexpr double kEnoughSeconds = 20;  // no more repetitions after that

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: bench_extract VOLUME ISOVALUE [REPEATS]\n");
    return 2;
  }
  const double isovalue = std::atof(argv[2]);
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 3;
  const isoatlas::Volume volume = isoatlas::read_volume(argv[1]);

  setenv("VTK_SMP_MAX_THREADS", "1", 1);  // vtkSMPTools.h of VTK 9.1 does not compile as C++20
  const auto& grid = volume.grid;
  vtkNew<vtkImageData> image;
  image->SetDimensions(static_cast<int>(grid.size[0]), static_cast<int>(grid.size[1]), static_cast<int>(grid.size[2]));
  image->SetSpacing(grid.spacing.x, grid.spacing.y, grid.spacing.z);
  vtkSmartPointer<vtkDataArray> scalars;
  scalars.TakeReference(vtkDataArray::CreateDataArray(vtk_type(volume.type)));
  scalars->SetVoidArray(const_cast<void*>(volume.samples), static_cast<vtkIdType>(grid.sample_count()), 1);
  image->GetPointData()->SetScalars(scalars);

  isoatlas::ExtractOptions options;
  options.isovalue = isovalue;
  isoatlas::RunControl control;
  control.threads = 1;

  double mc = 1e300, fe = 1e300, ours = 1e300, meeting = 1e300;
  long long mc_triangles = 0, fe_triangles = 0;
  isoatlas::ExtractReport report;
  std::size_t intersection_tracker = 0;
  const double began = cpu_seconds();
  for (int k = 0; k < repeats && (k == 0 || cpu_seconds() - began < kEnoughSeconds); ++k) {
    mc = std::min(mc, contour<vtkMarchingCubes>(image, isovalue, mc_triangles));
    fe = std::min(fe, contour<vtkFlyingEdges3D>(image, isovalue, fe_triangles));
    for (const bool allow : {true, false}) {
      options.allow_self_intersections = allow;
      const double start = cpu_seconds();
      const isoatlas::Extraction result = isoatlas::extract(volume, options, control);
      const double seconds = cpu_seconds() - start;
      if (allow) {
        meeting = std::min(meeting, seconds);
        intersection_tracker = result.finest().triangles;
      } else if (seconds < ours) {
        ours = seconds;
        report = result.report;
      }
    }
  }
  std::printf(
      "{\"mc_triangles\": %lld, \"fe_triangles\": %lld, \"mc_ms\": %.3f, \"fe_ms\": %.3f, \"isoatlas_ms\": %.3f, \"triangles\": %zu, "
      "\"meeting_ms\": %.3f, \"intersection_tracker\": %zu, \"stages_ms\": {",
      mc_triangles, fe_triangles, 1e3 * mc, 1e3 * fe, 1e3 * ours, report.levels.back().triangles, 1e3 * meeting, intersection_tracker);
  for (std::size_t i = 0; i < report.seconds.size(); ++i) {
    std::printf("%s\"%s\": %.3f", i == 0 ? "" : ", ", report.seconds[i].stage.c_str(), 1e3 * report.seconds[i].seconds);
  }
  std::printf("}}\n");
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_extract: %s\n", e.what());
  return 1;
}
