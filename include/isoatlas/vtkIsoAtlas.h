// SPDX-License-Identifier: Apache-2.0
// isoatlas as a VTK filter. CMake target isoatlas::vtk.
#pragma once

#include <string>
#include <vector>

#include <vtkPartitionedDataSetCollectionAlgorithm.h>

#include "isoatlas/export.h"

/// Meshes an isosurface of a vtkImageData as adaptive triangle meshes in nested levels of detail,
/// with certified topology. Users of vtkFlyingEdges3D replace one class name; the triangles are in
/// the last partition of the output.
///
/// Input: a vtkImageData with a scalar array of any integer or floating-point type on its points,
/// chosen with SetInputArrayToProcess(); default: the active scalars. Spacing, origin, extent and
/// direction matrix are taken into account.
///
/// Output: a vtkPartitionedDataSetCollection with one partitioned data set per level, coarsest
/// first, named "level 0", "level 1", ... Each has one vtkPolyData with N points (double, in the
/// coordinates of the image) and T triangles, counter-clockwise seen from outside. In refined
/// levels the point array "max_distance" (N floats) has, per point, the largest two-sided distance
/// between isosurface and mesh near it. If the mesh is closed by caps, the cell array "cap" (T
/// unsigned chars) is 1 on the caps, as in .vtp files; 0 elsewhere. The field data has single
/// values: "components", "genus", "boundary_loops", and "distance_at_most", a proved bound of the
/// distance, if there is one.
///
/// Errors are VTK errors of one line (vtkErrorMacro); the output is then empty, and Update() does
/// not throw. A violated bound is not an error, see GetViolations(). Cost: as isoatlas::extract().
///
/// Progress: events with the fraction of the whole; GetProgressText() is the stage. SetAbortExecute
/// in an observer of ProgressEvent, or from another thread, ends the run with an empty output.
class ISOATLAS_API vtkIsoAtlas : public vtkPartitionedDataSetCollectionAlgorithm {
 public:
  static vtkIsoAtlas* New();
  // clang-format off
  vtkTypeMacro(vtkIsoAtlas, vtkPartitionedDataSetCollectionAlgorithm)
      // clang-format on
      void PrintSelf(std::ostream& os, vtkIndent indent) override;

  /// The image. Use SetInputConnection() for a pipeline.
  void SetInputData(vtkDataObject* image) { this->SetInputDataObject(0, image); }

  enum SideType { ABOVE, BELOW };
  enum NonFiniteType { REFUSE, NAN_BELOW, NAN_ABOVE };
  enum TopologyType { TRILINEAR_TOPOLOGY, FACES };
  enum InterpolationType { TRILINEAR, TRICUBIC };
  enum PlacementType { SURFACE, BALANCED };
  enum BorderType { OPEN, CLOSED };

  /// The isovalue. Default: 0. For integer samples use a value between two integers. SetIsoValue()
  /// is another name; SetValue(0, x) is that of VTK's contour filters.
  vtkSetMacro(Value, double);
  vtkGetMacro(Value, double);
  void SetIsoValue(double value) { this->SetValue(value); }
  double GetIsoValue() const { return this->Value; }
  /// @param index  0; other contours are refused with an error
  void SetValue(int index, double value);

  /// The side of the isovalue that is inside: ABOVE (default) or BELOW. A sample equal to the
  /// isovalue is inside.
  vtkSetClampMacro(Inside, int, ABOVE, BELOW);
  vtkGetMacro(Inside, int);
  /// The side on which NaN samples are. Default REFUSE: NaN or an infinite sample is an error.
  vtkSetClampMacro(NonFinite, int, REFUSE, NAN_ABOVE);
  vtkGetMacro(NonFinite, int);
  /// Topology inside a grid cell. Default: that of the trilinear interpolant.
  vtkSetClampMacro(Topology, int, TRILINEAR_TOPOLOGY, FACES);
  vtkGetMacro(Topology, int);
  /// Interpolation between samples. Default: TRILINEAR.
  vtkSetClampMacro(Interpolation, int, TRILINEAR, TRICUBIC);
  vtkGetMacro(Interpolation, int);
  /// Mesh the image upsampled by this factor along each axis. Default: 1.
  vtkSetClampMacro(Supersample, int, 1, VTK_INT_MAX);
  vtkGetMacro(Supersample, int);
  /// Upper limit, per level, on how often the surface is subdivided where a bound cannot be
  /// satisfied otherwise, 0 to 8. Default: 6.
  vtkSetClampMacro(AdaptiveSupersample, int, 0, 8);
  vtkGetMacro(AdaptiveSupersample, int);

  /// Keep only this number of largest components; 0 (default): all.
  vtkSetClampMacro(KeepComponents, int, 0, VTK_INT_MAX);
  vtkGetMacro(KeepComponents, int);
  /// Drop components that enclose a smaller volume, in world units cubed. Default: 0.
  vtkSetMacro(MinComponentSize, double);
  vtkGetMacro(MinComponentSize, double);

  /// The mesh where the volume boundary cuts the surface: it ends there (OPEN, default), or planar
  /// caps on the volume boundary close it (CLOSED), as if everything beyond were outside. CLOSED
  /// with AllowSelfIntersections is an error.
  vtkSetClampMacro(Border, int, OPEN, CLOSED);
  vtkGetMacro(Border, int);

