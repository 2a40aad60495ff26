// SPDX-License-Identifier: Apache-2.0
#include "isoatlas/vtkIsoAtlas.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkLongLongArray.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <sstream>

#include "isoatlas/error.h"
#include "isoatlas/extract.h"

vtkStandardNewMacro(vtkIsoAtlas);

namespace {

using isoatlas::Error;
using isoatlas::ErrorCode;
using isoatlas::Quantity;

/// The sample type of a VTK array type; none: it has none. The size of `long` and `char` depends on
/// the platform.
std::optional<isoatlas::SampleType> sample_type(vtkDataArray* array) {
  const auto integer = [&](bool is_signed) -> std::optional<isoatlas::SampleType> {
    using isoatlas::SampleType;
    switch (array->GetDataTypeSize()) {
      case 1:
        return is_signed ? SampleType::int8 : SampleType::uint8;
      case 2:
        return is_signed ? SampleType::int16 : SampleType::uint16;
      case 4:
        return is_signed ? SampleType::int32 : SampleType::uint32;
      case 8:
        return is_signed ? SampleType::int64 : SampleType::uint64;
      default:
        return std::nullopt;
    }
  };
  switch (array->GetDataType()) {
    case VTK_FLOAT:
      return isoatlas::SampleType::float32;
    case VTK_DOUBLE:
      return isoatlas::SampleType::float64;
    case VTK_CHAR:
      return integer(std::is_signed_v<char>);
    case VTK_SIGNED_CHAR:
    case VTK_SHORT:
    case VTK_INT:
    case VTK_LONG:
    case VTK_LONG_LONG:
    case VTK_ID_TYPE:
      return integer(true);
    case VTK_UNSIGNED_CHAR:
    case VTK_UNSIGNED_SHORT:
    case VTK_UNSIGNED_INT:
    case VTK_UNSIGNED_LONG:
    case VTK_UNSIGNED_LONG_LONG:
      return integer(false);
    default:
      return std::nullopt;
  }
}

/// The grid of the image's points. VTK allows a negative spacing: the axis then runs backwards.
isoatlas::Grid grid_of(vtkImageData* image) {
  isoatlas::Grid grid;
  const int* extent = image->GetExtent();
  double origin[3];
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], origin);
  grid.origin = {origin[0], origin[1], origin[2]};
  int size[3];
  image->GetDimensions(size);
  grid.size = isoatlas::Size3(size[0], size[1], size[2]);
  const double* spacing = image->GetSpacing();
  grid.spacing = {std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2])};
  const vtkMatrix3x3* matrix = image->GetDirectionMatrix();
  for (int axis = 0; axis < 3; ++axis) {
    const double sign = spacing[axis] < 0 ? -1 : 1;
    grid.direction[static_cast<std::size_t>(axis)] = {sign * matrix->GetElement(0, axis),
                                                      sign * matrix->GetElement(1, axis),
                                                      sign * matrix->GetElement(2, axis)};
  }
  return grid;
}

isoatlas::VolumeView view_of(vtkImageData* image, vtkDataArray* samples) {
  const auto refuse = [](const std::string& problem) {
    throw Error(ErrorCode::unsupported, problem);
  };
  const std::string name =
      samples != nullptr && samples->GetName() != nullptr ? samples->GetName() : "";
  if (samples == nullptr)
    refuse("the image has no point scalars, expected an array; see SetInputArrayToProcess()");
  if (samples->GetNumberOfComponents() != 1)
    refuse("the array '" + name + "' has " + std::to_string(samples->GetNumberOfComponents()) +
           " components, expected 1");
  if (samples->GetNumberOfTuples() != image->GetNumberOfPoints())
    refuse("the array '" + name + "' has " + std::to_string(samples->GetNumberOfTuples()) +
           " values for " + std::to_string(image->GetNumberOfPoints()) +
           " points, expected an array of the points");
  const auto type = sample_type(samples);
  if (!type || !samples->HasStandardMemoryLayout())
    refuse("the array '" + name + "' has values of type " + samples->GetDataTypeAsString() +
           ", expected integers or floating-point numbers, one after the other in memory");
  isoatlas::VolumeView view;
  view.grid = grid_of(image);
  view.type = *type;
  view.samples = samples->GetVoidPointer(0);
  return view;
}

void add_number(vtkFieldData* data, const char* name, long long value) {
  vtkNew<vtkLongLongArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  data->AddArray(array);
}

