// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "mesh/mesh_readers.h"
#include "mesh/ply_header.h"
#include "util/warnings.h"

namespace facet {
namespace {

// The body of an ascii file, value by value.
class AsciiSource {
 public:
  AsciiSource(const std::string& path, const std::string& content, size_t begin)
      : path_(path),
        content_(content),
        at_(content.data() + begin),
        end_(content.data() + content.size()) {}

  double Next(PlyScalar) {
    while (at_ < end_ && static_cast<unsigned char>(*at_) <= ' ') ++at_;
    if (at_ < end_ && *at_ == '+') ++at_;
    double value = 0;
    const auto result = std::from_chars(at_, end_, value);
    const bool range = result.ec == std::errc::result_out_of_range;
    const bool ends =
        result.ptr == end_ || static_cast<unsigned char>(*result.ptr) <= ' ';
    if ((result.ec != std::errc() && !range) || !ends) {
      FailPly(path_,
              (at_ == end_ ? "the file ends too early, in line "
                           : "not a number in line ") +
                  std::to_string(Line()));
    }
    at_ = result.ptr;
    return range ? 0.0 : value;
  }
  // Bytes that a value takes at least, with its separator.
  size_t Remaining() const { return end_ - at_; }
  size_t MinBytes(PlyScalar) const { return 1; }

 private:
  size_t Line() const {
    size_t line = 1;
    for (const char* c = content_.data(); c < at_; ++c) line += *c == '\n';
    return line;
  }
  const std::string& path_;
  const std::string& content_;
  const char* at_;
  const char* end_;
};

// The body of a binary file; kBig reverses the bytes of every value.
template <bool kBig>
class BinarySource {
 public:
  BinarySource(const std::string& path,
               const std::string& content,
               size_t begin)
      : path_(path),
        begin_(content.data()),
        at_(begin_ + begin),
        end_(begin_ + content.size()) {}

  double Next(PlyScalar type) {
    switch (type) {
      case PlyScalar::kInt8:
        return Take<int8_t>();
      case PlyScalar::kUint8:
        return Take<uint8_t>();
      case PlyScalar::kInt16:
        return Take<int16_t>();
      case PlyScalar::kUint16:
        return Take<uint16_t>();
      case PlyScalar::kInt32:
        return Take<int32_t>();
      case PlyScalar::kUint32:
        return Take<uint32_t>();
      case PlyScalar::kFloat:
        return Take<float>();
      case PlyScalar::kDouble:
        return Take<double>();
    }
    return 0;
  }
  size_t Remaining() const { return end_ - at_; }
  size_t MinBytes(PlyScalar type) const {
    return kPlyScalarSize[static_cast<int>(type)];
  }

 private:
  template <typename T>
  T Take() {
    if (Remaining() < sizeof(T)) {
      FailPly(
          path_,
          "the file ends too early, at byte " + std::to_string(end_ - begin_));
    }
    unsigned char bytes[sizeof(T)];
    for (size_t k = 0; k < sizeof(T); ++k) {
      bytes[kBig ? sizeof(T) - 1 - k : k] = static_cast<unsigned char>(at_[k]);
    }
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }
  const std::string& path_;
  const char* begin_;
  const char* at_;
  const char* end_;
};

// An index as int; what no int can hold becomes -1, which cleaning counts.
int ToIndex(double value) {
  if (!(value >= 0) || value > std::numeric_limits<int>::max()) return -1;
  return static_cast<int>(value);
}

template <typename Source>
void ReadList(const std::string& path,
              const PlyProperty& property,
              Source* source,
              std::vector<int>* polygon) {
  const double count = source->Next(property.count_type);
  if (!(count >= 0) || count != std::floor(count) ||
      count > static_cast<double>(source->Remaining())) {
    FailPly(path, "a list with an impossible length");
  }
  polygon->clear();
  for (size_t k = 0; k < static_cast<size_t>(count); ++k) {
    const double value = source->Next(property.type);
    if (property.role == kPlyIndices) polygon->push_back(ToIndex(value));
  }
}

// A truncated file or an absurd count must fail before memory is reserved.
template <typename Source>
void CheckCount(const std::string& path,
                const PlyElement& element,
                const Source& source) {
  size_t bytes = 0;
  for (const PlyProperty& p : element.properties) {
    bytes += source.MinBytes(p.is_list ? p.count_type : p.type);
  }
  if (bytes == 0 ? element.count > 0
                 : element.count > source.Remaining() / bytes) {
    FailPly(path,
            "the file ends too early for its " + std::to_string(element.count) +
                " elements '" + element.name + "'");
  }
}

template <typename Source>
void ReadElement(const std::string& path,
                 const PlyElement& element,
                 Source* source,
                 MeshFile* file,
                 size_t* no_triangle) {
  CheckCount(path, element, *source);
  const bool is_vertex = element.name == "vertex";
  const bool is_face = element.name == "face";
  const bool colors = is_vertex && element.Has(kPlyRed) &&
                      element.Has(kPlyGreen) && element.Has(kPlyBlue);
  const bool planes = is_face && element.Has(kPlyPlaneId);
  if (is_vertex) file->mesh.vertices.reserve(element.count);
  if (colors) file->mesh.vertex_colors.reserve(element.count);
  if (is_face) file->mesh.faces.reserve(element.count);
  std::array<double, kPlyNumSlots> slot{};
  std::vector<int> polygon, ignored;
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& p : element.properties) {
      if (p.is_list) {
        ReadList(path, p, source, p.role == kPlyIndices ? &polygon : &ignored);
      } else if (p.role < kPlyNumSlots) {
        const bool unit = p.role >= kPlyRed && p.role <= kPlyBlue &&
                          p.type >= PlyScalar::kFloat;  // colours in [0, 1]
        slot[p.role] = source->Next(p.type) * (unit ? 255.0 : 1.0);
      } else {
        source->Next(p.type);
      }
    }
    if (is_vertex)
      file->mesh.vertices.emplace_back(slot[kPlyX], slot[kPlyY], slot[kPlyZ]);
    if (colors) {
      file->mesh.vertex_colors.push_back({ColorByte(slot[kPlyRed]),
                                          ColorByte(slot[kPlyGreen]),
                                          ColorByte(slot[kPlyBlue])});
    }
    if (!is_face) continue;
    const int made = AppendFan(polygon, &file->mesh.faces);
    *no_triangle += made == 0;
    if (planes) {
      const double id = slot[kPlyPlaneId];
      const bool fits = std::abs(id) < std::numeric_limits<int>::max();
      file->face_plane.insert(
          file->face_plane.end(), made, fits ? static_cast<int>(id) : -1);
    }
  }
}

template <typename Source>
MeshFile ReadBody(const std::string& path,
                  const PlyHeader& header,
                  Source source) {
  MeshFile file;
  size_t no_triangle = 0;
  for (const PlyElement& element : header.elements) {
    ReadElement(path, element, &source, &file, &no_triangle);
  }
  if (no_triangle > 0) {
    AddWarning(path + ": " + std::to_string(no_triangle) +
               " faces with fewer than 3 corners were dropped");
  }
  return file;
}

}  // namespace

MeshFile ParsePly(const std::string& path, const std::string& content) {
  const PlyHeader header = ParsePlyHeader(path, content);
  switch (header.format) {
    case PlyFormat::kAscii:
      return ReadBody(path, header, AsciiSource(path, content, header.body));
    case PlyFormat::kLittle:
      return ReadBody(
          path, header, BinarySource<false>(path, content, header.body));
    case PlyFormat::kBig:
      break;
  }
  return ReadBody(path, header, BinarySource<true>(path, content, header.body));
}

}  // namespace facet