  /// Unit of MaxDistance, MeanDistance, MinEdge, MaxEdge and of the coarser levels: on, voxels (the
  /// smallest spacing of the image); off, world units. Default: on.
  vtkSetMacro(LengthsInVoxels, bool);
  vtkGetMacro(LengthsInVoxels, bool);
  vtkBooleanMacro(LengthsInVoxels, bool);

  // Bounds of the finest level; 0: none. If they contradict each other, earlier ones in this list
  // have priority.
  vtkSetClampMacro(MaxVertices, int, 0, VTK_INT_MAX);
  vtkGetMacro(MaxVertices, int);
  /// Upper bound of the two-sided (Hausdorff) distance between surface and mesh. Default: 0. If no
  /// other error bound is set either, the distance is then within half a voxel, or within an eighth
  /// of the largest spacing if that is more.
  vtkSetMacro(MaxDistance, double);
  vtkGetMacro(MaxDistance, double);
  vtkSetMacro(MeanDistance, double);
  vtkGetMacro(MeanDistance, double);
  vtkSetMacro(NormalAngle, double);  ///< degrees
  vtkGetMacro(NormalAngle, double);
  vtkSetMacro(AreaCurvature, double);  ///< ratio above 1
  vtkGetMacro(AreaCurvature, double);
  vtkSetMacro(GeodesicRatio, double);  ///< ratio above 1
  vtkGetMacro(GeodesicRatio, double);
  vtkSetClampMacro(MinVertices, int, 0, VTK_INT_MAX);
  vtkGetMacro(MinVertices, int);
  vtkSetMacro(MinEdge, double);
  vtkGetMacro(MinEdge, double);
  vtkSetMacro(MaxEdge, double);
  vtkGetMacro(MaxEdge, double);
  vtkSetMacro(MinAspect, double);  ///< shortest edge of a triangle / longest, between 0 and 1
  vtkGetMacro(MinAspect, double);

  /// Number of levels, 1 to 16, whose bounds are chosen: the finest has MaxDistance, each coarser
  /// one twice the bound of the next, or less, so that the coarsest keeps a recognisable shape. All
  /// other bounds hold in every level, and the coarse mesh is not one of them. 0 (default): the
  /// coarse mesh, the coarser levels that were added, and the finest. A number with
  /// AddCoarserLevel() or CoarseOnly is an error.
  vtkSetClampMacro(Levels, int, 0, 16);
  vtkGetMacro(Levels, int);
  /// Adds a level that is coarser than the finest one, with an upper bound of its two-sided
  /// distance. Levels are in the order of the calls: largest distance first.
  void AddCoarserLevel(double maxDistance);
  void RemoveAllCoarserLevels();
  int GetNumberOfCoarserLevels() const { return static_cast<int>(this->CoarserLevels.size()); }
  double GetCoarserLevel(int index) const;
  /// Make only level 0, the coarsest mesh that preserves the topology. Default: off.
  vtkSetMacro(CoarseOnly, bool);
  vtkGetMacro(CoarseOnly, bool);
  vtkBooleanMacro(CoarseOnly, bool);

  /// Where vertices are placed: on the isosurface (default), or displaced so that the mesh lies
  /// evenly on both sides of it.
  vtkSetClampMacro(Placement, int, SURFACE, BALANCED);
  vtkGetMacro(Placement, int);
  /// Keep triangles that intersect: faster, and fewer triangles. Default: off.
  vtkSetMacro(AllowSelfIntersections, bool);
  vtkGetMacro(AllowSelfIntersections, bool);
  vtkBooleanMacro(AllowSelfIntersections, bool);
  /// Number of threads; 0 (default): as many as the machine has. The result does not depend on it.
  vtkSetClampMacro(NumberOfThreads, int, 0, VTK_INT_MAX);
  vtkGetMacro(NumberOfThreads, int);

  /// After Update(): one line for each bound that a level violates, with the reason; empty if all
  /// are satisfied.
  const char* GetViolations() const { return this->Violations.c_str(); }

  vtkIsoAtlas(const vtkIsoAtlas&) = delete;
  void operator=(const vtkIsoAtlas&) = delete;

 protected:
  vtkIsoAtlas();
  ~vtkIsoAtlas() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                          vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

 private:
  double Value = 0;
  int Inside = ABOVE, NonFinite = REFUSE;
  int Topology = TRILINEAR_TOPOLOGY, Interpolation = TRILINEAR;
  int Supersample = 1, AdaptiveSupersample = 6;
  int KeepComponents = 0;
  double MinComponentSize = 0;
  bool LengthsInVoxels = true;
  int MaxVertices = 0, MinVertices = 0;
  double MaxDistance = 0, MeanDistance = 0, NormalAngle = 0, AreaCurvature = 0, GeodesicRatio = 0;
  double MinEdge = 0, MaxEdge = 0, MinAspect = 0;
  int Border = OPEN;
  int Levels = 0;
  std::vector<double> CoarserLevels;
  bool CoarseOnly = false;
  int Placement = SURFACE;
  bool AllowSelfIntersections = false;
  int NumberOfThreads = 0;
  std::string Violations;

  struct Run;  // the run of RequestData()
};
