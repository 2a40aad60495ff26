// SPDX-License-Identifier: Apache-2.0
// The VTK filter, in VTK's pipeline. VTK's own filters check the meshes.
#include "isoatlas/vtkIsoAtlas.h"

#include <gtest/gtest.h>
#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkCompositeDataSet.h>
#include <vtkExecutive.h>
#include <vtkFeatureEdges.h>
#include <vtkFieldData.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMassProperties.h>
#include <vtkMath.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedShortArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "isoatlas/extract.h"

namespace {

/// Positive inside a ball around the index `center`.
vtkNew<vtkImageData> ball(int type, double radius, const std::array<int, 6>& extent,
                          const std::array<double, 3>& center) {
  vtkNew<vtkImageData> image;
  image->SetExtent(const_cast<int*>(extent.data()));
  image->AllocateScalars(type, 1);
  for (int k = extent[4]; k <= extent[5]; ++k)
    for (int j = extent[2]; j <= extent[3]; ++j)
      for (int i = extent[0]; i <= extent[1]; ++i)
        image->SetScalarComponentFromDouble(
            i, j, k, 0,
            50 + 4 * (radius - std::hypot(i - center[0], j - center[1], k - center[2])));
  return image;
}

vtkNew<vtkImageData> ball(int type = VTK_DOUBLE) {
  return ball(type, 6, {0, 20, 0, 19, 0, 17}, {10.2, 9.1, 8.3});
}

vtkPolyData* level(vtkIsoAtlas* filter, unsigned int number) {
  return vtkPolyData::SafeDownCast(filter->GetOutput()->GetPartition(number, 0));
}

vtkPolyData* finest(vtkIsoAtlas* filter) {
  const unsigned int count = filter->GetOutput()->GetNumberOfPartitionedDataSets();
  return count == 0 ? nullptr : level(filter, count - 1);
}

double fact(vtkPolyData* mesh, const char* name) {
  vtkDataArray* array = mesh->GetFieldData()->GetArray(name);
  return array == nullptr ? std::numeric_limits<double>::quiet_NaN() : array->GetTuple1(0);
}

double volume(vtkPolyData* mesh) {
  vtkNew<vtkMassProperties> mass;
  mass->SetInputData(mesh);
  return mass->GetVolume();
}

/// The volume from the orientation of the triangles: positive if they face outwards.
double oriented_volume(vtkPolyData* mesh) {
  double sum = 0;
  for (vtkIdType t = 0; t < mesh->GetNumberOfPolys(); ++t) {
    vtkIdType count = 0;
    const vtkIdType* corner = nullptr;
    mesh->GetCellPoints(t, count, corner);
    std::array<std::array<double, 3>, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) mesh->GetPoint(corner[k], p[k].data());
    sum += vtkMath::Determinant3x3(p[0].data(), p[1].data(), p[2].data());
  }
  return sum / 6;
}

vtkIdType open_or_non_manifold_edges(vtkPolyData* mesh) {
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(mesh);
  edges->FeatureEdgesOff();
  edges->Update();
  return edges->GetOutput()->GetNumberOfCells();
}

/// Collects the text of VTK errors of a filter; they would be printed otherwise.
struct Errors {
  std::vector<std::string> texts;
  vtkNew<vtkCallbackCommand> command;

  explicit Errors(vtkIsoAtlas* filter) {
    command->SetClientData(this);
    command->SetCallback([](vtkObject*, unsigned long, void* self, void* text) {
      static_cast<Errors*>(self)->texts.emplace_back(static_cast<const char*>(text));
    });
    filter->AddObserver(vtkCommand::ErrorEvent, command);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, command);
  }
  bool contain(const std::string& part) const {
    for (const std::string& text : texts)
      if (text.find(part) != std::string::npos) return true;
    return false;
  }
};

TEST(VtkIsoAtlas, MeshesABallOfEveryType) {
  for (const int type :
       {VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_UNSIGNED_SHORT, VTK_INT,
        VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
        VTK_ID_TYPE, VTK_FLOAT, VTK_DOUBLE}) {
    vtkNew<vtkIsoAtlas> filter;
    filter->SetInputData(ball(type));
    filter->SetIsoValue(49.5);
    filter->SetMaxDistance(0.2);
    filter->Update();
    vtkPolyData* mesh = finest(filter);
    ASSERT_NE(mesh, nullptr) << type;
    EXPECT_EQ(open_or_non_manifold_edges(mesh), 0) << type;
    EXPECT_EQ(fact(mesh, "genus"), 0);
    EXPECT_EQ(fact(mesh, "components"), 1);
    EXPECT_NEAR(volume(mesh), 4.0 / 3 * std::numbers::pi * 216, 80) << type;
    EXPECT_GT(oriented_volume(mesh), 0);
  }
}

