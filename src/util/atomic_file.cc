// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/atomic_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "util/errors.h"

namespace facet {
namespace fs = std::filesystem;

void WriteFileAtomically(
    const std::string& path,
    const std::function<void(const std::string& temporary_path)>& write) {
  const fs::path target(path);
  std::error_code error;
  if (target.has_parent_path()) {
    fs::create_directories(target.parent_path(), error);
    if (error) {
      throw InputError("cannot create the folder " +
                       target.parent_path().string() + ": " + error.message());
    }
  }
  const fs::path temporary =
      target.parent_path() /
      ("." + target.stem().string() + ".partial" + std::to_string(getpid()) +
       target.extension().string());
  try {
    write(temporary.string());
    fs::rename(temporary, target);
  } catch (const fs::filesystem_error& e) {
    fs::remove(temporary, error);
    throw InputError("cannot write " + path + ": " + e.code().message());
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
}

void WriteFileAtomically(const std::string& path, const std::string& content) {
  WriteFileAtomically(path, [&](const std::string& temporary_path) {
    std::ofstream out(temporary_path, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) {
      throw InputError("cannot write " + path +
                       ": is the folder writable and the disk not full?");
    }
  });
}

std::string ReadFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  if (!in || fs::is_directory(path) || !(content << in.rdbuf())) {
    throw InputError("cannot read " + path +
                     ": it is missing, empty or not a file");
  }
  return std::move(content).str();
}

}  // namespace facet
