// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/matrix.h"

#include <gtest/gtest.h>

#include <set>

#include "ablate/scans.h"
#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

using Flags = std::vector<std::pair<std::string, std::string>>;

std::vector<VaryAxis> Axes(const std::string& text) {
  return ParseVary(text, {});
}

// 2 x 3 x 2 combinations, each once, the first of each axis first.
TEST(Matrix, CrossIsTheProduct) {
  const std::vector<VaryAxis> axes = Axes("a=1,2; b=x,y,z; flags=--c=1,--c=2");
  const auto variants = ExpandMatrix(axes, Design::kCross, {"", "", ""});
  ASSERT_EQ(variants.size(), 12u);
  std::set<Flags> combinations;
  std::set<std::string> labels;
  for (const Variant& v : variants) {
    EXPECT_EQ(v.flags.size(), 3u);
    EXPECT_EQ(v.values.size(), 3u);
    combinations.insert(v.flags);
    labels.insert(v.label);
  }
  EXPECT_EQ(combinations.size(), 12u);
  EXPECT_EQ(labels.size(), 12u);
  EXPECT_EQ(variants[0].flags, (Flags{{"a", "1"}, {"b", "x"}, {"c", "1"}}));
}

// The default and, an axis at a time, what differs from it: 1 + 1 + 3. "1" is
// the default of a, none of b's values is that of b.
TEST(Matrix, OneAtATimeIsTheSum) {
  const std::vector<VaryAxis> axes = Axes("a=1,2; b=x,y,z");
  const auto variants = ExpandMatrix(axes, Design::kOneAtATime, {"1", ""});
  ASSERT_EQ(variants.size(), 5u);
  EXPECT_TRUE(variants[0].flags.empty());
  for (size_t i = 1; i < variants.size(); ++i) {
    EXPECT_EQ(variants[i].flags.size(), 1u) << variants[i].label;
  }
  EXPECT_EQ(variants[1].flags, (Flags{{"a", "2"}}));
  EXPECT_EQ(variants[1].values, (std::vector<std::string>{"2", "default"}));
}

TEST(Matrix, LabelsMustTellVariantsApart) {
  EXPECT_THROW(
      ExpandMatrix(Axes("a=m:{1},2; b=m:{3}"), Design::kOneAtATime, {"", ""}),
      OptionsError);
}

TEST(Scans, SyntheticOnesPairSeedsWithNoise) {
  const auto scans = SyntheticScans({1, 2, 3}, {2.5, 5}, {}, "/tmp/x");
  ASSERT_EQ(scans.size(), 6u);
  std::set<std::string> names, groups;
  for (const ScanSpec& scan : scans) {
    names.insert(scan.name);
    groups.insert(scan.group);
    EXPECT_EQ(scan.mesh.find("/tmp/x/" + scan.name + "/"), 0u);
  }
  EXPECT_EQ(names.size(), 6u);
  EXPECT_EQ(groups.size(), 2u) << "a group is a noise level";
  EXPECT_THROW(SyntheticScans({1}, {1, 2}, {0.5}, "x"), OptionsError);
}

TEST(Scans, FileRoundTripAndRefusals) {
  const TempDir dir;
  const auto read = [&](const std::string& text) {
    WriteFileAtomically(dir / "scans.json", text);
    return ReadScans(dir / "scans.json");
  };
  WriteFileAtomically(dir / "here.ply", "x");
  const auto scans = read(
      R"([{"name": "a-1", "sequence": ".", "mesh": "here.ply", "seed": 3,
           "flags": "--keyframe_window=1"}])");
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_EQ(scans[0].mesh, dir / "here.ply") << "relative to the file";
  EXPECT_EQ(scans[0].group, "a-1");
  EXPECT_EQ(scans[0].seed, 3);
  for (const char* text :
       {"{",
        "[]",
        "{}",
        "[1]",
        R"([{"name": "a", "sequence": "."}])",
        R"([{"name": "a", "sequence": ".", "mesh": "none.ply"}])",
        R"([{"name": "a/b", "sequence": ".", "mesh": "here.ply"}])",
        R"([{"name": "a", "sequence": ".", "mesh": "here.ply", "mash": ""}])",
        R"([{"name": "a", "sequence": ".", "mesh": "here.ply", "seed": "1"}])",
        R"([{"name": "a", "sequence": ".", "mesh": "here.ply"},
            {"name": "a", "sequence": ".", "mesh": "here.ply"}])"}) {
    EXPECT_THROW(read(text), InputError) << text;
  }
}

}  // namespace
}  // namespace facet