void add_number(vtkFieldData* data, const char* name, double value) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  data->AddArray(array);
}

void fill_points(vtkPolyData* mesh, const isoatlas::MeshView& view) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(view.positions.size()));
  for (std::size_t i = 0; i < view.positions.size(); ++i) {
    const isoatlas::Vec3& p = view.positions[i];
    points->SetPoint(static_cast<vtkIdType>(i), p.x, p.y, p.z);
  }
  mesh->SetPoints(points);
}

void fill_triangles(vtkPolyData* mesh, const isoatlas::MeshView& view) {
  const auto count = static_cast<vtkIdType>(view.triangles.size());
  vtkNew<vtkIdTypeArray> offsets, corners;
  offsets->SetNumberOfValues(count + 1);
  corners->SetNumberOfValues(3 * count);
  for (vtkIdType t = 0; t <= count; ++t) offsets->SetValue(t, 3 * t);
  for (vtkIdType t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k)
      corners->SetValue(
          3 * t + k, static_cast<vtkIdType>(
                         view.triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]));
  }
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, corners);
  mesh->SetPolys(cells);
}

/// Marks the caps, which are the last triangles.
void mark_caps(vtkPolyData* mesh, std::size_t cap_count) {
  const vtkIdType count = mesh->GetNumberOfPolys();
  const vtkIdType first_cap = count - static_cast<vtkIdType>(cap_count);
  vtkNew<vtkUnsignedCharArray> caps;
  caps->SetName("cap");
  caps->SetNumberOfValues(count);
  for (vtkIdType t = 0; t < count; ++t) caps->SetValue(t, t >= first_cap ? 1 : 0);
  mesh->GetCellData()->AddArray(caps);
}

vtkNew<vtkPolyData> poly_data(const isoatlas::Extraction& result, std::size_t level) {
  vtkNew<vtkPolyData> mesh;
  const isoatlas::MeshView view = result.hierarchy.view(level);
  fill_points(mesh, view);
  fill_triangles(mesh, view);
  const std::vector<float>& distance = result.hierarchy.levels[level].distance;
  if (!distance.empty()) {
    vtkNew<vtkFloatArray> array;
    array->SetName("max_distance");
    array->SetNumberOfValues(static_cast<vtkIdType>(distance.size()));
    std::ranges::copy(distance, array->GetPointer(0));
    mesh->GetPointData()->AddArray(array);
  }
  const isoatlas::LevelReport& report = result.report.levels[level];
  if (report.caps) mark_caps(mesh, report.caps->triangles);
  vtkFieldData* facts = mesh->GetFieldData();
  add_number(facts, "components", static_cast<long long>(report.topology.components));
  add_number(facts, "genus", static_cast<long long>(report.topology.genus));
  add_number(facts, "boundary_loops", static_cast<long long>(report.topology.boundary_loops));
  if (report.distance_at_most) add_number(facts, "distance_at_most", *report.distance_at_most);
  return mesh;
}

void fill_output(vtkPartitionedDataSetCollection* output, const isoatlas::Extraction& result) {
  const auto count = static_cast<unsigned int>(result.hierarchy.levels.size());
  output->SetNumberOfPartitionedDataSets(count);
  for (unsigned int k = 0; k < count; ++k) {
    vtkNew<vtkPartitionedDataSet> level;
    level->SetNumberOfPartitions(1);
    level->SetPartition(0, poly_data(result, k));
    output->SetPartitionedDataSet(k, level);
    output->GetMetaData(k)->Set(vtkCompositeDataSet::NAME(),
                                ("level " + std::to_string(k)).c_str());
  }
}

std::string violations_of(const isoatlas::ExtractReport& report) {
  std::ostringstream text;
  for (std::size_t k = 0; k < report.levels.size(); ++k) {
    for (const isoatlas::ConstraintResult& result : report.levels[k].constraints) {
      if (result.satisfied || result.constraint.is_default) continue;
      text << "level " << k << ": " << isoatlas::name(result.constraint) << " "
           << result.constraint.bound << ": reached " << result.reached
           << (result.reason.empty() ? "" : ": ") << result.reason << "\n";
    }
  }
  return text.str();
}

}  // namespace

struct vtkIsoAtlas::Run {
  vtkIsoAtlas& filter;
  std::atomic<bool> cancel{false};

