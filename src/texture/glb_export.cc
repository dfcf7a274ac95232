// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/glb_export.h"

#include <tiny_gltf.h>

#include <cstring>
#include <limits>

#include "texture/seam_vertices.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// Fills the single buffer of a model: views start at multiples of 4 bytes.
class BufferWriter {
 public:
  explicit BufferWriter(tinygltf::Model* model) : model_(model) {
    model_->buffers.resize(1);
  }

  int AddView(const void* data, size_t bytes, int target) {
    auto& buffer = model_->buffers[0].data;
    buffer.resize((buffer.size() + 3) / 4 * 4, 0);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes;
    if (target) view.target = target;
    buffer.resize(buffer.size() + bytes);
    std::memcpy(buffer.data() + view.byteOffset, data, bytes);
    model_->bufferViews.push_back(view);
    return static_cast<int>(model_->bufferViews.size()) - 1;
  }

  template <typename T>
  int AddAccessor(const std::vector<T>& values,
                  int component_type,
                  int type,
                  int target) {
    tinygltf::Accessor accessor;
    accessor.bufferView =
        AddView(values.data(), values.size() * sizeof(T), target);
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = values.size();
    model_->accessors.push_back(accessor);
    return static_cast<int>(model_->accessors.size()) - 1;
  }

 private:
  tinygltf::Model* model_;
};

// Area-weighted normal of every seam vertex over its own chart's faces.
std::vector<Vector3f> SeamNormals(const TriMesh& mesh,
                                  const SeamVertices& seams) {
  std::vector<Eigen::Vector3d> sum(seams.vertices.size(),
                                   Eigen::Vector3d::Zero());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    for (int v : seams.corners[f]) sum[v] += mesh.FaceCross(f);
  }
  std::vector<Vector3f> normals(sum.size(), Vector3f::UnitZ());
  for (size_t v = 0; v < sum.size(); ++v) {
    if (sum[v].norm() > 0) normals[v] = sum[v].normalized().cast<float>();
  }
  return normals;
}

int AddMaterial(const std::string* png,
                tinygltf::Model* model,
                BufferWriter* writer) {
  tinygltf::Material material;
  material.doubleSided = true;
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 1;
  material.extensions["KHR_materials_unlit"] =
      tinygltf::Value(tinygltf::Value::Object());
  if (png) {
    tinygltf::Image image;
    image.mimeType = "image/png";
    image.bufferView = writer->AddView(png->data(), png->size(), 0);
    model->images.push_back(image);
    tinygltf::Texture texture;
    texture.source = static_cast<int>(model->images.size()) - 1;
    texture.sampler = 0;
    model->textures.push_back(texture);
    material.pbrMetallicRoughness.baseColorTexture.index =
        static_cast<int>(model->textures.size()) - 1;
  }
  model->materials.push_back(material);
  return static_cast<int>(model->materials.size()) - 1;
}

// The faces of one page with the seam vertices they use, renumbered.
struct PageGeometry {
  std::vector<Vector3f> positions, normals;
  std::vector<Vector2f> uv;  // 0 to 1
  std::vector<uint32_t> indices;
};

PageGeometry CollectPage(const TexturedMesh& model,
                         const SeamVertices& seams,
                         const std::vector<Vector3f>& normals,
                         int page) {
  PageGeometry out;
  std::vector<int> local(seams.vertices.size(), -1);
  for (const auto& corners : seams.corners) {
    if (seams.vertices[corners[0]].page != page) continue;
    for (int id : corners) {
      if (local[id] < 0) {
        local[id] = static_cast<int>(out.positions.size());
        const SeamVertex& v = seams.vertices[id];
        out.positions.push_back(model.mesh.vertices[v.vertex].cast<float>());
        out.normals.push_back(normals[id]);
        if (!model.face_uv.empty()) {
          const cv::Mat& image = model.pages[page];
          out.uv.emplace_back(v.uv.x() / static_cast<float>(image.cols),
                              v.uv.y() / static_cast<float>(image.rows));
        }
      }
      out.indices.push_back(static_cast<uint32_t>(local[id]));
    }
  }
  return out;
}

