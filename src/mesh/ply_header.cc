// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/ply_header.h"

#include <array>
#include <sstream>

#include "util/errors.h"

namespace facet {
namespace {

PlyScalar ParseScalar(const std::string& path, const std::string& name) {
  static const std::array<std::array<const char*, 2>, 8> kNames = {
      {{"char", "int8"},
       {"uchar", "uint8"},
       {"short", "int16"},
       {"ushort", "uint16"},
       {"int", "int32"},
       {"uint", "uint32"},
       {"float", "float32"},
       {"double", "float64"}}};
  for (size_t k = 0; k < kNames.size(); ++k) {
    if (name == kNames[k][0] || name == kNames[k][1]) {
      return static_cast<PlyScalar>(k);
    }
  }
  FailPly(path, "unknown scalar type '" + name + "' in the PLY header");
}

PlyRole RoleOf(const std::string& element, const std::string& name, bool list) {
  if (element == "face") {
    if (list) {
      return name == "vertex_indices" || name == "vertex_index" ? kPlyIndices
                                                                : kPlyIgnored;
    }
    return name == "plane_id" ? kPlyPlaneId : kPlyIgnored;
  }
  if (element != "vertex" || list) return kPlyIgnored;
  static const char* const kNames[] = {"x", "y", "z", "red", "green", "blue"};
  for (int k = 0; k < 6; ++k) {
    if (name == kNames[k]) return static_cast<PlyRole>(k);
  }
  return kPlyIgnored;
}

PlyProperty ParseProperty(const std::string& path,
                          const std::string& element,
                          std::istringstream* words) {
  PlyProperty property;
  std::string type, name;
  *words >> type;
  if (type == "list") {
    property.is_list = true;
    std::string count_type;
    *words >> count_type >> type;
    property.count_type = ParseScalar(path, count_type);
  }
  property.type = ParseScalar(path, type);
  if (!(*words >> name)) FailPly(path, "a property without name in the header");
  property.role = RoleOf(element, name, property.is_list);
  return property;
}

PlyFormat ParseFormat(const std::string& path, std::istringstream* words) {
  std::string name;
  *words >> name;
  if (name == "ascii") return PlyFormat::kAscii;
  if (name == "binary_little_endian") return PlyFormat::kLittle;
  if (name == "binary_big_endian") return PlyFormat::kBig;
  FailPly(path, "unknown PLY format '" + name + "'");
}

void CheckLayout(const std::string& path, const PlyHeader& header) {
  int vertex = 0, face = 0;
  for (const PlyElement& element : header.elements) {
    vertex += element.name == "vertex";
    face += element.name == "face";
    if (element.name == "vertex" &&
        !(element.Has(kPlyX) && element.Has(kPlyY) && element.Has(kPlyZ))) {
      FailPly(path, "its vertices lack x, y or z");
    }
    if (element.name == "face" && !element.Has(kPlyIndices)) {
      FailPly(path, "its faces lack the list vertex_indices");
    }
  }
  if (vertex > 1 || face > 1) FailPly(path, "an element is declared twice");
}

}  // namespace

void FailPly(const std::string& path, const std::string& what) {
  throw InputError(path + ": " + what + "; export the mesh again as PLY");
}

PlyHeader ParsePlyHeader(const std::string& path, const std::string& content) {
  PlyHeader header;
  size_t position = 0;
  bool has_format = false;
  for (int number = 1;; ++number) {
    const size_t end = content.find('\n', position);
    if (end == std::string::npos) FailPly(path, "the PLY header does not end");
    std::istringstream words(content.substr(position, end - position));
    position = end + 1;
    std::string word;
    words >> word;
    if (number == 1) {
      if (word != "ply")
        FailPly(path, "not a PLY file (no 'ply' at its start)");
    } else if (word == "format") {
      header.format = ParseFormat(path, &words);
      has_format = true;
    } else if (word == "element") {
      PlyElement element;
      if (!(words >> element.name >> element.count)) {
        FailPly(path, "bad element in header line " + std::to_string(number));
      }
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) {
        FailPly(path, "property before any element in the header");
      }
      PlyElement& element = header.elements.back();
      element.properties.push_back(ParseProperty(path, element.name, &words));
    } else if (word == "end_header") {
      break;
    } else if (!word.empty() && word != "comment" && word != "obj_info") {
      FailPly(path,
              "unknown word '" + word + "' in header line " +
                  std::to_string(number));
    }
  }
  if (!has_format) FailPly(path, "the PLY header names no format");
  header.body = position;
  CheckLayout(path, header);
  return header;
}

}  // namespace facet
