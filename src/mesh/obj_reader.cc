// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <charconv>
#include <cstdlib>
#include <limits>

#include "mesh/mesh_readers.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

// The words of one line.
class Words {
 public:
  Words(const char* at, const char* end) : at_(at), end_(end) {}

  // The next word, or false at the end of the line.
  bool Next(const char** word_begin, const char** word_end) {
    while (at_ < end_ && static_cast<unsigned char>(*at_) <= ' ') ++at_;
    if (at_ == end_) return false;
    *word_begin = at_;
    while (at_<end_&& static_cast<unsigned char>(*at_)> ' ') ++at_;
    *word_end = at_;
    return true;
  }

 private:
  const char* at_;
  const char* end_;
};

bool ParseNumber(const char* begin, const char* end, double* value) {
  if (begin < end && *begin == '+') ++begin;
  const auto result = std::from_chars(begin, end, *value);
  if (result.ec == std::errc::result_out_of_range) *value = 0;
  return result.ec != std::errc::invalid_argument && result.ptr == end;
}

// v, v/vt, v//vn or v/vt/vn; gives v as written.
bool ParseCorner(const char* begin, const char* end, long long* vertex) {
  auto result = std::from_chars(begin, end, *vertex);
  if (result.ec != std::errc() || *vertex == 0) return false;
  for (int part = 0; part < 2 && result.ptr < end; ++part) {
    if (*result.ptr != '/') return false;
    const char* at = result.ptr + 1;
    if (part == 0 && at < end && *at == '/') {  // v//vn
      result.ptr = at;
      continue;
    }
    long long ignored;
    result = std::from_chars(at, end, ignored);
    if (result.ec != std::errc()) return false;
  }
  return result.ptr == end;
}

class ObjParser {
 public:
  explicit ObjParser(const std::string& path) : path_(path) {}

  void Line(const char* begin, const char* end) {
    ++line_;
    Words words(begin, end);
    const char *at, *stop;
    if (!words.Next(&at, &stop) || stop - at != 1) return;
    if (*at == 'v') Vertex(&words);
    if (*at == 'f') Face(&words);
  }

  MeshFile Finish() {
    // Colours only if every vertex has one.
    if (file_.mesh.vertex_colors.size() != file_.mesh.NumVertices()) {
      file_.mesh.vertex_colors.clear();
    }
    if (no_triangle_ > 0) {
      AddWarning(path_ + ": " + std::to_string(no_triangle_) +
                 " faces with fewer than 3 corners were dropped");
    }
    return std::move(file_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(path_ + ": " + what + " in line " + std::to_string(line_) +
                     "; export the mesh again as OBJ");
  }

  // v x y z, v x y z w, or v x y z r g b with colours in [0, 1].
  void Vertex(Words* words) {
    double value[6];
    int count = 0;
    const char *at, *stop;
    while (count < 6 && words->Next(&at, &stop)) {
      if (!ParseNumber(at, stop, &value[count++])) Fail("not a number");
    }
    if (count < 3) Fail("a vertex with fewer than 3 coordinates");
    file_.mesh.vertices.emplace_back(value[0], value[1], value[2]);
    if (count == 6) {
      file_.mesh.vertex_colors.push_back({ColorByte(255 * value[3]),
                                          ColorByte(255 * value[4]),
                                          ColorByte(255 * value[5])});
    }
  }

  void Face(Words* words) {
    polygon_.clear();
    const char *at, *stop;
    while (words->Next(&at, &stop)) {
      if (*at == '#') break;
      long long v;
      if (!ParseCorner(at, stop, &v)) Fail("a bad face index");
      const long long count = static_cast<long long>(file_.mesh.NumVertices());
      v = v > 0 ? v - 1 : count + v;
      const bool fits = v >= 0 && v <= std::numeric_limits<int>::max();
      polygon_.push_back(fits ? static_cast<int>(v) : -1);
    }
    no_triangle_ += AppendFan(polygon_, &file_.mesh.faces) == 0;
  }

  const std::string& path_;
  size_t line_ = 0, no_triangle_ = 0;
  std::vector<int> polygon_;
  MeshFile file_;
};

}  // namespace

MeshFile ParseObj(const std::string& path, const std::string& content) {
  ObjParser parser(path);
  const char* at = content.data();
  const char* const end = at + content.size();
  while (at < end) {
    const char* stop = at;
    while (stop < end && *stop != '\n') ++stop;
    parser.Line(at, stop);
    at = stop + 1;
  }
  return parser.Finish();
}

}  // namespace facet
