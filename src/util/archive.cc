// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/archive.h"

#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

constexpr char kMagic[9] = "FACETAR1";

}  // namespace

void ArchiveWriter::AddBytes(const std::string& name,
                             size_t element_size,
                             size_t count,
                             const void* data) {
  arrays_.push_back(
      {{"name", name}, {"element_size", element_size}, {"count", count}});
  if (count > 0) {
    bytes_.append(static_cast<const char*>(data), element_size * count);
  }
}

void ArchiveWriter::Write(const std::string& path) const {
  const std::string header =
      nlohmann::json{{"meta", meta}, {"arrays", arrays_}}.dump();
  const uint64_t length = header.size();
  std::string content(kMagic, 8);
  content.append(reinterpret_cast<const char*>(&length), sizeof(length));
  content += header;
  content += bytes_;
  WriteFileAtomically(path, content);
}

ArchiveReader::ArchiveReader(const std::string& path)
    : path_(path), bytes_(ReadFile(path)) {
  const auto fail = [&] {
    throw InputError(path + " is damaged: run the stage that writes it again");
  };
  uint64_t length = 0;
  if (bytes_.size() < 16 || bytes_.compare(0, 8, kMagic) != 0) fail();
  std::memcpy(&length, bytes_.data() + 8, sizeof(length));
  if (length > bytes_.size() - 16) fail();
  const nlohmann::json header = nlohmann::json::parse(
      bytes_.data() + 16, bytes_.data() + 16 + length, nullptr, false);
  if (!header.is_object() || !header.contains("meta") ||
      !header.contains("arrays")) {
    fail();
  }
  meta_ = header["meta"];
  size_t offset = 16 + length;
  try {
    for (const nlohmann::json& array : header["arrays"]) {
      const Entry entry = {array.at("element_size").get<size_t>(),
                           array.at("count").get<size_t>(),
                           offset};
      if (entry.element_size == 0 ||
          entry.count > (bytes_.size() - offset) / entry.element_size) {
        fail();
      }
      offset += entry.element_size * entry.count;
      entries_[array.at("name").get<std::string>()] = entry;
    }
  } catch (const nlohmann::json::exception&) {
    fail();
  }
}

const ArchiveReader::Entry& ArchiveReader::Find(const std::string& name,
                                                size_t element_size) const {
  const auto it = entries_.find(name);
  if (it == entries_.end() || it->second.element_size != element_size) {
    throw InputError(path_ + " has no array '" + name +
                     "' of the expected type: it was written by another "
                     "version of facet; run the stage again");
  }
  return it->second;
}

}  // namespace facet
