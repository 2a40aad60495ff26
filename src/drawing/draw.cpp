// SPDX-License-Identifier: Apache-2.0
#include "drawing/draw.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageAlgorithm.h>
#include <vtkImageData.h>
#include <vtkImageShrink3D.h>
#include <vtkJPEGWriter.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkRenderWindow.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/vector_math.h"
#include "drawing/display.h"
#include "drawing/shading.h"
#include "isoatlas/error.h"

namespace isoatlas::detail::drawing {
namespace {

// Pictures are drawn larger by this factor and then averaged, which smooths edges with any driver.
constexpr int kOversampling = 3;
constexpr int kLargestWindow = 16384;  // drivers draw nothing to larger windows
constexpr double kMargin = 1.06;
constexpr double kMinSine = 1e-6;  // of the angle between the view and the up direction
constexpr int kJpegQuality = 95;
constexpr double kSharpDegrees = 60;  // triangles that differ by more have a visible edge

struct Box {
  Vec3 middle;
  double radius = 0;  // of the ball around the box
};

Box box_of(const TriangleMesh& mesh) {
  Vec3 low = mesh.positions[mesh.triangles[0][0]], high = low;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      const Vec3 p = mesh.positions[v];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return {0.5 * low + 0.5 * high, std::max(0.5 * length(high - low), 1e-300)};
}

// The mesh moved to the origin and scaled to radius 1, so that float coordinates are precise.
TriangleMesh in_unit_ball(const TriangleMesh& mesh, const Box& box) {
  TriangleMesh out = mesh;
  for (Vec3& p : out.positions) p = (1 / box.radius) * (p - box.middle);
  return out;
}

vtkNew<vtkPoints> points_of(const TriangleMesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.positions.size()));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 at = mesh.positions[v];
    points->SetPoint(static_cast<vtkIdType>(v), at.x, at.y, at.z);
  }
  return points;
}

vtkNew<vtkPolyData> surface_of(const TriangleMesh& mesh) {
  vtkNew<vtkCellArray> triangles;
  for (const Triangle& t : mesh.triangles) triangles->InsertNextCell({t[0], t[1], t[2]});
  vtkNew<vtkPolyData> out;
  out->SetPoints(points_of(mesh));
  out->SetPolys(triangles);
  return out;
}

vtkNew<vtkPolyData> smooth_surface_of(const TriangleMesh& mesh) {
  const ShadedMesh shaded = split_at_sharp_edges(mesh, kSharpDegrees);
  vtkNew<vtkPolyData> out = surface_of(shaded.mesh);
  vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(static_cast<vtkIdType>(shaded.normals.size()));
  for (std::size_t v = 0; v < shaded.normals.size(); ++v) {
    const Vec3 normal = shaded.normals[v];
    normals->SetTuple3(static_cast<vtkIdType>(v), normal.x, normal.y, normal.z);
  }
  out->GetPointData()->SetNormals(normals);
  return out;
}

vtkNew<vtkPolyData> edges_of(const TriangleMesh& mesh, vtkPolyData& surface) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  vtkNew<vtkCellArray> lines;
  for (const auto& [a, b] : edges) lines->InsertNextCell({a, b});
  vtkNew<vtkPolyData> out;
  out->SetPoints(surface.GetPoints());
  out->SetLines(lines);
  return out;
}

void add_lights(vtkRenderer& renderer) {
  struct Lamp {
    double x, y, intensity;
  };
  renderer.RemoveAllLights();
  for (const Lamp& lamp : {Lamp{-0.5, 0.7, 0.85}, Lamp{0.9, 0.1, 0.3}, Lamp{0, -0.9, 0.2}}) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(lamp.x, lamp.y, 1);
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(lamp.intensity);
    renderer.AddLight(light);
  }
}

void require(bool good, const char* message) {
  if (!good) throw Error(ErrorCode::bad_argument, message);
}

Vec3 default_up(Vec3 towards, Vec3 front) {
  const Vec3 z{0, 0, 1};
  return length(cross(towards, z)) > kMinSine ? z : front;
}

/// The bytes of a file.
template <class Writer>
std::string encoded(Writer& writer, vtkImageAlgorithm& pixels) {
  writer.SetInputConnection(pixels.GetOutputPort());
  writer.WriteToMemoryOn();
  writer.Write();
  vtkUnsignedCharArray& bytes = *writer.GetResult();
  return {reinterpret_cast<const char*>(bytes.GetPointer(0)),
          static_cast<std::size_t>(bytes.GetNumberOfValues())};
}

}  // namespace