  isoatlas::Length length(double value) const { return {value, filter.LengthsInVoxels}; }

  isoatlas::LevelGoal finest_goal() const {
    isoatlas::LevelGoal goal;
    const auto add = [&](Quantity quantity, isoatlas::Length bound) {
      if (bound.value != 0) goal.push_back(isoatlas::bounded(quantity, bound));
    };
    add(Quantity::max_vertices, filter.MaxVertices);
    add(Quantity::max_distance, length(filter.MaxDistance));
    add(Quantity::mean_distance, length(filter.MeanDistance));
    add(Quantity::normal_angle, filter.NormalAngle);
    add(Quantity::area_curvature, filter.AreaCurvature);
    add(Quantity::geodesic_ratio, filter.GeodesicRatio);
    add(Quantity::min_vertices, filter.MinVertices);
    add(Quantity::min_edge, length(filter.MinEdge));
    add(Quantity::max_edge, length(filter.MaxEdge));
    add(Quantity::min_aspect, filter.MinAspect);
    const bool has_metric = std::ranges::any_of(
        goal, [](const auto& constraint) { return isoatlas::is_metric(constraint.quantity); });
    if (!has_metric) goal.push_back(isoatlas::default_goal().front());
    return goal;
  }

  void check_levels() const {
    const char* other = filter.CoarseOnly               ? "CoarseOnly"
                        : !filter.CoarserLevels.empty() ? "coarser levels"
                                                        : nullptr;
    if (filter.Levels > 0 && other != nullptr)
      throw Error(ErrorCode::bad_argument,
                  "SetLevels() chooses all levels, expected it without " + std::string(other));
  }

  isoatlas::ExtractOptions options() const {
    using namespace isoatlas;
    check_levels();
    ExtractOptions options;
    options.surface.isovalue = filter.Value;
    options.surface.inside =
        filter.Inside == BELOW ? isoatlas::Inside::below : isoatlas::Inside::above;
    options.surface.non_finite = filter.NonFinite == NAN_BELOW   ? isoatlas::NonFinite::below
                                 : filter.NonFinite == NAN_ABOVE ? isoatlas::NonFinite::above
                                                                 : isoatlas::NonFinite::refuse;
    options.surface.topology =
        filter.Topology == FACES ? isoatlas::Topology::faces : isoatlas::Topology::trilinear;
    options.surface.interpolation = filter.Interpolation == TRICUBIC
                                        ? isoatlas::Interpolation::tricubic
                                        : isoatlas::Interpolation::trilinear;
    options.supersample = static_cast<std::uint32_t>(filter.Supersample);
    options.adaptive_supersample = static_cast<std::uint32_t>(filter.AdaptiveSupersample);
    options.components.keep_largest = static_cast<std::size_t>(filter.KeepComponents);
    options.components.min_size = filter.MinComponentSize;
    options.placement =
        filter.Placement == BALANCED ? isoatlas::Placement::balanced : isoatlas::Placement::surface;
    options.border = filter.Border == CLOSED ? isoatlas::Border::closed : isoatlas::Border::open;
    options.levels = static_cast<std::uint32_t>(filter.Levels);
    options.allow_self_intersections = filter.AllowSelfIntersections;
    options.refine.clear();
    if (!filter.CoarseOnly) {
      for (const double distance : filter.CoarserLevels)
        options.refine.push_back(within(length(distance)));
      options.refine.push_back(finest_goal());
    }
    return options;
  }

  void report(std::string_view stage, double fraction) {
    filter.SetProgressText(std::string(stage).c_str());
    filter.UpdateProgress(fraction);
    if (filter.GetAbortExecute() != 0) cancel = true;
  }

  isoatlas::Extraction extract(vtkImageData* image, vtkDataArray* samples) {
    const isoatlas::RunControl control{
        .progress = [this](std::string_view stage, double fraction) { report(stage, fraction); },
        .cancel = &cancel,
        .threads = filter.NumberOfThreads};
    return isoatlas::extract(view_of(image, samples), options(), control);
  }
};

vtkIsoAtlas::vtkIsoAtlas() {
  this->SetNumberOfInputPorts(1);
  this->SetNumberOfOutputPorts(1);
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                               vtkDataSetAttributes::SCALARS);
}

