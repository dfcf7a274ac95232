// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/mesh_io.h"

#include <glog/logging.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "mesh/mesh_readers.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

std::string LowerExtension(const std::string& path) {
  const size_t dot = path.find_last_of('.');
  if (dot == std::string::npos) return "";
  std::string extension = path.substr(dot);
  std::transform(extension.begin(),
                 extension.end(),
                 extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string PlyHeader(const TriMesh& mesh, bool colors, bool planes) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  header += "element vertex " + std::to_string(mesh.NumVertices()) +
            "\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string rgb =
      "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (colors) header += rgb;
  header += "element face " + std::to_string(mesh.NumFaces()) +
            "\nproperty list uchar int vertex_indices\n";
  if (planes) header += "property int plane_id\n" + rgb;
  return header + "end_header\n";
}

// Little-endian bytes into memory that is large enough.
class ByteWriter {
 public:
  explicit ByteWriter(char* out) : out_(out) {}
  void Byte(uint8_t value) { *out_++ = static_cast<char>(value); }
  void Word(uint32_t value) {
    for (int k = 0; k < 4; ++k) Byte(static_cast<uint8_t>(value >> (8 * k)));
  }
  void Float(float value) {
    uint32_t bits;
    std::memcpy(&bits, &value, 4);
    Word(bits);
  }

 private:
  char* out_;
};

}  // namespace

int AppendFan(const std::vector<int>& polygon,
              std::vector<std::array<int, 3>>* faces) {
  int made = 0;
  for (size_t k = 1; k + 1 < polygon.size(); ++k, ++made) {
    faces->push_back({polygon[0], polygon[k], polygon[k + 1]});
  }
  return made;
}

uint8_t ColorByte(double value) {
  if (!(value > 0)) return 0;
  return static_cast<uint8_t>(std::min(255.0, std::round(value)));
}

MeshFile ReadMesh(const std::string& path) {
  const std::string extension = LowerExtension(path);
  if (extension != ".ply" && extension != ".obj") {
    throw InputError(path + ": unknown kind of mesh file; give a .ply or .obj");
  }
  const std::string content = ReadFile(path);
  MeshFile file =
      extension == ".ply" ? ParsePly(path, content) : ParseObj(path, content);
  if (file.mesh.vertices.empty()) {
    throw InputError(path + ": the mesh has no vertices; give a surface mesh");
  }
  if (file.mesh.faces.empty()) {
    throw InputError(path +
                     ": the mesh has no faces (a point cloud?); give a mesh");
  }
  return file;
}

void WritePly(const std::string& path,
              const TriMesh& mesh,
              const std::vector<int>* face_plane) {
  const bool colors = !mesh.vertex_colors.empty();
  if (colors) CHECK_EQ(mesh.vertex_colors.size(), mesh.NumVertices());
  if (face_plane) CHECK_EQ(face_plane->size(), mesh.NumFaces());
  std::string content = PlyHeader(mesh, colors, face_plane != nullptr);
  const size_t body = content.size();
  content.resize(body + mesh.NumVertices() * (colors ? 15 : 12) +
                 mesh.NumFaces() * (face_plane ? 20 : 13));
  ByteWriter out(&content[body]);
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    for (int k = 0; k < 3; ++k) {
      out.Float(static_cast<float>(mesh.vertices[v][k]));
    }
    if (!colors) continue;
    for (uint8_t channel : mesh.vertex_colors[v]) out.Byte(channel);
  }
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    out.Byte(3);
    for (int v : mesh.faces[f]) out.Word(static_cast<uint32_t>(v));
    if (!face_plane) continue;
    out.Word(static_cast<uint32_t>((*face_plane)[f]));
    for (uint8_t channel : PlaneColor((*face_plane)[f])) out.Byte(channel);
  }
  WriteFileAtomically(path, content);
}

Rgb PlaneColor(int plane_id) {
  if (plane_id < 0) return {128, 128, 128};
  Random random(static_cast<uint64_t>(plane_id) + 17);
  const double hue = random.Uniform(0, 6);
  const double saturation = random.Uniform(0.45, 0.95);
  const double value = random.Uniform(0.7, 1.0);
  Rgb color;
  for (int channel = 0; channel < 3; ++channel) {
    // Distance on the hue circle to the channel's own hue (0, 2, 4).
    double distance = std::abs(hue - 2.0 * channel);
    distance = std::min(distance, 6.0 - distance);
    const double strength = std::clamp(2.0 - distance, 0.0, 1.0);
    color[channel] =
        ColorByte(255.0 * value * (1.0 - saturation * (1.0 - strength)));
  }
  return color;
}

}  // namespace facet
