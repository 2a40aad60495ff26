// SPDX-License-Identifier: Apache-2.0
#include "mesh_files/draco_mesh.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>

#include <memory>
#include <utility>

#include "isoatlas/error.h"

namespace isoatlas::detail::io {

std::string draco_bytes(const IntegerMesh& mesh) {
  draco::Mesh to;
  to.SetNumFaces(mesh.triangles.size());
  to.set_num_points(static_cast<std::uint32_t>(mesh.positions.size()));
  draco::GeometryAttribute position;
  position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false,
                3 * sizeof(std::int32_t), 0);
  const int id = to.AddAttribute(position, true, static_cast<std::uint32_t>(mesh.positions.size()));
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    to.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), mesh.positions[v].data());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    draco::Mesh::Face face;
    for (std::size_t k = 0; k < 3; ++k) face[k] = mesh.triangles[t][k];
    to.SetFace(draco::FaceIndex(t), face);
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer bytes;
  if (const draco::Status status = encoder.EncodeMeshToBuffer(to, &bytes); !status.ok())
    throw Error(ErrorCode::internal,
                "Draco cannot compress the mesh: " + status.error_msg_string());
  return {bytes.data(), bytes.size()};
}

IntegerMesh mesh_of_draco(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    throw Error(ErrorCode::internal,
                "Draco cannot decompress its mesh: " + decoded.status().error_msg_string());
  const std::unique_ptr<draco::Mesh> from = std::move(decoded).value();
  const draco::PointAttribute* const position =
      from->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  IntegerMesh out;
  out.positions.resize(from->num_points());
  for (std::uint32_t v = 0; v < from->num_points(); ++v)
    position->GetValue(position->mapped_index(draco::PointIndex(v)), out.positions[v].data());
  for (std::uint32_t t = 0; t < from->num_faces(); ++t) {
    const draco::Mesh::Face& face = from->face(draco::FaceIndex(t));
    out.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
  }
  return out;
}

}  // namespace isoatlas::detail::io
