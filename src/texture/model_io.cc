// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/model_io.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <string_view>

#include "mesh/mesh_io.h"
#include "rgbd/image_files.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/text.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

struct Material {
  std::string image;  // path, empty = none
  cv::Vec3b color{128, 128, 128};
};

// Cuts the first word off `text`.
std::string_view NextWord(std::string_view* text) {
  *text = Trim(*text);
  const size_t end = std::min(text->find_first_of(" \t"), text->size());
  const std::string_view word = text->substr(0, end);
  text->remove_prefix(end);
  return word;
}

// Calls line(number, keyword, rest) for every line that is not a comment. A
// backslash at the end joins lines.
template <typename F>
void ForEachLine(const std::string& text, const F& line) {
  std::string joined;
  size_t begin = 0;
  for (int number = 1; begin < text.size(); ++number) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view view =
        Trim(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    if (!view.empty() && view.back() == '\\') {
      joined += std::string(view.substr(0, view.size() - 1)) + " ";
      continue;
    }
    std::string whole;
    if (!joined.empty()) {
      whole = joined + std::string(view);
      joined.clear();
      view = whole;
    }
    const std::string_view keyword = NextWord(&view);
    if (!keyword.empty() && keyword[0] != '#')
      line(number, keyword, Trim(view));
  }
}

template <typename T>
bool ParseNumber(std::string_view word, T* value) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto result =
      std::from_chars(word.data(), word.data() + word.size(), *value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

// The file name of a map_Kd line; options such as "-s 1 1 1" come before it.
std::string ImageName(std::string_view rest) {
  if (!rest.empty() && rest[0] == '-') {
    const size_t blank = rest.find_last_of(" \t");
    if (blank != std::string_view::npos) rest.remove_prefix(blank + 1);
  }
  std::string name(Trim(rest));
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

void ReadMaterials(const fs::path& path,
                   std::map<std::string, Material>* materials) {
  const std::string text = ReadFile(path.string());
  Material* material = nullptr;
  ForEachLine(text, [&](int, std::string_view keyword, std::string_view rest) {
    if (keyword == "newmtl") {
      material = &(*materials)[std::string(rest)];
    } else if (material != nullptr && keyword == "map_Kd") {
      material->image = (path.parent_path() / ImageName(rest)).string();
    } else if (material != nullptr && keyword == "Kd") {
      for (int k = 0; k < 3; ++k) {
        double value = 0;
        if (!ParseNumber(NextWord(&rest), &value)) break;
        material->color[k] = cv::saturate_cast<uchar>(255 * value);
      }
    }
  });
}

class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : path_(path) {}

  TexturedMesh Read() {
    const std::string text = ReadFile(path_);
    ForEachLine(text,
                [&](int number, std::string_view key, std::string_view rest) {
                  line_ = number;
                  ReadLine(key, rest);
                });
    TriMesh& mesh = model_.mesh;
    if (mesh.vertices.empty() || mesh.faces.empty()) {
      throw InputError("'" + path_ +
                       "' has no vertices or no faces: it is not a model");
    }
    if (mesh.vertex_colors.size() != mesh.vertices.size()) {
      mesh.vertex_colors.clear();
    }
    if (!any_label_) model_.face_plane.clear();
    AddTexture();
    return std::move(model_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError("'" + path_ + "', line " + std::to_string(line_) + ": " +
                     what);
  }

  void ReadLine(std::string_view keyword, std::string_view rest) {
    if (keyword == "v") {
      ReadVertex(rest);
    } else if (keyword == "vt") {
      Eigen::Vector2d uv;
      if (ReadNumbers(rest, uv.data(), 2) < 2) Fail("vt needs two numbers");
      uvs_.push_back(uv);
    } else if (keyword == "f") {
      ReadFace(rest);
    } else if (keyword == "usemtl") {
      const auto [it, is_new] = material_index_.try_emplace(
          std::string(rest), static_cast<int>(material_names_.size()));
      if (is_new) material_names_.push_back(it->first);
      material_ = it->second;
    } else if (keyword == "mtllib") {
      ReadMaterials(fs::path(path_).parent_path() / std::string(rest),
                    &materials_);
    } else if (keyword == "g" || keyword == "o") {
      label_ = -1;
      if (rest.rfind("plane_", 0) == 0) {
        any_label_ |= ParseNumber(rest.substr(6), &label_);
      }
    }
  }

  // Up to `count` numbers; how many there were.
  int ReadNumbers(std::string_view text, double* numbers, int count) const {
    int read = 0;
    for (; read < count; ++read) {
      const std::string_view word = NextWord(&text);
      if (word.empty()) break;
      if (!ParseNumber(word, &numbers[read])) {
        Fail("'" + std::string(word) + "' is not a number");
      }
      if (!std::isfinite(numbers[read])) Fail("a coordinate is not finite");
    }
    return read;
  }

  void ReadVertex(std::string_view rest) {
    double numbers[6];
    const int count = ReadNumbers(rest, numbers, 6);
    if (count < 3) Fail("v needs three numbers");
    model_.mesh.vertices.emplace_back(numbers[0], numbers[1], numbers[2]);
    if (count < 6) return;
    Rgb color;
    for (int k = 0; k < 3; ++k) {
      color[k] = cv::saturate_cast<uchar>(255 * numbers[3 + k]);
    }
    model_.mesh.vertex_colors.push_back(color);
  }

  // A 1-based or negative index as 0-based.
  int Index(std::string_view word, size_t count) const {
    long index = 0;
    if (!ParseNumber(word, &index))
      Fail("'" + std::string(word) + "': no index");
    index = index < 0 ? index + static_cast<long>(count) : index - 1;
    if (index < 0 || index >= static_cast<long>(count)) {
      Fail("index " + std::string(word) + " is out of range");
    }
    return static_cast<int>(index);
  }

  void ReadFace(std::string_view rest) {
    std::vector<int> corners, corner_uvs;
    while (true) {
      const std::string_view word = NextWord(&rest);
      if (word.empty()) break;
      const size_t slash = std::min(word.find('/'), word.size());
      corners.push_back(
          Index(word.substr(0, slash), model_.mesh.vertices.size()));
      std::string_view tail = word.substr(std::min(slash + 1, word.size()));
      tail = tail.substr(0, tail.find('/'));
      corner_uvs.push_back(tail.empty() ? -1 : Index(tail, uvs_.size()));
    }
    if (corners.size() < 3) Fail("a face needs three corners");
    for (size_t k = 2; k < corners.size(); ++k) {
      model_.mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
      face_uvs_.push_back({corner_uvs[0], corner_uvs[k - 1], corner_uvs[k]});
      face_material_.push_back(material_);
      model_.face_plane.push_back(label_);
    }
  }

  // Page of a material; the image is read when the first face asks for it.
  int Page(int material, bool with_uv) {
    const auto [it, is_new] = pages_.try_emplace(
        {material, with_uv}, static_cast<int>(pages_.size()));
    if (!is_new) return it->second;
    Material found;
    if (material >= 0) {
      const auto entry = materials_.find(material_names_[material]);
      if (entry != materials_.end()) found = entry->second;
    }
    model_.pages.push_back(with_uv && !found.image.empty()
                               ? ReadColorImage(found.image)
                               : cv::Mat(1, 1, CV_8UC3, found.color));
    return it->second;
  }

  bool HasImage(size_t face) const {
    const std::array<int, 3>& uv = face_uvs_[face];
    if (face_material_[face] < 0 ||
        *std::min_element(uv.begin(), uv.end()) < 0) {
      return false;
    }
    const auto it = materials_.find(material_names_[face_material_[face]]);
    return it != materials_.end() && !it->second.image.empty();
  }

  void AddTexture() {
    bool any_image = false;
    for (size_t f = 0; f < face_uvs_.size(); ++f) any_image |= HasImage(f);
    if (!any_image) return;
    for (size_t f = 0; f < face_uvs_.size(); ++f) {
      const bool has_image = HasImage(f);
      const int page = Page(face_material_[f], has_image);
      model_.face_page.push_back(page);
      std::array<Eigen::Vector2d, 3> uv;
      for (int k = 0; k < 3; ++k) {
        uv[k] = has_image ? uvs_[face_uvs_[f][k]] : Eigen::Vector2d(0.5, 0.5);
      }
      model_.face_uv.push_back(PagePixels(uv, model_.pages[page]));
    }
  }

  static std::array<Eigen::Vector2f, 3> PagePixels(
      const std::array<Eigen::Vector2d, 3>& uv, const cv::Mat& page) {
    const Eigen::Vector2d low = uv[0].cwiseMin(uv[1]).cwiseMin(uv[2]);
    const Eigen::Vector2d high = uv[0].cwiseMax(uv[1]).cwiseMax(uv[2]);
    // Half a texel of overhang is rounding, not tiling.
    const Eigen::Vector2d slack(0.5 / page.cols, 0.5 / page.rows);
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    for (int k = 0; k < 2; ++k) {
      if (low[k] < -slack[k] || high[k] > 1 + slack[k]) {
        shift[k] = std::floor(low[k] + slack[k]);
      }
    }
    std::array<Eigen::Vector2f, 3> pixels;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d p = uv[k] - shift;
      pixels[k] = Eigen::Vector2d(p.x() * page.cols, (1 - p.y()) * page.rows)
                      .cast<float>();
    }
    return pixels;
  }

  std::string path_;
  int line_ = 0;
  TexturedMesh model_;
  std::vector<Eigen::Vector2d> uvs_;
  std::vector<std::array<int, 3>> face_uvs_;  // -1 = none
  std::vector<int> face_material_;            // -1 = none
  std::map<std::string, Material> materials_;
  std::map<std::string, int> material_index_;
  std::vector<std::string> material_names_;
  std::map<std::pair<int, bool>, int> pages_;
  int material_ = -1, label_ = -1;
  bool any_label_ = false;
};

}  // namespace

