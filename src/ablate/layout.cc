// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/layout.h"

#include <cctype>
#include <filesystem>

#include "util/atomic_file.h"
#include "util/hash.h"

namespace facet {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// The artefacts that runs begin from.
const char* const kStateFiles[] = {
    "stages/partition.bin", "stages/simplify.bin", "stages/keyframes.bin"};

std::string HashOf(const std::vector<std::string>& texts) {
  Hash64 hash;
  for (const std::string& text : texts) hash.Add(text);
  return hash.Text();
}

// Part of a file name that still tells the variant.
std::string Slug(const std::string& label) {
  std::string slug;
  for (const char c : label) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      slug += c;
    } else if (!slug.empty() && slug.back() != '-') {
      slug += '-';
    }
    if (slug.size() >= 40) break;
  }
  while (!slug.empty() && slug.back() == '-') slug.pop_back();
  return slug;
}

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() &&
         text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

json ReadMark(const std::string& path) {
  if (!fs::exists(path)) return json();
  const json mark = json::parse(ReadFile(path), nullptr, false);
  return mark.is_object() ? mark : json();
}

bool HasMark(const std::string& path, const std::string& id) {
  const json mark = ReadMark(path);
  return mark.is_object() && mark.value("id", "") == id;
}

void WriteMark(const std::string& path, const json& mark) {
  WriteFileAtomically(path, mark.dump(1) + "\n");
}

Layout::Layout(const AblationPlan& plan) : plan_(plan) {
  build_ = HashOf({ReadFile(Program("reconstruct"))});
}

std::string Layout::Folder(const std::string& kind, size_t scan) const {
  return plan_.folder + "/" + kind + "/" + plan_.scans[scan].spec.name;
}

std::string Layout::ScanFolder(size_t scan) const {
  return Folder("scans", scan);
}

std::string Layout::StateFolder(size_t scan) const {
  return Folder("states", scan);
}

std::string Layout::Program(const std::string& name) const {
  return plan_.programs + "/facet-" + name;
}

std::string Layout::ScanId(size_t scan) const {
  std::vector<std::string> texts = plan_.scans[scan].synthesize_args;
  const std::vector<std::string>& fuse = plan_.scans[scan].fuse_args;
  texts.insert(texts.end(), fuse.begin(), fuse.end());
  return HashOf(texts);
}

std::string Layout::StateId(size_t scan) const {
  return HashOf({plan_.scans[scan].state_settings, ScanId(scan)});
}

std::string Layout::EvaluationId(size_t scan) const {
  return HashOf(plan_.scans[scan].evaluate_args);
}

std::string Layout::StateHash(size_t scan) const {
  const json mark = ReadMark(StateFolder(scan) + "/state.json");
  if (!mark.is_object() || mark.value("id", "") != StateId(scan)) return "";
  return mark.value("hash", "");
}

RunResult Layout::Run(size_t scan,
                      size_t variant,
                      const std::string& state_hash) const {
  RunResult run;
  run.scan = scan;
  run.variant = variant;
  run.id = HashOf({plan_.scans[scan].run_flags[variant], state_hash});
  const std::string folder = Folder("runs", scan);
  const std::string end = "_" + run.id.substr(0, 8);
  run.folder = folder + "/" + Slug(plan_.variants[variant].label) + end;
  if (!fs::is_directory(folder)) return run;
  // The same settings under another label.
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (EndsWith(entry.path().string(), end)) run.folder = entry.path();
  }
  return run;
}

Progress Layout::ProgressOf(const RunResult& run) const {
  const json mark = ReadMark(run.folder + "/run.json");
  if (!mark.is_object() || mark.value("id", "") != run.id) {
    return Progress::kNothing;
  }
  return mark.value("evaluation", "") == EvaluationId(run.scan)
             ? Progress::kEvaluated
             : Progress::kReconstructed;
}

std::string HashOfState(const std::string& state_folder) {
  Hash64 hash;
  for (const char* file : kStateFiles) {
    hash.Add(ReadFile(state_folder + "/" + file));
  }
  return hash.Text();
}

// A link where the file system has them: facet replaces files and never writes
// into one, so the state stays what it is, and stages are large.
void CopyState(const std::string& state_folder, const std::string& run_folder) {
  fs::create_directories(run_folder + "/stages");
  for (const char* file : kStateFiles) {
    const std::string from = state_folder + "/" + file;
    const std::string to = run_folder + "/" + file;
    std::error_code error;
    fs::create_hard_link(from, to, error);
    if (error) fs::copy_file(from, to);
  }
}

}  // namespace facet
