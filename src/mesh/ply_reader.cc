// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "mesh/mesh_readers.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

enum class Scalar {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat,
  kDouble
};
constexpr size_t kScalarSize[] = {1, 1, 2, 2, 4, 4, 4, 8};

// What a property means to us.
enum Role {
  kX,
  kY,
  kZ,
  kRed,
  kGreen,
  kBlue,
  kPlaneId,
  kNumSlots,
  kIndices = kNumSlots,
  kIgnored
};

struct Property {
  Scalar type = Scalar::kFloat;
  Scalar count_type = Scalar::kUint8;  // of a list
  bool is_list = false;
  Role role = kIgnored;
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;

  bool Has(Role role) const {
    for (const Property& p : properties) {
      if (p.role == role) return true;
    }
    return false;
  }
};

enum class Format { kAscii, kLittle, kBig };

struct Header {
  Format format = Format::kAscii;
  std::vector<Element> elements;
  size_t body = 0;  // first byte after the header
};

[[noreturn]] void Fail(const std::string& path, const std::string& what) {
  throw InputError(path + ": " + what + "; export the mesh again as PLY");
}

Scalar ParseScalar(const std::string& path, const std::string& name) {
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
      return static_cast<Scalar>(k);
    }
  }
  Fail(path, "unknown scalar type '" + name + "' in the PLY header");
}

Role RoleOf(const std::string& element, const std::string& name, bool list) {
  if (element == "face") {
    if (list) {
      return name == "vertex_indices" || name == "vertex_index" ? kIndices
                                                                : kIgnored;
    }
    return name == "plane_id" ? kPlaneId : kIgnored;
  }
  if (element != "vertex" || list) return kIgnored;
  static const char* const kNames[] = {"x", "y", "z", "red", "green", "blue"};
  for (int k = 0; k < 6; ++k) {
    if (name == kNames[k]) return static_cast<Role>(k);
  }
  return kIgnored;
}

Property ParseProperty(const std::string& path,
                       const std::string& element,
                       std::istringstream* words) {
  Property property;
  std::string type, name;
  *words >> type;
  if (type == "list") {
    property.is_list = true;
    std::string count_type;
    *words >> count_type >> type;
    property.count_type = ParseScalar(path, count_type);
  }
  property.type = ParseScalar(path, type);
  if (!(*words >> name)) Fail(path, "a property without name in the header");
  property.role = RoleOf(element, name, property.is_list);
  return property;
}

Format ParseFormat(const std::string& path, std::istringstream* words) {
  std::string name;
  *words >> name;
  if (name == "ascii") return Format::kAscii;
  if (name == "binary_little_endian") return Format::kLittle;
  if (name == "binary_big_endian") return Format::kBig;
  Fail(path, "unknown PLY format '" + name + "'");
}

Header ParseHeader(const std::string& path, const std::string& content) {
  Header header;
  size_t position = 0;
  bool has_format = false;
  for (int number = 1;; ++number) {
    const size_t end = content.find('\n', position);
    if (end == std::string::npos) Fail(path, "the PLY header does not end");
    std::istringstream words(content.substr(position, end - position));
    position = end + 1;
    std::string word;
    words >> word;
    if (number == 1) {
      if (word != "ply") Fail(path, "not a PLY file (no 'ply' at its start)");
    } else if (word == "format") {
      header.format = ParseFormat(path, &words);
      has_format = true;
    } else if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) {
        Fail(path, "bad element in header line " + std::to_string(number));
      }
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) {
        Fail(path, "property before any element in the header");
      }
      Element& element = header.elements.back();
      element.properties.push_back(ParseProperty(path, element.name, &words));
    } else if (word == "end_header") {
      break;
    } else if (!word.empty() && word != "comment" && word != "obj_info") {
      Fail(path,
           "unknown word '" + word + "' in header line " +
               std::to_string(number));
    }
  }
  if (!has_format) Fail(path, "the PLY header names no format");
  header.body = position;
  return header;
}

// The body of an ascii file, value by value.
class AsciiSource {
 public:
  AsciiSource(const std::string& path, const std::string& content, size_t begin)
      : path_(path),
        content_(content),
        at_(content.data() + begin),
        end_(content.data() + content.size()) {}

  double Next(Scalar) {
    while (at_ < end_ && static_cast<unsigned char>(*at_) <= ' ') ++at_;
    if (at_ < end_ && *at_ == '+') ++at_;
    double value = 0;
    const auto result = std::from_chars(at_, end_, value);
    const bool range = result.ec == std::errc::result_out_of_range;
    const bool ends =
        result.ptr == end_ || static_cast<unsigned char>(*result.ptr) <= ' ';
    if ((result.ec != std::errc() && !range) || !ends) {
      Fail(path_,
           (at_ == end_ ? "the file ends too early, in line "
                        : "not a number in line ") +
               std::to_string(Line()));
    }
    at_ = result.ptr;
    return range ? 0.0 : value;
  }
  // Bytes that a value takes at least, with its separator.
  size_t Remaining() const { return end_ - at_; }
  size_t MinBytes(Scalar) const { return 1; }

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

