// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/archive.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

// An archive whose header is `header`, followed by `bytes`.
std::string RawArchive(const std::string& header, const std::string& bytes) {
  const uint64_t length = header.size();
  std::string content = "FACETAR1";
  content.append(reinterpret_cast<const char*>(&length), sizeof(length));
  return content + header + bytes;
}

// Breaks if a number goes through text or float on its way.
TEST(Archive, GivesBackEveryBit) {
  const TempDir dir;
  const std::vector<double> doubles = {
      0.1, -0.0, std::numeric_limits<double>::denorm_min(), 1e300};
  const std::vector<std::array<int, 3>> faces = {{0, 1, 2}, {2, 1, -7}};
  ArchiveWriter writer;
  writer.meta = {{"stage", "simplify"}, {"planes", 12}};
  writer.Add("doubles", doubles);
  writer.Add("empty", std::vector<float>());
  writer.Add("faces", faces);
  writer.Write(dir / "a.bin");
  const ArchiveReader reader(dir / "a.bin");
  EXPECT_EQ(reader.meta().at("planes").get<int>(), 12);
  const std::vector<double> back = reader.Get<double>("doubles");
  ASSERT_EQ(back.size(), doubles.size());
  EXPECT_EQ(std::memcmp(back.data(), doubles.data(), 8 * doubles.size()), 0);
  EXPECT_TRUE(reader.Get<float>("empty").empty());
  EXPECT_EQ((reader.Get<std::array<int, 3>>("faces")), faces);
}

// Breaks if an array of another version is reinterpreted.
TEST(Archive, MissingArrayOrOtherElementSizeIsAnInputError) {
  const TempDir dir;
  ArchiveWriter writer;
  writer.Add("x", std::vector<float>{1, 2});
  writer.Write(dir / "a.bin");
  const ArchiveReader reader(dir / "a.bin");
  EXPECT_THROW(reader.Get<double>("x"), InputError);
  EXPECT_THROW(reader.Get<float>("y"), InputError);
}

// Breaks if a damaged file reads beyond its end or throws something that main()
// does not know. Every truncation of a good file, and headers that lie.
TEST(Archive, DamagedFilesAreInputErrors) {
  const TempDir dir;
  ArchiveWriter writer;
  writer.Add("x", std::vector<double>{1, 2, 3});
  writer.Write(dir / "good.bin");
  const std::string good = ReadFile(dir / "good.bin");
  std::vector<std::string> bad;
  for (size_t n = 1; n < good.size(); ++n) bad.push_back(good.substr(0, n));
  bad.push_back("NOTFACET" + good.substr(8));
  bad.push_back(RawArchive("{\"meta\": 1, \"arrays\": 5}", ""));
  bad.push_back(RawArchive("{\"meta\": 1, \"arrays\": [{}]}", ""));
  bad.push_back(RawArchive(
      R"({"meta":1,"arrays":[{"name":"x","element_size":8,"count":-1}]})", ""));
  bad.push_back(RawArchive(
      R"({"meta":1,"arrays":[{"name":"x","element_size":0,"count":1}]})", ""));
  bad.push_back(RawArchive("[]", ""));
  for (size_t i = 0; i < bad.size(); ++i) {
    WriteFileAtomically(dir / "bad.bin", bad[i]);
    EXPECT_THROW(ArchiveReader(dir / "bad.bin"), InputError) << i;
  }
}

}  // namespace
}  // namespace facet