TEST(VtkIsoAtlas, IsTheMeshOfTheLibrary) {
  vtkNew<vtkImageData> image = ball();
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetIsoValue(50);
  filter->AddCoarserLevel(2);
  filter->SetMaxDistance(0.4);
  filter->SetNormalAngle(25);
  filter->Update();

  isoatlas::VolumeView view;
  view.grid.size = isoatlas::Size3(21, 20, 18);
  view.type = isoatlas::SampleType::float64;
  view.samples = image->GetScalarPointer();
  using isoatlas::vx;
  const isoatlas::Extraction expected = isoatlas::extract(
      view, 50,
      {isoatlas::within(2 * vx),
       {isoatlas::within(0.4 * vx), isoatlas::bounded(isoatlas::Quantity::normal_angle, 25)}});
  ASSERT_EQ(filter->GetOutput()->GetNumberOfPartitionedDataSets(), 3);
  for (unsigned int k = 0; k < 3; ++k) {
    const isoatlas::MeshView theirs = expected.hierarchy.view(k);
    vtkPolyData* mesh = level(filter, k);
    ASSERT_EQ(mesh->GetNumberOfPoints(), static_cast<vtkIdType>(theirs.positions.size()));
    ASSERT_EQ(mesh->GetNumberOfPolys(), static_cast<vtkIdType>(theirs.triangles.size()));
    for (std::size_t i = 0; i < theirs.positions.size(); ++i) {
      double p[3];
      mesh->GetPoint(static_cast<vtkIdType>(i), p);
      EXPECT_EQ((isoatlas::Vec3{p[0], p[1], p[2]}), theirs.positions[i]);
    }
    for (std::size_t t = 0; t < theirs.triangles.size(); ++t) {
      vtkIdType count = 0;
      const vtkIdType* corners = nullptr;
      mesh->GetCellPoints(static_cast<vtkIdType>(t), count, corners);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(corners[c], static_cast<vtkIdType>(theirs.triangles[t][c]));
    }
  }
}

TEST(VtkIsoAtlas, NamesLevelsAndMeasuresDistances) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->AddCoarserLevel(1);
  filter->SetMaxDistance(0.25);
  filter->Update();
  vtkPartitionedDataSetCollection* levels = filter->GetOutput();
  ASSERT_EQ(levels->GetNumberOfPartitionedDataSets(), 3);
  EXPECT_LT(level(filter, 0)->GetNumberOfPolys(), level(filter, 2)->GetNumberOfPolys());
  for (unsigned int k = 0; k < 3; ++k)
    EXPECT_EQ(levels->GetMetaData(k)->Get(vtkCompositeDataSet::NAME()),
              "level " + std::to_string(k));
  vtkDataArray* distance = finest(filter)->GetPointData()->GetArray("max_distance");
  ASSERT_NE(distance, nullptr);
  EXPECT_LE(distance->GetRange()[1], 0.25);
  EXPECT_GT(distance->GetRange()[1], 0);
  EXPECT_LE(fact(finest(filter), "distance_at_most"), 0.2500001);
  EXPECT_STREQ(filter->GetViolations(), "");
}

// vtkFlyingEdges3D of VTK 9.1 has the same surface in physical coordinates.
TEST(VtkIsoAtlas, TakesExtentSpacingOriginAndDirection) {
  vtkNew<vtkImageData> image = ball(VTK_FLOAT, 6, {5, 25, -3, 16, 2, 19}, {15.2, 6.1, 10.3});
  image->SetSpacing(0.5, 0.7, 1.1);
  image->SetOrigin(100, -20, 3);
  const double c = std::cos(0.4), s = std::sin(0.4);
  image->SetDirectionMatrix(c, -s, 0, s, c, 0, 0, 0, 1);
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetIsoValue(50);
  filter->Update();
  vtkPolyData* mesh = finest(filter);
  ASSERT_NE(mesh, nullptr);
  double expected[3], center[3];
  image->TransformContinuousIndexToPhysicalPoint(15.2, 6.1, 10.3, expected);
  mesh->GetCenter(center);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(center[axis], expected[axis], 0.3);
  EXPECT_NEAR(oriented_volume(mesh), 4.0 / 3 * std::numbers::pi * 216 * 0.5 * 0.7 * 1.1, 40);

  vtkNew<vtkFlyingEdges3D> marching;
  marching->SetInputData(image);
  marching->SetValue(0, 50);
  marching->Update();
  double ours[6], theirs[6];
  mesh->GetBounds(ours);
  marching->GetOutput()->GetBounds(theirs);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(ours[i], theirs[i], 0.3) << i;
}

