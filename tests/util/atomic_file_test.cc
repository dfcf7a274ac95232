// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/atomic_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/support/temp_dir.h"
#include "util/errors.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

size_t FilesIn(const std::string& folder) {
  return static_cast<size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Breaks if text mode, string terminators or missing parent folders get in the
// way of the bytes.
TEST(AtomicFile, KeepsEveryByteAndMakesFolders) {
  const TempDir dir;
  const std::string path = dir / "a/b/data.bin";
  const std::string content("\0\r\n\xff\n\n", 6);
  WriteFileAtomically(path, content);
  EXPECT_EQ(ReadFile(path), content);
}

// Breaks if the target is opened before the new content is complete, or if a
// failed write leaves its temporary file behind.
TEST(AtomicFile, FailureLeavesTheOldFileAndNothingElse) {
  const TempDir dir;
  const std::string path = dir / "model.obj";
  WriteFileAtomically(path, "old");
  EXPECT_THROW(WriteFileAtomically(path,
                                   [](const std::string& temporary) {
                                     std::ofstream(temporary)
                                         << "half of the new";
                                     throw std::runtime_error("disk full");
                                   }),
               std::runtime_error);
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_EQ(FilesIn(dir.path()), 1u);
}

// Breaks if the temporary name loses the extension: image and mesh writers
// choose the format by it.
TEST(AtomicFile, TemporaryFileIsANeighbourWithTheSameExtension) {
  const TempDir dir;
  const fs::path path = dir / "page.png";
  fs::path temporary;
  WriteFileAtomically(path.string(), [&](const std::string& name) {
    temporary = name;
    std::ofstream(name) << "x";
  });
  EXPECT_EQ(temporary.parent_path(), path.parent_path());
  EXPECT_EQ(temporary.extension(), ".png");
  EXPECT_NE(temporary, path);
  EXPECT_FALSE(fs::exists(temporary));
}

// Breaks if errors of the file system reach main() as something it does not
// know (exit 1 instead of 3), or lose the path.
TEST(AtomicFile, UnwritableTargetIsAnInputErrorThatNamesIt) {
  const TempDir dir;
  WriteFileAtomically(dir / "file", "x");
  for (const std::string& path : {dir / "file/below.txt", dir.path()}) {
    try {
      WriteFileAtomically(path, "x");
      ADD_FAILURE() << path << " was written";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(dir.path()), std::string::npos);
    }
  }
  EXPECT_EQ(ReadFile(dir / "file"), "x");
}

// Breaks if a missing file reads as an empty one.
TEST(ReadFile, MissingFileAndFolderAreInputErrorsThatNameThePath) {
  const TempDir dir;
  for (const std::string& path : {dir / "missing.txt", dir.path()}) {
    try {
      ReadFile(path);
      ADD_FAILURE() << path << " was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace facet
