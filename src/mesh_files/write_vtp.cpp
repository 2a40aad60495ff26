// SPDX-License-Identifier: Apache-2.0
// Writes VTK's XML poly data, by VTK.
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <mutex>
#include <string>

#include "files/file_error.h"
#include "mesh_files/formats.h"

namespace isoatlas::detail::io {

namespace {

class SilentWindow : public vtkOutputWindow {
 public:
  static SilentWindow* New() { VTK_STANDARD_NEW_BODY(SilentWindow); }
  // clang-format off
  vtkTypeMacro(SilentWindow, vtkOutputWindow)
      // clang-format on

      void DisplayText(const char*) override {}
};

/// While an object of this class exists, VTK's messages do not reach the terminal. VTK's output
/// window belongs to the whole process, so the object holds a lock.
class VtkSilence {
 public:
  VtkSilence() : lock_(mutex()) {
    vtkOutputWindow::SetInstance(vtkNew<SilentWindow>());
    vtkLogger::SetStderrVerbosity(
        vtkLogger::VERBOSITY_OFF);  // VTK reports twice: to the window and to its log
  }
  ~VtkSilence() {
    vtkLogger::SetStderrVerbosity(verbosity_);
    vtkOutputWindow::SetInstance(window_);
  }
  VtkSilence(const VtkSilence&) = delete;
  VtkSilence& operator=(const VtkSilence&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> lock_;
  vtkSmartPointer<vtkOutputWindow> window_ = vtkOutputWindow::GetInstance();
  vtkLogger::Verbosity verbosity_ = vtkLogger::GetCurrentVerbosityCutoff();
};

void add_field(vtkPolyData& data, const std::string& name, const std::string& value) {
  if (!value.empty()) {
    vtkNew<vtkStringArray> field;
    field->SetName(name.c_str());
    field->InsertNextValue(value);
    data.GetFieldData()->AddArray(field);
  }
}

}  // namespace

void write_vtp(const TriangleMesh& mesh, const MeshFileInfo& info, AtomicFile& file) {
  write_vtp(mesh, {{"SPACE", info.space}, {"COMMENT", info.comment}}, {}, info.cap_triangles,
            file);  // SPACE is 3D Slicer's name for it
}

void write_vtp(const TriangleMesh& mesh, const std::map<std::string, std::string>& fields,
               const std::vector<float>& distance, std::size_t cap_triangles, AtomicFile& file) {
  const VtkSilence silence;
  const auto vertex_count = static_cast<vtkIdType>(mesh.positions.size());
  const auto triangle_count = static_cast<vtkIdType>(mesh.triangles.size());

  // VTK reads the positions in place (save = 1: it does not free them).
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  auto* first_coordinate =
      const_cast<double*>(reinterpret_cast<const double*>(mesh.positions.data()));
  coordinates->SetArray(first_coordinate, 3 * vertex_count, 1);
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);

  vtkNew<vtkTypeInt64Array> offsets;
  vtkNew<vtkTypeInt64Array> connectivity;
  offsets->SetNumberOfValues(triangle_count + 1);
  connectivity->SetNumberOfValues(3 * triangle_count);
  for (vtkIdType t = 0; t < triangle_count; ++t) {
    offsets->SetValue(t, 3 * t);
    for (int k = 0; k < 3; ++k) {
      connectivity->SetValue(
          3 * t + k, mesh.triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]);
    }
  }
  offsets->SetValue(triangle_count, 3 * triangle_count);
  vtkNew<vtkCellArray> polygons;
  polygons->SetData(offsets, connectivity);

  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(polygons);
  for (const auto& [name, value] : fields) {
    add_field(*data, name, value);
  }
  if (!distance.empty()) {
    vtkNew<vtkFloatArray> array;
    array->SetName(kVtpDistance);
    array->SetArray(const_cast<float*>(distance.data()), static_cast<vtkIdType>(distance.size()),
                    1);
    data->GetPointData()->AddArray(array);
  }

  if (cap_triangles > 0) {
    vtkNew<vtkUnsignedCharArray> caps;
    caps->SetName("cap");
    caps->SetNumberOfValues(triangle_count);
    for (vtkIdType t = 0; t < triangle_count; ++t) {
      caps->SetValue(t, t >= triangle_count - static_cast<vtkIdType>(cap_triangles) ? 1 : 0);
    }
    data->GetCellData()->AddArray(caps);
  }

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(file.written_path().c_str());
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();
  const bool written = writer->Write() != 0;
  if (!written || writer->GetErrorCode() != vtkErrorCode::NoError) {
    throw bad_file(file.destination(),
                   "cannot be written: VTK reports " +
                       one_line(vtkErrorCode::GetStringFromErrorCode(writer->GetErrorCode())));
  }
}

}  // namespace isoatlas::detail::io