void vtkIsoAtlas::SetValue(int index, double value) {
  if (index != 0)
    vtkErrorMacro("contour " << index << ": expected index 0, one isovalue per filter");
  else
    this->SetValue(value);
}

void vtkIsoAtlas::AddCoarserLevel(double maxDistance) {
  this->CoarserLevels.push_back(maxDistance);
  this->Modified();
}

void vtkIsoAtlas::RemoveAllCoarserLevels() {
  this->CoarserLevels.clear();
  this->Modified();
}

double vtkIsoAtlas::GetCoarserLevel(int index) const {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < this->CoarserLevels.size() ? this->CoarserLevels[i] : 0;
}

int vtkIsoAtlas::FillInputPortInformation(int, vtkInformation* info) {
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkIsoAtlas::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                     vtkInformationVector*) {
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  int extent[6];
  info->Get(Pipeline::WHOLE_EXTENT(), extent);
  info->Set(Pipeline::UPDATE_EXTENT(), extent, 6);
  return 1;
}

int vtkIsoAtlas::RequestData(vtkInformation*, vtkInformationVector** inputs,
                             vtkInformationVector* outputs) {
  vtkImageData* image = vtkImageData::GetData(inputs[0]);
  auto* output = vtkPartitionedDataSetCollection::GetData(outputs);
  output->Initialize();
  this->Violations.clear();
  Run run{*this};
  try {
    const isoatlas::Extraction result = run.extract(image, this->GetInputArrayToProcess(0, inputs));
    fill_output(output, result);
    this->Violations = violations_of(result.report);
    return 1;
  } catch (const Error& error) {
    output->Initialize();
    if (error.code() == ErrorCode::cancelled) return 1;
    const bool is_nan = error.remedy() == isoatlas::Remedy::place_nan;
    vtkErrorMacro(<< (is_nan ? error.problem() + ": choose a side with SetNonFinite()"
                             : std::string(error.what())));
  } catch (const std::exception& error) {
    output->Initialize();
    vtkErrorMacro(<< error.what());
  }
  return 0;
}

void vtkIsoAtlas::PrintSelf(std::ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Value: " << this->Value << "\n"
     << indent << "Inside: " << (this->Inside == BELOW ? "below" : "above") << "\n"
     << indent << "Non-finite samples: "
     << (this->NonFinite == REFUSE      ? "refuse"
         : this->NonFinite == NAN_BELOW ? "below"
                                        : "above")
     << "\n"
     << indent << "Topology: " << (this->Topology == FACES ? "faces" : "trilinear") << "\n"
     << indent << "Interpolation: " << (this->Interpolation == TRICUBIC ? "tricubic" : "trilinear")
     << "\n"
     << indent << "Supersample: " << this->Supersample << "\n"
     << indent << "Adaptive supersample: " << this->AdaptiveSupersample << "\n"
     << indent << "Keep components: " << this->KeepComponents << "\n"
     << indent << "Min component size: " << this->MinComponentSize << "\n"
     << indent << "Border: " << (this->Border == CLOSED ? "closed" : "open") << "\n"
     << indent << "Lengths in voxels: " << (this->LengthsInVoxels ? "on" : "off") << "\n"
     << indent << "Max vertices: " << this->MaxVertices << "\n"
     << indent << "Max distance: " << this->MaxDistance << "\n"
     << indent << "Mean distance: " << this->MeanDistance << "\n"
     << indent << "Normal angle: " << this->NormalAngle << "\n"
     << indent << "Area curvature: " << this->AreaCurvature << "\n"
     << indent << "Geodesic ratio: " << this->GeodesicRatio << "\n"
     << indent << "Min vertices: " << this->MinVertices << "\n"
     << indent << "Min edge: " << this->MinEdge << "\n"
     << indent << "Max edge: " << this->MaxEdge << "\n"
     << indent << "Min aspect: " << this->MinAspect << "\n"
     << indent << "Levels: " << this->Levels << "\n"
     << indent << "Coarse only: " << (this->CoarseOnly ? "on" : "off") << "\n";
  for (const double distance : this->CoarserLevels)
    os << indent << "Coarser level: " << distance << "\n";
  os << indent << "Placement: " << (this->Placement == BALANCED ? "balanced" : "surface") << "\n"
     << indent << "Allow self-intersections: " << (this->AllowSelfIntersections ? "on" : "off")
     << "\n"
     << indent << "Number of threads: " << this->NumberOfThreads << "\n";
}
