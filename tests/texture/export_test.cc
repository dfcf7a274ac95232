// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "tests/support/temp_dir.h"
#include "tests/texture/texture_scenes.h"
#include "texture/atlas.h"
#include "texture/glb_export.h"
#include "texture/obj_export.h"
#include "texture/seam_vertices.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Two walls that share an edge, on two small pages of noise.
TexturedMesh CornerModel() {
  PlaneScene scene;
  AddQuadGrid(Vector3d(0, 0, 0),
              Vector3d(0.2, 0, 0),
              Vector3d(0, 0.15, 0),
              3,
              2,
              &scene);
  AddQuadGrid(Vector3d(0, 5, 0.123456789),
              Vector3d(0.2, 0, 0),
              Vector3d(0, 0.1, 0.1),
              2,
              2,
              &scene);
  AtlasOptions options;
  options.page_size = 100;
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, options);
  TexturedMesh model;
  model.mesh = scene.mesh;
  model.face_uv = atlas.face_uv;
  model.face_page = atlas.face_page;
  for (const auto& size : atlas.page_size) {
    cv::Mat page(size[1], size[0], CV_8UC3);
    cv::randu(page, 0, 256);
    model.pages.push_back(page);
  }
  return model;
}

cv::Mat RgbToBgr(const cv::Mat& rgb) {
  cv::Mat bgr = rgb.clone();
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      std::swap(bgr.at<cv::Vec3b>(y, x)[0], bgr.at<cv::Vec3b>(y, x)[2]);
    }
  }
  return bgr;
}

TEST(SeamVertices, SplitOnlyWhereCoordinatesDiffer) {
  // Inside a chart corners share their vertex; with every face on its own
  // coordinates nothing is shared.
  TexturedMesh model = CornerModel();
  SeamVertices seams = SplitAtSeams(model);
  EXPECT_EQ(seams.vertices.size(), model.mesh.NumVertices());
  for (size_t f = 0; f < model.mesh.NumFaces(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const SeamVertex& v = seams.vertices[seams.corners[f][k]];
      EXPECT_EQ(v.vertex, model.mesh.faces[f][k]);
      EXPECT_EQ(v.uv, model.face_uv[f][k]);
      EXPECT_EQ(v.page, model.face_page[f]);
    }
    for (auto& uv : model.face_uv[f]) uv.x() += static_cast<float>(f);
  }
  seams = SplitAtSeams(model);
  EXPECT_EQ(seams.vertices.size(), 3 * model.mesh.NumFaces());
}

TEST(ObjExport, ReadsBackAsWritten) {
  // Positions, coordinates (v axis up) and pictures must survive; names are
  // relative and every material has its picture.
  const TempDir dir;
  const TexturedMesh model = CornerModel();
  ASSERT_EQ(model.pages.size(), 2u);
  ExportObj(dir.path(), model, EncodePages(model));
  std::vector<Vector3d> v;
  std::vector<Vector2d> vt;
  std::vector<std::array<std::array<int, 2>, 3>> faces;
  std::vector<int> pages;
  std::istringstream text(ReadFile(dir / "mesh.obj"));
  std::string line, material, library;
  while (std::getline(text, line)) {
    std::istringstream in(line);
    std::string word;
    in >> word;
    if (word == "v") {
      v.emplace_back();
      in >> v.back().x() >> v.back().y() >> v.back().z();
    } else if (word == "vt") {
      vt.emplace_back();
      in >> vt.back().x() >> vt.back().y();
    } else if (word == "usemtl") {
      in >> material;
    } else if (word == "mtllib") {
      in >> library;
    } else if (word == "f") {
      faces.emplace_back();
      char slash;
      for (auto& c : faces.back()) in >> c[0] >> slash >> c[1];
      EXPECT_TRUE(in);
      pages.push_back(material == "page_0" ? 0 : 1);
    }
  }
  EXPECT_EQ(library, "mesh.mtl");
  ASSERT_EQ(v.size(), model.mesh.NumVertices());
  ASSERT_EQ(faces.size(), model.mesh.NumFaces());
  size_t next[2] = {0, 0};
  for (size_t f = 0; f < model.mesh.NumFaces(); ++f) {
    // Faces are grouped by page and keep their order within it.
    const int page = model.face_page[f];
    size_t i = next[page];
    while (pages[i] != page) ++i;
    next[page] = i + 1;
    for (int k = 0; k < 3; ++k) {
      const Vector3d& x = model.mesh.vertices[model.mesh.faces[f][k]];
      EXPECT_LT((v[faces[i][k][0] - 1] - x).norm(), 2e-6);
      const Vector2d uv = vt[faces[i][k][1] - 1];
      EXPECT_NEAR(
          uv.x() * model.pages[page].cols, model.face_uv[f][k].x(), 1e-3);
      EXPECT_NEAR(
          (1 - uv.y()) * model.pages[page].rows, model.face_uv[f][k].y(), 1e-3);
    }
  }
  const std::string mtl = ReadFile(dir / "mesh.mtl");
  for (int page = 0; page < 2; ++page) {
    const std::string name = "texture_" + std::to_string(page) + ".png";
    EXPECT_NE(mtl.find("map_Kd " + name + "\n"), std::string::npos);
    EXPECT_EQ(
        cv::norm(
            cv::imread(dir / name), RgbToBgr(model.pages[page]), cv::NORM_INF),
        0);
  }
}

TEST(ObjExport, BareGeometryHasNoMaterial) {
  const TempDir dir;
  TexturedMesh model = CornerModel();
  model.face_uv.clear();
  model.face_page.clear();
  model.pages.clear();
  ExportObj(dir.path(), model, EncodePages(model));
  EXPECT_EQ(ReadFile(dir / "mesh.obj").find("mtl"), std::string::npos);
  EXPECT_FALSE(std::ifstream(dir / "mesh.mtl").good());
}

