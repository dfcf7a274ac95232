// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/obj_export.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "texture/seam_vertices.h"
#include "util/atomic_file.h"

namespace facet {
namespace {

std::string TextureName(size_t page) {
  return "texture_" + std::to_string(page) + ".png";
}

std::string MaterialName(size_t page) { return "page_" + std::to_string(page); }

std::string MtlText(size_t num_pages) {
  std::string text;
  for (size_t page = 0; page < num_pages; ++page) {
    text += "newmtl " + MaterialName(page) +
            "\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nd 1\nillum 1\nmap_Kd " +
            TextureName(page) + "\n\n";
  }
  return text;
}

template <typename... Args>
void AppendLine(std::string* text, const char* format, Args... args) {
  char line[160];
  const int length = std::snprintf(line, sizeof(line), format, args...);
  text->append(line, static_cast<size_t>(length));
}

std::string ObjText(const TexturedMesh& model) {
  const bool textured = !model.face_uv.empty();
  std::string text = "# facet\n";
  if (textured) text += "mtllib mesh.mtl\n";
  for (const auto& v : model.mesh.vertices) {
    AppendLine(&text, "v %.10g %.10g %.10g\n", v.x(), v.y(), v.z());
  }
  if (!textured) {
    for (const auto& f : model.mesh.faces) {
      AppendLine(&text, "f %d %d %d\n", f[0] + 1, f[1] + 1, f[2] + 1);
    }
    return text;
  }
  const SeamVertices seams = SplitAtSeams(model);
  for (const SeamVertex& v : seams.vertices) {
    const cv::Mat& page = model.pages[v.page];
    AppendLine(&text,
               "vt %.8f %.8f\n",
               static_cast<double>(v.uv.x()) / page.cols,
               1 - static_cast<double>(v.uv.y()) / page.rows);
  }
  for (size_t page = 0; page < model.pages.size(); ++page) {
    text += "usemtl " + MaterialName(page) + "\n";
    for (size_t f = 0; f < model.mesh.NumFaces(); ++f) {
      if (model.face_page[f] != static_cast<int>(page)) continue;
      const auto& v = model.mesh.faces[f];
      const auto& t = seams.corners[f];
      AppendLine(&text,
                 "f %d/%d %d/%d %d/%d\n",
                 v[0] + 1,
                 t[0] + 1,
                 v[1] + 1,
                 t[1] + 1,
                 v[2] + 1,
                 t[2] + 1);
    }
  }
  return text;
}

}  // namespace

void ExportObj(const std::string& dir,
               const TexturedMesh& model,
               const std::vector<std::string>& pages) {
  if (!model.face_uv.empty()) {
    for (size_t page = 0; page < pages.size(); ++page) {
      WriteFileAtomically(dir + "/" + TextureName(page), pages[page]);
    }
    WriteFileAtomically(dir + "/mesh.mtl", MtlText(model.pages.size()));
  }
  WriteFileAtomically(dir + "/mesh.obj", ObjText(model));
  // Pages of a larger model that was here before.
  size_t stale = model.face_uv.empty() ? 0 : model.pages.size();
  while (std::filesystem::remove(dir + "/" + TextureName(stale))) ++stale;
}

}  // namespace facet
