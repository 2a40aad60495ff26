// SPDX-License-Identifier: Apache-2.0
#include "slicer_parameters.h"

#include "isoatlas/version.h"

namespace isoatlas::detail::tool {
namespace {

// Formatted by hand: one parameter per paragraph.
// clang-format off
const std::vector<SlicerGroup>& groups() {
  static const std::vector<SlicerGroup> all{
    {"Volume and model", "What is meshed, and the model that receives the mesh", false, {
      {"image", "inputVolume", "Input volume",
       "A scalar volume or a label map"},
      {"geometry", "outputModel", "Output model",
       "The mesh of the finest level, in LPS coordinates and the unit of the volume (mm)"},
    }},
    {"Surface", "The surface in the volume", false, {
      {"double", "isovalue", "Isovalue",
       "The surface where the volume has this value. For integer samples use a value between two "
       "integers, such as 299.5",
       "0.5", {}, "iso"},
      {"integer", "label", "Label",
       "Mesh the segment with this value of a label map, and ignore the isovalue. 0: use the "
       "isovalue",
       "0"},
      {"string-enumeration", "inside", "Inside",
       "The side of the isovalue that is inside the surface",
       "above", {"above", "below"}, "inside"},
      {"string-enumeration", "nan", "NaN",
       "The side of the isovalue on which NaN samples are. refuse: stop if there are any",
       "refuse", {"refuse", "below", "above"}, "nan", "refuse"},
    }},
    {"Mesh", "Error and size of the mesh", false, {
      {"integer", "maxVertices", "Largest number of vertices",
       "This limit has priority over the distance. 0: no limit",
       "0", {}, "max-vertices", "0"},
      {"string", "maxDistance", "Largest distance",
       "Upper bound of the two-sided (Hausdorff) distance between surface and mesh: in voxels "
       "(0.5vx), with a unit (0.2mm), or in the unit of the volume (0.2). auto: half a voxel, or "
       "an eighth of the largest spacing if that is more",
       "auto", {}, "max-distance", "auto"},
      {"double", "normalAngle", "Largest normal angle",
       "Upper bound of the change of the surface normal within the Voronoi cell of a vertex, in "
       "degrees. 0: no bound",
       "0.0", {}, "normal-angle", "0"},
      {"boolean", "coarse", "Coarse mesh only",
       "The coarsest mesh that preserves the topology. The bounds are then only checked",
       "false"},
      {"integer", "levels", "Number of levels",
       "Make this number of levels of detail, 1 to 16. The finest has the largest distance above; "
       "each coarser one has twice the bound of the next, or less, so that the coarsest keeps a "
       "recognisable shape. 0: the coarse mesh and the finest level",
       "0", {}, "levels", "0"},
      {"directory", "levelFolder", "Folder of the levels",
       "Also write all levels into this folder, which exists: level-0.vtp is the coarsest. Empty: "
       "write only the output model, the finest level",
       ""},
    }},
    {"Components", "Which components of the surface are kept", false, {
      {"integer", "keepComponents", "Number of components",
       "Keep only this number of largest components. 0: keep all",
       "0", {}, "keep-components", "0"},
      {"string", "minComponentSize", "Smallest component",
       "Drop components that enclose a smaller volume: 10vx (voxels), 2.5mm3. Empty: keep all",
       "", {}, "min-component-size"},
      {"string-enumeration", "border", "At the volume boundary",
       "Where the volume boundary cuts the surface: the mesh ends there (open), or planar caps "
       "close it (closed), for 3-D printing",
       "open", {"open", "closed"}, "border"},
    }},
    {"Advanced", "Interpolation, supersampling, vertex placement, threads", true, {
      {"string-enumeration", "topology", "Topology",
       "Topology inside a grid cell: that of the trilinear interpolant, or one disk per loop on "
       "the faces of the cell",
       "trilinear", {"trilinear", "faces"}, "topology"},
      {"string-enumeration", "interpolation", "Interpolation",
       "Interpolation between samples; tricubic is smooth",
       "trilinear", {"trilinear", "tricubic"}, "interpolation"},
      {"integer", "supersample", "Supersampling",
       "Mesh the volume upsampled by this factor along each axis. A factor K needs about K*K times "
       "the time and memory",
       "1", {}, "supersample"},
      {"integer", "adaptiveSupersample", "Adaptive supersampling",
       "Upper limit on how often the surface is subdivided where a bound cannot be satisfied "
       "otherwise, 0 to 8",
       "6", {}, "adaptive-supersample"},
      {"string-enumeration", "placement", "Vertex placement",
       "On the isosurface, or displaced so that the mesh lies evenly on both sides of it",
       "surface", {"surface", "balanced"}, "placement"},
      {"boolean", "allowSelfIntersections", "Allow self-intersections",
       "Keep triangles that intersect: faster, and fewer triangles",
       "false"},
      {"boolean", "measure", "Measure the distance",
       "Also measure the two-sided distance between mesh and surface with 200,000 samples in each "
       "direction",
       "false"},
      {"integer", "threads", "Threads",
       "Number of threads; 0: as many as the machine has. The mesh does not depend on it",
       "0", {}, "threads"},
    }},
  };
  return all;
}
// clang-format on

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else
      result += c;
  }
  return result;
}