tinygltf::Primitive AddPrimitive(const PageGeometry& page,
                                 int material,
                                 tinygltf::Model* model,
                                 BufferWriter* writer) {
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  const int position = writer->AddAccessor(page.positions,
                                           TINYGLTF_COMPONENT_TYPE_FLOAT,
                                           TINYGLTF_TYPE_VEC3,
                                           TINYGLTF_TARGET_ARRAY_BUFFER);
  Vector3f low = page.positions[0], high = low;
  for (const Vector3f& p : page.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int k = 0; k < 3; ++k) {
    model->accessors[position].minValues.push_back(low[k]);
    model->accessors[position].maxValues.push_back(high[k]);
  }
  primitive.attributes["POSITION"] = position;
  primitive.attributes["NORMAL"] =
      writer->AddAccessor(page.normals,
                          TINYGLTF_COMPONENT_TYPE_FLOAT,
                          TINYGLTF_TYPE_VEC3,
                          TINYGLTF_TARGET_ARRAY_BUFFER);
  if (!page.uv.empty()) {
    primitive.attributes["TEXCOORD_0"] =
        writer->AddAccessor(page.uv,
                            TINYGLTF_COMPONENT_TYPE_FLOAT,
                            TINYGLTF_TYPE_VEC2,
                            TINYGLTF_TARGET_ARRAY_BUFFER);
  }
  primitive.indices = writer->AddAccessor(page.indices,
                                          TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                          TINYGLTF_TYPE_SCALAR,
                                          TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  return primitive;
}

}  // namespace

void ExportGlb(const std::string& path,
               const TexturedMesh& model,
               const std::vector<std::string>& pages) {
  const bool textured = !model.face_uv.empty();
  const SeamVertices seams = SplitAtSeams(model);
  const std::vector<Vector3f> normals = SeamNormals(model.mesh, seams);
  tinygltf::Model gltf;
  gltf.asset.version = "2.0";
  gltf.asset.generator = "facet";
  gltf.extensionsUsed.push_back("KHR_materials_unlit");
  BufferWriter writer(&gltf);
  if (textured) {
    tinygltf::Sampler sampler;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    gltf.samplers.push_back(sampler);
  }
  tinygltf::Mesh mesh;
  mesh.name = "facet";
  const size_t num_pages = textured ? pages.size() : 1;
  for (size_t page = 0; page < num_pages; ++page) {
    const PageGeometry geometry =
        CollectPage(model, seams, normals, static_cast<int>(page));
    if (geometry.indices.empty()) continue;
    const int material =
        AddMaterial(textured ? &pages[page] : nullptr, &gltf, &writer);
    mesh.primitives.push_back(AddPrimitive(geometry, material, &gltf, &writer));
  }
  if (mesh.primitives.empty()) {
    throw UnsolvableError("a mesh without faces cannot be written as glTF");
  }
  gltf.meshes.push_back(mesh);
  tinygltf::Node node;
  node.mesh = 0;
  gltf.nodes.push_back(node);
  tinygltf::Scene scene;
  scene.nodes.push_back(0);
  gltf.scenes.push_back(scene);
  gltf.defaultScene = 0;
  if (gltf.buffers[0].data.size() > std::numeric_limits<uint32_t>::max() / 2) {
    throw UnsolvableError(
        "the textures are too large for one .glb file; raise the texel size");
  }
  WriteFileAtomically(path, [&](const std::string& temporary) {
    tinygltf::TinyGLTF gltf_writer;
    if (!gltf_writer.WriteGltfSceneToFile(
            &gltf, temporary, true, true, false, true)) {
      throw InputError("cannot write " + path +
                       ": check that the folder exists and has space");
    }
  });
}

}  // namespace facet