TEST(GlbExport, PassesTheFormatsRules) {
  // Read by tinygltf: accessors inside their views and buffer, aligned,
  // min/max exact, indices in range, geometry, pictures and extension there.
  const TempDir dir;
  const TexturedMesh model = CornerModel();
  ExportGlb(dir / "mesh.glb", model, EncodePages(model));
  const std::string bytes = ReadFile(dir / "mesh.glb");
  uint32_t header[5];
  ASSERT_GT(bytes.size(), sizeof(header));
  std::memcpy(header, bytes.data(), sizeof(header));
  EXPECT_EQ(header[1], 2u);
  EXPECT_EQ(header[2], bytes.size());
  EXPECT_EQ(header[3] % 4, 0u);

  tinygltf::Model gltf;
  tinygltf::TinyGLTF reader;
  std::string error, warning;
  ASSERT_TRUE(
      reader.LoadBinaryFromFile(&gltf, &error, &warning, dir / "mesh.glb"))
      << error;
  EXPECT_TRUE(error.empty() && warning.empty()) << error << warning;
  ASSERT_EQ(gltf.buffers.size(), 1u);
  for (const auto& view : gltf.bufferViews) {
    EXPECT_EQ(view.byteOffset % 4, 0u);
    EXPECT_LE(view.byteOffset + view.byteLength, gltf.buffers[0].data.size());
  }
  for (const auto& accessor : gltf.accessors) {
    const size_t size =
        tinygltf::GetComponentSizeInBytes(accessor.componentType) *
        tinygltf::GetNumComponentsInType(accessor.type);
    EXPECT_EQ(accessor.count * size,
              gltf.bufferViews[accessor.bufferView].byteLength);
  }
  ASSERT_EQ(gltf.meshes.size(), 1u);
  ASSERT_EQ(gltf.meshes[0].primitives.size(), 2u);
  const auto data = [&](int accessor) {
    const auto& view = gltf.bufferViews[gltf.accessors[accessor].bufferView];
    return gltf.buffers[0].data.data() + view.byteOffset;
  };
  size_t faces = 0;
  for (int page = 0; page < 2; ++page) {
    const auto& primitive = gltf.meshes[0].primitives[page];
    const int position = primitive.attributes.at("POSITION");
    const int uv = primitive.attributes.at("TEXCOORD_0");
    ASSERT_EQ(primitive.attributes.count("NORMAL"), 1u);
    EXPECT_EQ(primitive.attributes.count("COLOR_0"), 0u);
    const size_t n = gltf.accessors[position].count;
    ASSERT_EQ(gltf.accessors[uv].count, n);
    const auto* xyz = reinterpret_cast<const float*>(data(position));
    const auto* st = reinterpret_cast<const float*>(data(uv));
    const auto* ids =
        reinterpret_cast<const uint32_t*>(data(primitive.indices));
    for (int k = 0; k < 3; ++k) {
      double low = 1e9, high = -1e9;
      for (size_t i = 0; i < n; ++i) {
        low = std::min<double>(low, xyz[3 * i + k]);
        high = std::max<double>(high, xyz[3 * i + k]);
      }
      EXPECT_EQ(gltf.accessors[position].minValues[k], low);
      EXPECT_EQ(gltf.accessors[position].maxValues[k], high);
    }
    size_t next = 0;
    for (size_t i = 0; i < gltf.accessors[primitive.indices].count; i += 3) {
      while (model.face_page[next] != page) ++next;
      for (int k = 0; k < 3; ++k) {
        const uint32_t id = ids[i + k];
        ASSERT_LT(id, n);
        const Vector3d& x = model.mesh.vertices[model.mesh.faces[next][k]];
        for (int d = 0; d < 3; ++d) EXPECT_NEAR(xyz[3 * id + d], x[d], 1e-6);
        EXPECT_NEAR(st[2 * id] * model.pages[page].cols,
                    model.face_uv[next][k].x(),
                    1e-3);
        EXPECT_NEAR(st[2 * id + 1] * model.pages[page].rows,
                    model.face_uv[next][k].y(),
                    1e-3);
      }
      ++next;
      ++faces;
    }
    const auto& material = gltf.materials[primitive.material];
    EXPECT_EQ(material.extensions.count("KHR_materials_unlit"), 1u);
    EXPECT_TRUE(material.doubleSided);
    const auto& image =
        gltf.images
            [gltf.textures[material.pbrMetallicRoughness.baseColorTexture.index]
                 .source];
    ASSERT_EQ(image.width, model.pages[page].cols);
    ASSERT_EQ(image.height, model.pages[page].rows);
    const int channels = image.component;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        for (int k = 0; k < 3; ++k) {
          ASSERT_EQ(image.image[(y * image.width + x) * channels + k],
                    model.pages[page].at<cv::Vec3b>(y, x)[k]);
        }
      }
    }
  }
  EXPECT_EQ(faces, model.mesh.NumFaces());
}

TEST(GlbExport, RefusesWhatItCannotWrite) {
  const TempDir dir;
  EXPECT_THROW(ExportGlb(dir / "mesh.glb", TexturedMesh(), {}),
               UnsolvableError);
  std::ofstream(dir / "file") << "x";
  EXPECT_THROW(
      ExportGlb(
          dir / "file/mesh.glb", CornerModel(), EncodePages(CornerModel())),
      InputError);
  EXPECT_FALSE(std::ifstream(dir / "mesh.glb").good());
}

}  // namespace
}  // namespace facet