std::string element(std::string_view tag, std::string_view text, std::size_t indent) {
  const std::string name(tag);
  return std::string(indent, ' ') + "<" + name + ">" + escaped(text) + "</" + name + ">\n";
}

std::string attributes(const SlicerParameter& parameter) {
  // "scalar" offers scalar volumes and label maps. The first extension is that of the temporary
  // file in which 3D Slicer expects the model.
  if (parameter.type == "image") return " type=\"scalar\"";
  if (parameter.type == "geometry") return " fileExtensions=\".vtp,.ply,.stl,.obj\"";
  return "";
}

/// The order of the elements is that of the schema.
/// @param index  the place on the command line of a parameter without a flag; empty for others
std::string parameter_xml(const SlicerParameter& parameter, std::string_view index,
                          bool is_result) {
  const std::string type(parameter.type);
  std::string xml = "    <" + type + attributes(parameter) + ">\n";
  xml += element("name", parameter.name, 6);
  if (!index.empty())
    xml += element("index", index, 6);
  else if (!is_result)
    xml += element("longflag", parameter.name, 6);
  xml += element("description", parameter.description, 6);
  xml += element("label", parameter.label, 6);
  if (!parameter.default_value.empty()) xml += element("default", parameter.default_value, 6);
  if (parameter.type == "image") xml += element("channel", "input", 6);
  if (parameter.type == "geometry" || parameter.type == "directory" || is_result)
    xml += element("channel", "output", 6);
  for (const std::string_view word : parameter.words) xml += element("element", word, 6);
  return xml + "    </" + type + ">\n";
}

std::string group_xml(const SlicerGroup& group, bool is_results) {
  std::string xml =
      std::string("  <parameters") + (group.is_advanced ? " advanced=\"true\"" : "") + ">\n";
  xml += element("label", group.label, 4) + element("description", group.description, 4);
  for (const SlicerParameter& parameter : group.parameters) {
    const std::string_view index = parameter.type == "image"      ? "0"
                                   : parameter.type == "geometry" ? "1"
                                                                  : "";
    xml += parameter_xml(parameter, index, is_results);
  }
  return xml + "  </parameters>\n";
}

}  // namespace

std::span<const SlicerGroup> slicer_groups() { return groups(); }

const SlicerGroup& slicer_results() {
  static const SlicerGroup results{
      "Result",
      "Counted on the triangles of the model",
      false,
      {
          {"integer", "vertices", "Vertices", "Number of vertices"},
          {"integer", "triangles", "Triangles", "Number of triangles"},
          {"integer", "components", "Components", "Number of connected components"},
          {"integer", "genus", "Genus", "Sum of the genus of all components"},
          {"integer", "boundaryLoops", "Boundary loops",
           "Number of loops in which the volume boundary cuts the surface; 0: closed"},
          {"string", "distance", "Distance",
           "The largest two-sided distance between surface and mesh, and whether it is proved"},
          {"string", "violated", "Violated bounds", "The bounds that the mesh violates, and why"},
      }};
  return results;
}

std::string slicer_xml() {
  std::string xml = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
  xml += element("category", "Surface Models", 2);
  xml += element("title", "Isoatlas", 2);
  xml += element("description",
                 "Meshes an isosurface or a label as an adaptive triangle mesh with certified "
                 "topology: a manifold without self-intersections, within a bound of the surface.",
                 2);
  xml += element("version", ISOATLAS_VERSION, 2);
  xml += element("documentation-url", "", 2);
  xml += element("license", "Apache-2.0", 2);
  xml += element("contributor", "the isoatlas contributors", 2);
  xml += element("acknowledgements",
                 "Method: Gavriliu, Carranza, Breen and Barr, IEEE Visualization 2001", 2);
  for (const SlicerGroup& group : slicer_groups()) xml += group_xml(group, false);
  xml += group_xml(slicer_results(), true);
  return xml + "</executable>\n";
}

}  // namespace isoatlas::detail::tool
