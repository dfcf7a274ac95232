// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/mesh_io.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "tests/mesh/test_shapes.h"
#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

MeshFile ReadText(const std::string& name, const std::string& text) {
  TempDir dir;
  WriteFileAtomically(dir / name, text);
  return ReadMesh(dir / name);
}

// The message of the InputError, or "" if there was none.
std::string ErrorOf(const std::string& name, const std::string& text) {
  try {
    ReadText(name, text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Vertices, colours, order or labels lost or swapped in writing or reading.
TEST(MeshIo, PlyRoundTrip) {
  TempDir dir;
  TriMesh mesh;
  AddGrid({1, 2, 3}, {2, 0, 0}, {0, 1, 0.5}, 4, 3, &mesh);
  std::vector<int> planes;
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    mesh.vertex_colors.push_back(
        {uint8_t(v), uint8_t(2 * v), uint8_t(255 - v)});
  }
  for (size_t f = 0; f < mesh.NumFaces(); ++f) planes.push_back(int(f) * 70000);
  WritePly(dir / "a.ply", mesh, &planes);
  const MeshFile read = ReadMesh(dir / "a.ply");
  EXPECT_EQ(read.mesh.faces, mesh.faces);
  EXPECT_EQ(read.mesh.vertex_colors, mesh.vertex_colors);
  EXPECT_EQ(read.face_plane, planes);
  ASSERT_EQ(read.mesh.NumVertices(), mesh.NumVertices());
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    EXPECT_EQ(read.mesh.vertices[v].cast<float>(),
              mesh.vertices[v].cast<float>());
  }
  // What was read is written to the same bytes.
  WritePly(dir / "b.ply", read.mesh, &read.face_plane);
  EXPECT_EQ(ReadFile(dir / "a.ply"), ReadFile(dir / "b.ply"));
}

template <typename T>
std::string Bytes(T value, bool big) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

// Property order, scalar types, byte order, foreign elements and properties, a
// polygon: one tetrahedron-like mesh written three ways must read the same.
TEST(MeshIo, AsciiAndBothEndiansAgree) {
  const std::string declarations =
      "comment made by hand\nelement material 1\nproperty list uchar short a\n"
      "element vertex 4\nproperty uchar red\nproperty double z\n"
      "property float nx\nproperty short x\nproperty uchar green\n"
      "property float y\nproperty uchar blue\n"
      "element face 2\nproperty float quality\n"
      "property list uint ushort vertex_index\nproperty int plane_id\n"
      "end_header\n";
  const std::string ascii = "ply\nformat ascii 1.0\n" + declarations +
                            "2 7 8\n"
                            "1 0.5 0 10 2 -0.25 3\r\n4 1.5 0 20 5 1e-3 6\n"
                            "7 +2.5 0 -30 8 0 9 10 3.5 0 40 11 4 12\n"
                            "0.5 4 0 1 2 3 -5\n0.5 3 3 2 0 6\n";
  const auto binary = [&](bool big) {
    std::string s = std::string("ply\nformat binary_") +
                    (big ? "big" : "little") + "_endian 1.0\n" + declarations;
    s += Bytes<uint8_t>(2, big) + Bytes<int16_t>(7, big) +
         Bytes<int16_t>(8, big);
    const double z[] = {0.5, 1.5, 2.5, 3.5};
    const int16_t x[] = {10, 20, -30, 40};
    const float y[] = {-0.25f, 1e-3f, 0, 4};
    for (int k = 0; k < 4; ++k) {
      s += Bytes<uint8_t>(uint8_t(3 * k + 1), big) + Bytes(z[k], big) +
           Bytes<float>(0, big) + Bytes(x[k], big) +
           Bytes<uint8_t>(uint8_t(3 * k + 2), big) + Bytes(y[k], big) +
           Bytes<uint8_t>(uint8_t(3 * k + 3), big);
    }
    s += Bytes(0.5f, big) + Bytes<uint32_t>(4, big);
    for (uint16_t v : {0, 1, 2, 3}) s += Bytes(v, big);
    s += Bytes<int32_t>(-5, big) + Bytes(0.5f, big) + Bytes<uint32_t>(3, big);
    for (uint16_t v : {3, 2, 0}) s += Bytes(v, big);
    return s + Bytes<int32_t>(6, big);
  };
  const std::vector<std::array<int, 3>> faces = {
      {0, 1, 2}, {0, 2, 3}, {3, 2, 0}};
  for (const std::string& text : {ascii, binary(false), binary(true)}) {
    const MeshFile file = ReadText("m.ply", text);
    ASSERT_EQ(file.mesh.NumVertices(), 4u);
    EXPECT_NEAR((file.mesh.vertices[1] - Eigen::Vector3d(20, 1e-3, 1.5)).norm(),
                0,
                1e-9);
    EXPECT_EQ(file.mesh.vertices[2], Eigen::Vector3d(-30, 0, 2.5));
    EXPECT_EQ(file.mesh.vertex_colors[3], (Rgb{10, 11, 12}));
    EXPECT_EQ(file.mesh.faces, faces);
    EXPECT_EQ(file.face_plane, (std::vector<int>{-5, -5, 6}));
  }
}

// Every spelling of a corner, relative indices, polygons, colours.
TEST(MeshIo, ObjCorners) {
  const MeshFile file = ReadText("m.OBJ",
                                 "# cube part\nmtllib x.mtl\n"
                                 "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\r\n"
                                 "v 1 1 0 0 0 1\nv 0 1 0 1 1 1\n"
                                 "vt 0 0\nvn 0 0 1\n"
                                 "f 1 2/1 3//1 4/1/1\nf -4 -3 -2 # end\n");
  EXPECT_EQ(file.mesh.faces,
            (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
  EXPECT_EQ(file.mesh.vertex_colors[2], (Rgb{0, 0, 255}));
  EXPECT_TRUE(file.face_plane.empty());
}

// Every truncation of a binary file must end in an InputError that names it,
// never in a short mesh or a crash.
TEST(MeshIo, TruncatedPlyIsRefused) {
  TempDir dir;
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2, &mesh);
  WritePly(dir / "whole.ply", mesh);
  const std::string whole = ReadFile(dir / "whole.ply");
  for (size_t size = 0; size < whole.size(); size += 3) {
    WriteFileAtomically(dir / "cut.ply", whole.substr(0, size));
    try {
      ReadMesh(dir / "cut.ply");
      ADD_FAILURE() << size;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("cut.ply"), std::string::npos);
    }
  }
}

// Counts that no memory can hold, junk, and meshes without surface.
TEST(MeshIo, MalformedFilesAreRefused) {
  const std::string xyz =
      "property float x\nproperty float y\nproperty float z\n";
  const std::string list = "property list uchar int vertex_indices\n";
  EXPECT_NE(ErrorOf("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex "
                    "99999999999999\n" +
                        xyz + "end_header\n0 0 0\n"),
            "");
  EXPECT_NE(ErrorOf("a.ply",
                    "ply\nformat binary_little_endian 1.0\nelement "
                    "face 1\nproperty list int int vertex_indices\n"
                    "end_header\n\xff\xff\xff\x7fxxxx"),
            "");
  EXPECT_NE(ErrorOf("a.ply", "plx\n"), "");
  EXPECT_NE(ErrorOf("a.ply", "ply\nelement vertex 0\n" + xyz + "end_header\n"),
            "");
  EXPECT_NE(ErrorOf("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\n"
                    "property quad x\nend_header\n0\n"),
            "");
  // The line is named: the header has 8 lines, the word stands in the 10th.
  const std::string error = ErrorOf(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + "element face 0\n" +
          list + "end_header\n0 0 0\n0 zero 0\n0 0 0\n");
  EXPECT_NE(error.find("line 11"), std::string::npos) << error;
  EXPECT_NE(ErrorOf("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\n" + xyz +
                        "end_header\n0 0 0\n"),
            "")
      << "no faces";
  EXPECT_NE(
      ErrorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n").find("line 4"),
      std::string::npos);
  EXPECT_NE(ErrorOf("a.obj", "v 0 0\n"), "");
  EXPECT_NE(ErrorOf("a.obj", "v 0 0 0\nf 0 1 1\n"), "");
  EXPECT_NE(ErrorOf("a.obj", "# nothing\n"), "");
  EXPECT_NE(ErrorOf("a.stl", "solid\n"), "");
  EXPECT_THROW(ReadMesh("/nonexistent/mesh.ply"), InputError);
}

// Bad index values are for cleaning to count, not for the reader to refuse.
TEST(MeshIo, BadIndicesComeThrough) {
  const MeshFile file = ReadText(
      "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\nf 1 -7 2\n");
  ASSERT_EQ(file.mesh.NumFaces(), 3u);
  EXPECT_EQ(file.mesh.faces[1][2], 8);
  EXPECT_LT(file.mesh.faces[2][1], 0);
}

// Colours must differ between neighbours' ids and be bright.
TEST(MeshIo, PlaneColorsAreBrightAndVaried) {
  std::set<Rgb> colors;
  for (int id = 0; id < 500; ++id) {
    const Rgb c = PlaneColor(id);
    EXPECT_GE(std::max({c[0], c[1], c[2]}), 170);
    colors.insert(c);
  }
  EXPECT_GT(colors.size(), 490u);
}

}  // namespace
}  // namespace facet