TEST(VtkIsoAtlas, AMirroredDirectionStillFacesOutwards) {
  vtkNew<vtkImageData> image = ball();
  image->SetDirectionMatrix(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetValue(0, 50);  // as VTK's contour filters
  filter->Update();
  EXPECT_GT(oriented_volume(finest(filter)), 500);
  EXPECT_LT(finest(filter)->GetCenter()[0], 0);
}

TEST(VtkIsoAtlas, ANegativeSpacingRunsBackwards) {
  vtkNew<vtkImageData> image = ball();
  image->SetSpacing(1, -1, 1);
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetIsoValue(50);
  filter->Update();
  ASSERT_NE(finest(filter), nullptr);
  EXPECT_NEAR(finest(filter)->GetCenter()[1], -9.1, 0.3);
  EXPECT_GT(oriented_volume(finest(filter)), 500);
}

TEST(VtkIsoAtlas, LengthsInWorldUnits) {
  vtkNew<vtkImageData> image = ball();
  image->SetSpacing(2, 2, 2);
  const auto points = [&](bool in_voxels, double distance) {
    vtkNew<vtkIsoAtlas> filter;
    filter->SetInputData(image);
    filter->SetIsoValue(50);
    filter->SetLengthsInVoxels(in_voxels);
    filter->SetMaxDistance(distance);
    filter->Update();
    return finest(filter)->GetNumberOfPoints();
  };
  EXPECT_EQ(points(true, 0.25), points(false, 0.5));
  EXPECT_GT(points(false, 0.25), points(false, 0.5));
}

TEST(VtkIsoAtlas, OtherProperties) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->SetInside(vtkIsoAtlas::BELOW);
  filter->Update();
  EXPECT_LT(oriented_volume(finest(filter)), 0);  // the ball is a cavity
  filter->SetInside(vtkIsoAtlas::ABOVE);
  filter->CoarseOnlyOn();
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPartitionedDataSets(), 1);
  const vtkIdType coarse = finest(filter)->GetNumberOfPoints();
  filter->CoarseOnlyOff();
  filter->SetMaxVertices(60);
  filter->SetMaxDistance(0.01);
  filter->Update();
  EXPECT_LE(finest(filter)->GetNumberOfPoints(), 60);
  EXPECT_GE(finest(filter)->GetNumberOfPoints(), coarse);
  EXPECT_NE(std::string(filter->GetViolations()).find("level 1: max-distance 0.01: reached"),
            std::string::npos)
      << filter->GetViolations();
}

/// Half a ball: the volume boundary cuts it in the middle.
vtkNew<vtkImageData> half_ball() {
  return ball(VTK_FLOAT, 6, {0, 20, 0, 19, 0, 9}, {10.2, 9.1, 0});
}

TEST(VtkIsoAtlas, ClosesTheMeshByCaps) {
  vtkNew<vtkImageData> image = half_ball();
  image->SetSpacing(0.5, 0.7, 1.1);
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetIsoValue(50);
  filter->SetMaxDistance(0.2);
  filter->Update();
  EXPECT_EQ(fact(finest(filter), "boundary_loops"), 1);
  EXPECT_EQ(finest(filter)->GetCellData()->GetArray("cap"), nullptr);

  filter->SetBorder(vtkIsoAtlas::CLOSED);
  filter->Update();
  EXPECT_NEAR(oriented_volume(finest(filter)), 2.0 / 3 * std::numbers::pi * 216 * 0.5 * 0.7 * 1.1,
              8);
  for (unsigned int k = 0; k < 2; ++k) {
    vtkPolyData* mesh = level(filter, k);
    EXPECT_EQ(open_or_non_manifold_edges(mesh), 0);
    EXPECT_EQ(fact(mesh, "boundary_loops"), 0);
    vtkDataArray* caps = mesh->GetCellData()->GetArray("cap");
    ASSERT_NE(caps, nullptr);
    for (vtkIdType t = 0; t < mesh->GetNumberOfPolys(); ++t) {
      double bounds[6];
      mesh->GetCellBounds(t, bounds);
      EXPECT_EQ(caps->GetTuple1(t), bounds[5] == 0 ? 1 : 0) << t;
    }
  }
}

TEST(VtkIsoAtlas, AWholeBallHasNoCaps) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->SetBorder(vtkIsoAtlas::CLOSED);
  filter->Update();
  vtkDataArray* caps = finest(filter)->GetCellData()->GetArray("cap");
  ASSERT_NE(caps, nullptr);
  EXPECT_EQ(caps->GetRange()[1], 0);
}