std::string draw(const TriangleMesh& mesh, const PictureOptions& options) {
  require(!mesh.triangles.empty(), "the mesh has no triangles to draw");
  for (const int pixels : {options.width, options.height})
    require(pixels >= 16 && pixels <= 8192, "a picture is 16 to 8192 pixels wide and high");
  require(options.zoom > 0 && std::isfinite(options.zoom),
          "the zoom of a picture must be positive");
  const Vec3 towards = normalized(options.view);
  const Vec3 upwards = options.up.value_or(default_up(towards, options.front));
  require(length(cross(towards, normalized(upwards))) > kMinSine,
          "the view and the up direction of a picture must not be zero or parallel");
  const int oversampling =
      std::min(kOversampling, kLargestWindow / std::max(options.width, options.height));
  const Display display;

  const TriangleMesh unit = in_unit_ball(mesh, box_of(mesh));
  const bool is_smooth = options.style == PictureStyle::smooth;
  const vtkNew<vtkPolyData> surface = is_smooth ? smooth_surface_of(unit) : surface_of(unit);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(surface);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  renderer->AddActor(actor);
  vtkProperty& look = *actor->GetProperty();
  vtkNew<vtkPolyData> edges;
  if (is_smooth) {
    look.SetColor(0.80, 0.79, 0.76);
    look.SetInterpolationToPhong();
    look.SetAmbient(0.12);
    look.SetSpecular(0.15);
    look.SetSpecularPower(20);
    add_lights(*renderer);
  } else {
    look.SetLighting(false);
    look.SetColor(1, 1, 1);
    mapper->SetResolveCoincidentTopologyToPolygonOffset();
    mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 2);
    edges->ShallowCopy(edges_of(unit, *surface));
    vtkNew<vtkPolyDataMapper> edge_mapper;
    edge_mapper->SetInputData(edges);
    vtkNew<vtkActor> edge_actor;
    edge_actor->SetMapper(edge_mapper);
    edge_actor->GetProperty()->SetLighting(false);
    edge_actor->GetProperty()->SetColor(0.10, 0.12, 0.15);
    edge_actor->GetProperty()->SetLineWidth(1.25f * static_cast<float>(oversampling));
    renderer->AddActor(edge_actor);
  }

  vtkCamera& camera = *renderer->GetActiveCamera();
  camera.SetFocalPoint(0, 0, 0);
  camera.SetPosition(10 * towards.x, 10 * towards.y, 10 * towards.z);
  camera.SetViewUp(upwards.x, upwards.y, upwards.z);
  camera.SetParallelProjection(true);
  // The scale at which every vertex is in the picture.
  const Vec3 right = normalized(cross(upwards, towards)), up = cross(towards, right);
  double half_width = 0, half_height = 0;
  for (const Triangle& t : unit.triangles) {
    for (const std::uint32_t v : t) {
      half_width = std::max(half_width, std::fabs(dot(unit.positions[v], right)));
      half_height = std::max(half_height, std::fabs(dot(unit.positions[v], up)));
    }
  }
  const double shape = static_cast<double>(options.height) / options.width;
  camera.SetParallelScale(kMargin * std::max({half_height, half_width * shape, 1e-6}) /
                          options.zoom);
  camera.SetClippingRange(8.5, 11.5);

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(oversampling * options.width, oversampling * options.height);
  window->AddRenderer(renderer);
  window->Render();
  vtkNew<vtkWindowToImageFilter> pixels;
  pixels->SetInput(window);
  pixels->ReadFrontBufferOff();
  vtkNew<vtkImageShrink3D> smaller;
  smaller->SetInputConnection(pixels->GetOutputPort());
  smaller->SetShrinkFactors(oversampling, oversampling, 1);
  smaller->AveragingOn();
  vtkNew<vtkPNGWriter> png;
  vtkNew<vtkJPEGWriter> jpeg;
  jpeg->SetQuality(kJpegQuality);
  jpeg->ProgressiveOff();
  return options.format == PictureFormat::png ? encoded(*png, *smaller) : encoded(*jpeg, *smaller);
}

}  // namespace isoatlas::detail::drawing
