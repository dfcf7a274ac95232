// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The header of a PLY file: which values follow, in which order and type.
// Internal to the reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace facet {

enum class PlyScalar {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat,
  kDouble
};
inline constexpr size_t kPlyScalarSize[] = {1, 1, 2, 2, 4, 4, 4, 8};

// What a property means to us.
enum PlyRole {
  kPlyX,
  kPlyY,
  kPlyZ,
  kPlyRed,
  kPlyGreen,
  kPlyBlue,
  kPlyPlaneId,
  kPlyNumSlots,
  kPlyIndices = kPlyNumSlots,
  kPlyIgnored
};

struct PlyProperty {
  PlyScalar type = PlyScalar::kFloat;
  PlyScalar count_type = PlyScalar::kUint8;  // of a list
  bool is_list = false;
  PlyRole role = kPlyIgnored;
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool Has(PlyRole role) const {
    for (const PlyProperty& p : properties) {
      if (p.role == role) return true;
    }
    return false;
  }
};

enum class PlyFormat { kAscii, kLittle, kBig };

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t body = 0;  // first byte after the header
};

// Throws InputError naming the file.
[[noreturn]] void FailPly(const std::string& path, const std::string& what);

// Any elements and properties may stand in any order; there must be no second
// vertex or face element, and these need x, y, z and a list of indices. Throws
// InputError.
PlyHeader ParsePlyHeader(const std::string& path, const std::string& content);

}  // namespace facet