TEST(VtkIsoAtlas, LevelsAreALadder) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->SetLevels(3);
  filter->SetMaxDistance(0.1);
  filter->Update();
  ASSERT_EQ(filter->GetOutput()->GetNumberOfPartitionedDataSets(), 3u);
  for (unsigned int k = 0; k < 3; ++k)
    EXPECT_LE(level(filter, k)->GetPointData()->GetArray("max_distance")->GetRange()[1],
              0.4 / (1 << k) + 1e-6)
        << k;
  EXPECT_LT(level(filter, 0)->GetNumberOfPolys(), level(filter, 2)->GetNumberOfPolys());
}

// Bounds that 40 vertices cannot satisfy: each is reported as violated.
TEST(VtkIsoAtlas, EveryBoundIsPassedOn) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->SetAdaptiveSupersample(0);
  filter->SetMaxVertices(40);
  filter->SetMaxDistance(0.001);
  filter->SetMeanDistance(0.0001);
  filter->SetNormalAngle(0.5);
  filter->SetAreaCurvature(1.0001);
  filter->SetGeodesicRatio(1.0001);
  filter->SetMinVertices(1000);
  filter->SetMinEdge(50);
  filter->SetMaxEdge(0.1);
  filter->SetMinAspect(0.99);
  filter->Update();
  const std::string violations = filter->GetViolations();
  for (const std::string name :
       {"max-distance 0.001", "mean-distance 0.0001", "normal-angle 0.5", "area-curvature 1.0001",
        "geodesic-ratio 1.0001", "min-vertices 1000", "min-edge 50", "max-edge 0.1",
        "min-aspect 0.99"})
    EXPECT_NE(violations.find("level 1: " + name + ": reached"), std::string::npos) << name << "\n"
                                                                                    << violations;
  EXPECT_EQ(violations.find("level 1: max-vertices"), std::string::npos);
  EXPECT_LE(finest(filter)->GetNumberOfPoints(), 40);
}

TEST(VtkIsoAtlas, UpdatesOnlyWhenChanged) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->Update();
  const vtkMTimeType time = filter->GetOutput()->GetMTime();
  filter->SetIsoValue(50);
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetMTime(), time);
  filter->AddCoarserLevel(3);
  filter->Update();
  EXPECT_GT(filter->GetOutput()->GetMTime(), time);
  EXPECT_EQ(filter->GetNumberOfCoarserLevels(), 1);
  EXPECT_EQ(filter->GetCoarserLevel(0), 3);
  EXPECT_EQ(filter->GetCoarserLevel(1), 0);
  filter->RemoveAllCoarserLevels();
  EXPECT_EQ(filter->GetNumberOfCoarserLevels(), 0);
}

TEST(VtkIsoAtlas, ArrayIsChosen) {
  vtkNew<vtkImageData> image = ball();
  vtkNew<vtkUnsignedShortArray> other;
  other->SetName("other");
  other->SetNumberOfValues(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    other->SetValue(
        i, static_cast<unsigned short>(100 - image->GetPointData()->GetScalars()->GetTuple1(i)));
  image->GetPointData()->AddArray(other);
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "other");
  filter->SetIsoValue(50.5);
  filter->Update();
  EXPECT_LT(oriented_volume(finest(filter)), 0);  // low inside
}

struct Progress {
  std::vector<double> fractions;
  std::vector<std::string> stages;
  double abort_at = 2;

  static void on_event(vtkObject* caller, unsigned long, void* self, void* fraction) {
    auto& progress = *static_cast<Progress*>(self);
    auto* filter = vtkIsoAtlas::SafeDownCast(caller);
    progress.fractions.push_back(*static_cast<double*>(fraction));
    const char* stage = filter->GetProgressText();  // null in VTK's first event
    progress.stages.emplace_back(stage == nullptr ? "" : stage);
    if (progress.fractions.back() >= progress.abort_at) filter->AbortExecuteOn();
  }
};

void observe(vtkIsoAtlas* filter, Progress& progress) {
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(&Progress::on_event);
  command->SetClientData(&progress);
  filter->AddObserver(vtkCommand::ProgressEvent, command);
}

TEST(VtkIsoAtlas, Progress) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->SetMaxDistance(0.05);
  Progress progress;
  observe(filter, progress);
  filter->Update();
  EXPECT_GT(progress.fractions.size(), 5);
  EXPECT_TRUE(std::ranges::is_sorted(progress.fractions));
  EXPECT_EQ(progress.fractions.back(), 1);
  EXPECT_NE(std::ranges::find(progress.stages, "cover"), progress.stages.end());
  EXPECT_NE(std::ranges::find(progress.stages, "refine"), progress.stages.end());
}