  double Next(Scalar type) {
    switch (type) {
      case Scalar::kInt8:
        return Take<int8_t>();
      case Scalar::kUint8:
        return Take<uint8_t>();
      case Scalar::kInt16:
        return Take<int16_t>();
      case Scalar::kUint16:
        return Take<uint16_t>();
      case Scalar::kInt32:
        return Take<int32_t>();
      case Scalar::kUint32:
        return Take<uint32_t>();
      case Scalar::kFloat:
        return Take<float>();
      case Scalar::kDouble:
        return Take<double>();
    }
    return 0;
  }
  size_t Remaining() const { return end_ - at_; }
  size_t MinBytes(Scalar type) const {
    return kScalarSize[static_cast<int>(type)];
  }

 private:
  template <typename T>
  T Take() {
    if (Remaining() < sizeof(T)) {
      Fail(path_,
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
              const Property& property,
              Source* source,
              std::vector<int>* polygon) {
  const double count = source->Next(property.count_type);
  if (!(count >= 0) || count != std::floor(count) ||
      count > static_cast<double>(source->Remaining())) {
    Fail(path, "a list with an impossible length");
  }
  polygon->clear();
  for (size_t k = 0; k < static_cast<size_t>(count); ++k) {
    const double value = source->Next(property.type);
    if (property.role == kIndices) polygon->push_back(ToIndex(value));
  }
}

// A truncated file or an absurd count must fail before memory is reserved.
template <typename Source>
void CheckCount(const std::string& path,
                const Element& element,
                const Source& source) {
  size_t bytes = 0;
  for (const Property& p : element.properties) {
    bytes += source.MinBytes(p.is_list ? p.count_type : p.type);
  }
  if (bytes == 0 ? element.count > 0
                 : element.count > source.Remaining() / bytes) {
    Fail(path,
         "the file ends too early for its " + std::to_string(element.count) +
             " elements '" + element.name + "'");
  }
}

template <typename Source>
void ReadElement(const std::string& path,
                 const Element& element,
                 Source* source,
                 MeshFile* file,
                 size_t* no_triangle) {
  CheckCount(path, element, *source);
  const bool is_vertex = element.name == "vertex";
  const bool is_face = element.name == "face";
  const bool colors = is_vertex && element.Has(kRed) && element.Has(kGreen) &&
                      element.Has(kBlue);
  const bool planes = is_face && element.Has(kPlaneId);
  if (is_vertex) file->mesh.vertices.reserve(element.count);
  if (colors) file->mesh.vertex_colors.reserve(element.count);
  if (is_face) file->mesh.faces.reserve(element.count);
  std::array<double, kNumSlots> slot{};
  std::vector<int> polygon, ignored;
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const Property& p : element.properties) {
      if (p.is_list) {
        ReadList(path, p, source, p.role == kIndices ? &polygon : &ignored);
      } else if (p.role < kNumSlots) {
        const bool unit = p.role >= kRed && p.role <= kBlue &&
                          p.type >= Scalar::kFloat;  // colours in [0, 1]
        slot[p.role] = source->Next(p.type) * (unit ? 255.0 : 1.0);
      } else {
        source->Next(p.type);
      }
    }
    if (is_vertex)
      file->mesh.vertices.emplace_back(slot[kX], slot[kY], slot[kZ]);
    if (colors) {
      file->mesh.vertex_colors.push_back({ColorByte(slot[kRed]),
                                          ColorByte(slot[kGreen]),
                                          ColorByte(slot[kBlue])});
    }
    if (!is_face) continue;
    const int made = AppendFan(polygon, &file->mesh.faces);
    *no_triangle += made == 0;
    if (planes) {
      const double id = slot[kPlaneId];
      const bool fits = std::abs(id) < std::numeric_limits<int>::max();
      file->face_plane.insert(
          file->face_plane.end(), made, fits ? static_cast<int>(id) : -1);
    }
  }
}

template <typename Source>
MeshFile ReadBody(const std::string& path,
                  const Header& header,
                  Source source) {
  MeshFile file;
  size_t no_triangle = 0;
  for (const Element& element : header.elements) {
    ReadElement(path, element, &source, &file, &no_triangle);
  }
  if (no_triangle > 0) {
    AddWarning(path + ": " + std::to_string(no_triangle) +
               " faces with fewer than 3 corners were dropped");
  }
  return file;
}

void CheckLayout(const std::string& path, const Header& header) {
  int vertex = 0, face = 0;
  for (const Element& element : header.elements) {
    vertex += element.name == "vertex";
    face += element.name == "face";
    if (element.name == "vertex" &&
        !(element.Has(kX) && element.Has(kY) && element.Has(kZ))) {
      Fail(path, "its vertices lack x, y or z");
    }
    if (element.name == "face" && !element.Has(kIndices)) {
      Fail(path, "its faces lack the list vertex_indices");
    }
  }
  if (vertex > 1 || face > 1) Fail(path, "an element is declared twice");
}

}  // namespace

MeshFile ParsePly(const std::string& path, const std::string& content) {
  const Header header = ParseHeader(path, content);
  CheckLayout(path, header);
  switch (header.format) {
    case Format::kAscii:
      return ReadBody(path, header, AsciiSource(path, content, header.body));
    case Format::kLittle:
      return ReadBody(
          path, header, BinarySource<false>(path, content, header.body));
    case Format::kBig:
      break;
  }
  return ReadBody(path, header, BinarySource<true>(path, content, header.body));
}

}  // namespace facet
