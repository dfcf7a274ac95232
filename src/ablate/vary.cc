// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/vary.h"

#include <cctype>

#include "util/errors.h"
#include "util/text.h"

namespace facet {
namespace {

bool IsSpace(char c) { return std::isspace(static_cast<unsigned char>(c)); }

bool IsNameChar(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

bool IsLabelChar(char c) {
  return IsNameChar(c) || IsSpace(c) || c == '-' || c == '.' || c == '+';
}

char Closing(char open) { return open == '[' ? ']' : open == '(' ? ')' : '}'; }

class Parser {
 public:
  Parser(const std::string& text, const VaryChecks& checks)
      : text_(text), checks_(checks) {}

  std::vector<VaryAxis> Parse() {
    std::vector<VaryAxis> axes;
    SkipSpace();
    if (AtEnd()) Fail(at_, "expected a flag");
    while (!AtEnd()) {
      axes.push_back(ParseAxis(axes));
      SkipSpace();
      if (AtEnd()) break;
      ++at_;  // the ';' at which the axis ended
      SkipSpace();
    }
    return axes;
  }

 private:
  [[noreturn]] void Fail(size_t at, const std::string& what) const {
    throw OptionsError("--vary: " + what + " at character " +
                       std::to_string(at + 1) + ":\n  " + text_ + "\n  " +
                       std::string(at, ' ') +
                       "^\nAxes look like plane=anchored,raw4; "
                       "schedule=4x[Phi; C+T],paper:{10x[C; Phi; T+F]}");
  }

  bool AtEnd() const { return at_ >= text_.size(); }
  bool At(char c) const { return !AtEnd() && text_[at_] == c; }
  bool AtSeparator() const { return At(',') || At('|'); }
  void SkipSpace() {
    while (!AtEnd() && IsSpace(text_[at_])) ++at_;
  }

  VaryAxis ParseAxis(const std::vector<VaryAxis>& before) {
    VaryAxis axis;
    const size_t start = at_;
    while (!AtEnd() && IsNameChar(text_[at_])) axis.flag += text_[at_++];
    if (axis.flag.empty()) Fail(at_, "expected a flag");
    for (const VaryAxis& other : before) {
      if (other.flag == axis.flag) {
        Fail(start, "'" + axis.flag + "' is there twice");
      }
    }
    if (checks_.flag) {
      const std::string problem = checks_.flag(axis.flag);
      if (!problem.empty()) Fail(start, problem);
    }
    SkipSpace();
    if (!At('=')) Fail(at_, "expected '=' after " + axis.flag);
    do {
      ++at_;  // '=' or a separator
      axis.values.push_back(ParseValue(axis));
      SkipSpace();
    } while (AtSeparator());
    if (!AtEnd() && !At(';')) Fail(at_, "expected ',' or '|' or ';'");
    return axis;
  }

  VaryValue ParseValue(const VaryAxis& axis) {
    SkipSpace();
    const size_t start = at_;
    VaryValue value;
    value.label = ParseLabel();
    if (At('{')) {
      const size_t open = at_;
      SkipBrackets();
      value.text = text_.substr(open + 1, at_ - open - 2);
    } else {
      value.text = PlainValue();
    }
    if (value.label.empty()) value.label = value.text;
    for (const VaryValue& other : axis.values) {
      if (other.text == value.text || other.label == value.label) {
        Fail(start, "'" + value.label + "' is there twice");
      }
    }
    if (checks_.value) {
      const std::string problem = checks_.value(axis.flag, value.text);
      if (!problem.empty()) Fail(start, problem);
    }
    return value;
  }

  // "label:" before a brace; otherwise nothing is read.
  std::string ParseLabel() {
    size_t end = at_;
    while (end < text_.size() && IsLabelChar(text_[end])) ++end;
    if (end == at_ || end >= text_.size() || text_[end] != ':') return "";
    size_t brace = end + 1;
    while (brace < text_.size() && IsSpace(text_[brace])) ++brace;
    if (brace >= text_.size() || text_[brace] != '{') return "";
    const std::string label(Trim(text_.substr(at_, end - at_)));
    at_ = brace;
    return label;
  }

  std::string PlainValue() {
    const size_t start = at_;
    while (!AtEnd() && !AtSeparator() && !At(';')) {
      if (At('}') || At(']') || At(')')) {
        Fail(at_, std::string("nothing opens this '") + text_[at_] + "'");
      }
      if (At('[') || At('(') || At('{')) {
        SkipBrackets();
      } else {
        ++at_;
      }
    }
    const std::string value(Trim(text_.substr(start, at_ - start)));
    if (value.empty()) Fail(start, "expected a value ({} is the empty one)");
    return value;
  }

  // From an opening bracket to behind the closing one.
  void SkipBrackets() {
    const size_t open = at_;
    const char closing = Closing(text_[at_++]);
    while (!AtEnd() && !At(closing)) {
      if (At('[') || At('(') || At('{')) {
        SkipBrackets();
      } else if (At(']') || At(')') || At('}')) {
        Fail(at_, std::string("expected '") + closing + "'");
      } else {
        ++at_;
      }
    }
    if (AtEnd()) {
      Fail(open, std::string("nothing closes this '") + text_[open] + "'");
    }
    ++at_;
  }

  const std::string& text_;
  const VaryChecks& checks_;
  size_t at_ = 0;
};

// Whether PlainValue reads exactly `text`.
bool IsPlain(const std::string& text) {
  if (text.empty() || Trim(text) != text || text[0] == '{') return false;
  int depth = 0;
  char before = ' ';
  for (const char c : text) {
    if (c == '{' && before == ':') return false;  // looks like a label
    if (!IsSpace(c)) before = c;
    if (c == '[' || c == '(' || c == '{') ++depth;
    if (c == ']' || c == ')' || c == '}') --depth;
    if (depth == 0 && (c == ',' || c == '|' || c == ';')) return false;
  }
  return true;
}

}  // namespace

std::vector<VaryAxis> ParseVary(const std::string& text,
                                const VaryChecks& checks) {
  return Parser(text, checks).Parse();
}

std::string ToString(const std::vector<VaryAxis>& axes) {
  std::string text;
  for (const VaryAxis& axis : axes) {
    text += (text.empty() ? "" : "; ") + axis.flag + "=";
    for (size_t i = 0; i < axis.values.size(); ++i) {
      const VaryValue& value = axis.values[i];
      if (i > 0) text += ",";
      if (value.label != value.text) {
        text += value.label + ":{" + value.text + "}";
      } else {
        text += IsPlain(value.text) ? value.text : "{" + value.text + "}";
      }
    }
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> ParseFlagSet(
    const std::string& text) {
  std::vector<std::pair<std::string, std::string>> flags;
  std::string rest(Trim(text));
  while (!rest.empty()) {
    size_t end = rest.find("--", 2);
    while (end != std::string::npos && !IsSpace(rest[end - 1])) {
      end = rest.find("--", end + 2);
    }
    const std::string part(Trim(rest.substr(0, end)));
    rest = end == std::string::npos ? "" : rest.substr(end);
    const size_t equals = part.find('=');
    if (part.compare(0, 2, "--") != 0 || equals == std::string::npos ||
        equals == 2) {
      throw OptionsError("'" + part + "' in '" + text +
                         "' is no flag: write --name=value --name=value");
    }
    flags.emplace_back(part.substr(2, equals - 2), part.substr(equals + 1));
  }
  return flags;
}

}  // namespace facet