TEST(VtkIsoAtlas, AbortEmptiesTheOutput) {
  vtkNew<vtkIsoAtlas> filter;
  Errors errors(filter);
  filter->SetInputData(ball());
  filter->SetIsoValue(50);
  filter->SetMaxDistance(0.01);
  Progress progress;
  progress.abort_at = 0.3;
  observe(filter, progress);
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPartitionedDataSets(), 0);
  EXPECT_TRUE(errors.texts.empty());
  EXPECT_LT(std::ranges::count_if(progress.fractions, [](double f) { return f > 0.9; }), 2);
  filter->AbortExecuteOff();
  filter->RemoveAllObservers();
  filter->SetMaxDistance(0.5);
  filter->Update();
  EXPECT_NE(finest(filter), nullptr);
}

TEST(VtkIsoAtlas, ErrorsAreOneLineAndEmptyTheOutput) {
  const auto expect_error = [](vtkImageData* image, double isovalue, const std::string& part) {
    vtkNew<vtkIsoAtlas> filter;
    Errors errors(filter);
    filter->SetInputData(image);
    filter->SetIsoValue(isovalue);
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPartitionedDataSets(), 0u) << part;
    EXPECT_TRUE(errors.contain(part))
        << part << ": " << (errors.texts.empty() ? "" : errors.texts[0]);
  };
  expect_error(ball(), 1000, "isovalue");
  vtkNew<vtkImageData> nan = ball();
  nan->SetScalarComponentFromDouble(3, 3, 3, 0, std::nan(""));
  expect_error(nan, 50, "choose a side with SetNonFinite()");
  vtkNew<vtkImageData> empty;
  empty->SetDimensions(5, 5, 5);
  expect_error(empty, 50, "no point scalars");
  vtkNew<vtkImageData> colors;
  colors->SetDimensions(5, 5, 5);
  colors->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  expect_error(colors, 50, "3 components, expected 1");
  vtkNew<vtkImageData> flat;
  flat->SetDimensions(5, 5, 1);
  flat->AllocateScalars(VTK_FLOAT, 1);
  expect_error(flat, 50, "samples");

  const auto expect_refused = [](auto set, const std::string& part) {
    vtkNew<vtkIsoAtlas> filter;
    Errors errors(filter);
    filter->SetInputData(ball());
    filter->SetIsoValue(50);
    set(filter.GetPointer());
    filter->Update();
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPartitionedDataSets(), 0u) << part;
    EXPECT_TRUE(errors.contain(part)) << part;
  };
  expect_refused([](vtkIsoAtlas* f) { f->SetLevels(2), f->CoarseOnlyOn(); },
                 "SetLevels() chooses all levels, expected it without CoarseOnly");
  expect_refused([](vtkIsoAtlas* f) { f->SetLevels(2), f->AddCoarserLevel(1); },
                 "SetLevels() chooses all levels, expected it without coarser levels");
  expect_refused([](vtkIsoAtlas* f) { f->SetLevels(2), f->SetNormalAngle(20); },
                 "a number of levels needs a bound on max-distance");
  expect_refused(
      [](vtkIsoAtlas* f) { f->SetBorder(vtkIsoAtlas::CLOSED), f->AllowSelfIntersectionsOn(); },
      "intersections");

  vtkNew<vtkIsoAtlas> filter;
  Errors errors(filter);
  filter->SetValue(1, 50);
  EXPECT_TRUE(errors.contain("contour 1: expected index 0"));
}

TEST(VtkIsoAtlas, NaNOnOneSide) {
  vtkNew<vtkImageData> image = ball();
  image->SetScalarComponentFromDouble(3, 3, 3, 0, std::nan(""));
  vtkNew<vtkIsoAtlas> filter;
  filter->SetInputData(image);
  filter->SetIsoValue(50);
  filter->SetNonFinite(vtkIsoAtlas::NAN_BELOW);
  filter->Update();
  EXPECT_EQ(fact(finest(filter), "components"), 1);
}

TEST(VtkIsoAtlas, PrintsItself) {
  vtkNew<vtkIsoAtlas> filter;
  filter->SetIsoValue(12.5);
  filter->AddCoarserLevel(4);
  std::ostringstream text;
  filter->Print(text);
  EXPECT_NE(text.str().find("Value: 12.5"), std::string::npos);
  EXPECT_NE(text.str().find("Coarser level: 4"), std::string::npos);
  EXPECT_NE(text.str().find("Border: open"), std::string::npos);
  EXPECT_NE(text.str().find("Levels: 0"), std::string::npos);
}

}  // namespace