TexturedMesh LoadModel(const std::string& path) {
  if (fs::is_directory(path)) {
    const std::string inside = (fs::path(path) / "mesh.obj").string();
    if (!fs::exists(inside)) {
      throw InputError("'" + path +
                       "' has no mesh.obj: give a run folder of "
                       "facet-reconstruct, an OBJ or a PLY file");
    }
    return LoadModel(inside);
  }
  std::string extension = fs::path(path).extension().string();
  std::transform(
      extension.begin(), extension.end(), extension.begin(), ::tolower);
  if (extension == ".obj") return ObjReader(path).Read();
  MeshFile file = ReadMesh(path);
  TexturedMesh model;
  model.mesh = std::move(file.mesh);
  model.face_plane = std::move(file.face_plane);
  // Soup as it is: faces that point nowhere would crash the ray caster.
  for (const std::array<int, 3>& f : model.mesh.faces) {
    for (const int v : f) {
      if (v < 0 || v >= static_cast<int>(model.mesh.NumVertices())) {
        throw InputError("'" + path + "': a face names vertex " +
                         std::to_string(v) + ", which does not exist");
      }
    }
  }
  for (const Eigen::Vector3d& v : model.mesh.vertices) {
    if (!v.allFinite()) {
      throw InputError("'" + path +
                       "': a vertex is not finite: clean the mesh first");
    }
  }
  return model;
}

bool HasColor(const TexturedMesh& model) {
  return !model.face_uv.empty() || !model.mesh.vertex_colors.empty();
}

}  // namespace facet
