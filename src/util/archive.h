// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Named arrays in one binary file: how stages hand their results to a later run
// bit for bit (PLY would round vertices to float).
//
// Format: 8 bytes "FACETAR1", uint64 length of a JSON header, the header, then
// the arrays' bytes one after the other, little-endian. The header is
// {"meta": ..., "arrays": [{"name", "element_size", "count"}, ...]}.
#pragma once

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace facet {

class ArchiveWriter {
 public:
  nlohmann::json meta;  // free for the caller

  template <typename T>
  void Add(const std::string& name, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T> || std::is_class_v<T>);
    AddBytes(name, sizeof(T), values.size(), values.data());
  }
  // Written atomically.
  void Write(const std::string& path) const;

 private:
  void AddBytes(const std::string& name,
                size_t element_size,
                size_t count,
                const void* data);

  nlohmann::json arrays_ = nlohmann::json::array();
  std::string bytes_;
};

class ArchiveReader {
 public:
  // Throws InputError: missing, not an archive, truncated.
  explicit ArchiveReader(const std::string& path);

  const nlohmann::json& meta() const { return meta_; }

  // Throws InputError when the array is missing or of another element size.
  template <typename T>
  std::vector<T> Get(const std::string& name) const {
    const Entry& entry = Find(name, sizeof(T));
    std::vector<T> values(entry.count);
    if (entry.count > 0) {
      std::memcpy(static_cast<void*>(values.data()),
                  bytes_.data() + entry.offset,
                  entry.count * sizeof(T));
    }
    return values;
  }

 private:
  struct Entry {
    size_t element_size = 0, count = 0, offset = 0;
  };
  const Entry& Find(const std::string& name, size_t element_size) const;

  std::string path_, bytes_;
  nlohmann::json meta_;
  std::map<std::string, Entry> entries_;
};

}  // namespace facet
