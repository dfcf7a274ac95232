// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/vary.h"

#include <gtest/gtest.h>

#include "util/errors.h"

namespace facet {
namespace {

std::vector<VaryAxis> Parse(const std::string& text) {
  return ParseVary(text, {});
}

// The message of the refusal; empty if the text is accepted.
std::string Refusal(const std::string& text, const VaryChecks& checks = {}) {
  try {
    ParseVary(text, checks);
  } catch (const OptionsError& e) {
    return e.what();
  }
  return "";
}

void ExpectSame(const std::vector<VaryAxis>& a,
                const std::vector<VaryAxis>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].flag, b[i].flag);
    ASSERT_EQ(a[i].values.size(), b[i].values.size());
    for (size_t k = 0; k < a[i].values.size(); ++k) {
      EXPECT_EQ(a[i].values[k].label, b[i].values[k].label);
      EXPECT_EQ(a[i].values[k].text, b[i].values[k].text);
    }
  }
}

TEST(Vary, SchedulesNeedNoQuotes) {
  const std::vector<VaryAxis> axes =
      Parse("plane=anchored, raw4; schedule=10x[C; Phi; T+F] | 4x[Phi; C+T]");
  ASSERT_EQ(axes.size(), 2u);
  EXPECT_EQ(axes[0].flag, "plane");
  ASSERT_EQ(axes[0].values.size(), 2u);
  EXPECT_EQ(axes[0].values[1].text, "raw4");
  EXPECT_EQ(axes[1].flag, "schedule");
  ASSERT_EQ(axes[1].values.size(), 2u);
  EXPECT_EQ(axes[1].values[0].text, "10x[C; Phi; T+F]");
  EXPECT_EQ(axes[1].values[1].text, "4x[Phi; C+T]");
  // Options of phases and groups come in braces of their own.
  const std::string text = "4x[C+T{iterations=3, x}; T]{stop=1e-3}";
  EXPECT_EQ(Parse("schedule=" + text + ",C")[0].values[0].text, text);
}

TEST(Vary, BracesQuoteAndLabelsName) {
  const std::vector<VaryAxis> axes =
      Parse("schedule=warm start:{3x[C]; 4x[C+T]},{ a|b },c;x={},y:{d,{e}}");
  ASSERT_EQ(axes.size(), 2u);
  ASSERT_EQ(axes[0].values.size(), 3u);
  EXPECT_EQ(axes[0].values[0].label, "warm start");
  EXPECT_EQ(axes[0].values[0].text, "3x[C]; 4x[C+T]");
  EXPECT_EQ(axes[0].values[1].text, " a|b ");
  EXPECT_EQ(axes[0].values[2].label, "c");
  EXPECT_EQ(axes[1].values[0].text, "");
  EXPECT_EQ(axes[1].values[1].text, "d,{e}");
}

// Breaks if ToString leaves out a quote that a value needs.
TEST(Vary, RoundTrip) {
  const std::vector<VaryAxis> nasty = {
      {"a",
       {{"plain", "plain"},
        {"x,y", "x,y"},
        {"x;y", "x;y"},
        {"x|y", "x|y"},
        {"", ""},
        {" spaced ", " spaced "},
        {"[in; side], out", "[in; side], out"},
        {"{braces}", "{braces}"},
        {"2x[C{n=3, m}]{stop=1}", "2x[C{n=3, m}]{stop=1}"},
        {"no:{label}", "no:{label}"},
        {"name", "1x[C]; 2x[T]"}}},
      {"flags", {{"two", "--p=1 --q={2}"}, {"--p=2", "--p=2"}}},
      {"b_2", {{"C:/path", "C:/path"}, {"f(a, b)", "f(a, b)"}}}};
  ExpectSame(Parse(ToString(nasty)), nasty);
  for (const char* text : {"plane=anchored,raw4",
                           "a=1|2|3;  b = x:{y} ,z;",
                           "schedule={3x[C; Phi]; T}, 2x[C;T] | p:{C}"}) {
    ExpectSame(Parse(ToString(Parse(text))), Parse(text));
  }
}

// The caret stands under the character that is named.
TEST(Vary, ErrorsPointAtTheCharacter) {
  const struct {
    const char* text;
    int character;
    const char* says;
  } kCases[] = {
      {"", 1, "expected a flag"},
      {"=1", 1, "expected a flag"},
      {"plane", 6, "expected '='"},
      {"plane=", 7, "expected a value"},
      {"plane=a,,b", 9, "expected a value"},
      {"a=1; a=2", 6, "twice"},
      {"a=1,2,1", 7, "twice"},
      {"a=x:{1},x:{2}", 9, "twice"},
      {"a=2x[C; T", 5, "nothing closes"},
      {"a={1", 3, "nothing closes"},
      {"a=[(])", 5, "expected ')'"},
      {"a=1]", 4, "nothing opens"},
      {"a=b{c", 4, "nothing closes"},
      {"a={b}c", 6, "expected ',' or '|' or ';'"},
  };
  for (const auto& c : kCases) {
    const std::string message = Refusal(c.text);
    EXPECT_NE(message.find(c.says), std::string::npos)
        << c.text << ": " << message;
    EXPECT_NE(message.find("at character " + std::to_string(c.character) + ":"),
              std::string::npos)
        << c.text << ": " << message;
    EXPECT_NE(message.find("\n  " + std::string(c.character - 1, ' ') + "^"),
              std::string::npos)
        << c.text << ": " << message;
  }
}

TEST(Vary, ChecksSayWhatIsPossible) {
  VaryChecks checks;
  checks.flag = [](const std::string& flag) {
    return flag == "plane" ? "" : "expected plane";
  };
  checks.value = [](const std::string&, const std::string& value) {
    return value == "raw4" ? "" : "expected raw4";
  };
  EXPECT_EQ(Refusal("plane=raw4", checks), "");
  EXPECT_NE(Refusal("plane=raw4; plan=1", checks)
                .find("expected plane at character 13"),
            std::string::npos);
  EXPECT_NE(
      Refusal("plane=raw4,raw5", checks).find("expected raw4 at character 12"),
      std::string::npos);
}

TEST(Vary, FlagSets) {
  const auto flags =
      ParseFlagSet(" --schedule=10x[C; Phi; T+F]  --a=b--c --empty= ");
  ASSERT_EQ(flags.size(), 3u);
  EXPECT_EQ(flags[0].first, "schedule");
  EXPECT_EQ(flags[0].second, "10x[C; Phi; T+F]");
  EXPECT_EQ(flags[1].second, "b--c");
  EXPECT_EQ(flags[2].second, "");
  EXPECT_TRUE(ParseFlagSet("  ").empty());
  for (const char* text : {"plane=raw4", "--plane", "--=1"}) {
    EXPECT_THROW(ParseFlagSet(text), OptionsError) << text;
  }
}

}  // namespace
}  // namespace facet
