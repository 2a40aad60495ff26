// SPDX-License-Identifier: Apache-2.0
// VTK's XML multi-block file: a list of .vtp files, one per level, in a folder next to it. They are
// named as VTK's own writer names them.

#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "files/file_error.h"
#include "files/vtk_xml_header.h"
#include "mesh_files/formats.h"

namespace isoatlas::detail::io {

namespace fs = std::filesystem;

namespace {

// Text fields of the .vtp files.
constexpr const char* kLevelField = "LEVEL";          // the level's JSON
constexpr const char* kPlacementField = "PLACEMENT";  // surface or balanced

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

// Creates a folder and removes it in the destructor unless keep() was called; an existing folder is
// never removed.
class NewFolder {
 public:
  NewFolder(fs::path folder, const fs::path& path) : folder_(std::move(folder)) {
    std::error_code error;
    is_new_ = fs::create_directory(folder_, error);
    if (error || !fs::is_directory(folder_, error)) {
      throw bad_file(path, "cannot be written: the folder " + folder_.string() +
                               " for its levels cannot be created");
    }
  }
  ~NewFolder() {
    std::error_code ignored;
    if (is_new_) {
      fs::remove(folder_, ignored);  // it is empty: all files in it were temporary
    }
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  void keep() { is_new_ = false; }

 private:
  fs::path folder_;
  bool is_new_ = false;
};

// The file names of the blocks in order, relative to the folder of `path`.
std::vector<fs::path> blocks_of(const fs::path& path) {
  const VtkXmlHeader header = read_vtk_xml_header(path);
  const XmlElement* const list = header.root.child("vtkMultiBlockDataSet");
  if (list == nullptr) {
    throw bad_file(path, "is not a VTK XML multi-block file");
  }
  std::vector<fs::path> blocks;
  for (const XmlElement& element : list->children) {
    const std::string* const file = element.attribute("file");
    if (element.name != "DataSet") {
      throw unsupported(path, "has blocks within blocks, expected one file for each level");
    }
    if (file == nullptr) {
      throw unsupported(path, "its block " + std::to_string(blocks.size()) +
                                  " is empty, expected a file for each level");
    }
    blocks.emplace_back(*file);
  }
  if (blocks.empty()) {
    throw bad_file(path, "has no blocks");
  }
  return blocks;
}

}  // namespace

fs::path vtm_piece(const fs::path& path, std::size_t level) {
  const std::string stem = path.stem().string();
  return path.parent_path() / stem / (stem + "_" + std::to_string(level) + ".vtp");
}

StoredPositions write_vtm(const Hierarchy& hierarchy, const HierarchyFileInfo& info,
                          const fs::path& path) {
  AtomicFile index(path);
  const fs::path folder = vtm_piece(path, 0).parent_path();
  NewFolder new_folder(folder, path);
  std::vector<std::unique_ptr<AtomicFile>> pieces;
  std::string list;
  for (std::size_t k = 0; k < hierarchy.levels.size(); ++k) {
    const fs::path piece = vtm_piece(path, k);
    pieces.push_back(std::make_unique<AtomicFile>(piece));
    write_vtp(hierarchy.mesh(k),
              {{"SPACE", info.mesh.space},
               {"COMMENT", info.mesh.comment},
               {kPlacementField, info.placement == Placement::balanced ? "balanced" : "surface"},
               {kLevelField, info.levels.empty() ? "" : info.levels[k]}},
              hierarchy.levels[k].distance, hierarchy.levels[k].cap_triangles, *pieces.back());
    const std::string number = std::to_string(k);
    list += "    <DataSet index=\"" + number + "\" name=\"level " + number + "\" file=\"" +
            escaped((folder.filename() / piece.filename()).generic_string()) + "\"/>\n";
  }
  index.stream() << "<?xml version=\"1.0\"?>\n"
                    "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
                    "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                    "  <vtkMultiBlockDataSet>\n"
                 << list << "  </vtkMultiBlockDataSet>\n</VTKFile>\n";
  // The list is committed last, so it never names a missing file.
  for (const auto& piece : pieces) {
    piece->commit();
    new_folder.keep();
  }
  index.commit();
  return {.single_precision = false, .space = info.mesh.space, .unit = info.mesh.unit};
}

StoredLevels read_vtm(const fs::path& path) {
  StoredLevels levels;
  bool any_json = false;
  for (const fs::path& block : blocks_of(path)) {
    const fs::path piece = path.parent_path() / block;
    readable_file_size(piece);
    std::map<std::string, std::string> fields;
    levels.meshes.push_back(read_vtp(piece, fields, levels.distances.emplace_back()));
    levels.info.mesh = {fields["SPACE"], fields["COMMENT"]};
    levels.info.placement =
        fields[kPlacementField] == "balanced" ? Placement::balanced : Placement::surface;
    levels.info.levels.push_back(fields[kLevelField].empty() ? "null" : fields[kLevelField]);
    any_json = any_json || levels.info.levels.back() != "null";
  }
  if (!any_json) {
    levels.info.levels.clear();
  }
  return levels;
}

}  // namespace isoatlas::detail::io
