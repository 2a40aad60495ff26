// SPDX-License-Identifier: Apache-2.0
// Which space a mesh file says its coordinates are in. The way to say it is 3D Slicer's: "SPACE=RAS" in a comment or in the
// header, in .vtp a text field of that name.
#include <vtkAbstractArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "files/file_error.h"
#include "files/library_messages.h"
#include "files/vtk_xml_file.h"
#include "mesh_files/formats.h"

namespace isoatlas::io {
namespace {

constexpr std::size_t kBeginning = 4096;  // bytes; comments are at the beginning of a file
constexpr std::string_view kKey = "SPACE=";

std::string space_in_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kBeginning, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t found = text.find(kKey);
  if (found == std::string::npos) return {};
  const auto first = text.begin() + static_cast<std::ptrdiff_t>(found + kKey.size());
  return {first, std::find_if_not(first, text.end(), [](unsigned char c) { return std::isalpha(c); })};
}

std::string space_in_fields(const std::filesystem::path& path) {
  const LibraryMessages messages;
  vtkNew<vtkXMLPolyDataReader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) return {};
  require_readable_vtk_xml(path);
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkFieldData* fields = reader->GetOutput()->GetFieldData();
  auto* space = fields ? vtkStringArray::SafeDownCast(fields->GetAbstractArray("SPACE")) : nullptr;
  return space && space->GetNumberOfValues() > 0 ? space->GetValue(0) : std::string();
}

}  // namespace

MeshFileInfo info_in_text(const std::filesystem::path& path) { return {.space = space_in_text(path), .comment = ""}; }

MeshFileInfo info_in_vtp(const std::filesystem::path& path) { return {.space = space_in_fields(path), .comment = ""}; }

}  // namespace isoatlas::io
