// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The folder of an ablation: where things lie, what they were made from, and
// whether they are whole (ablate/ablation.h).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ablate/plan.h"
#include "ablate/run_result.h"

namespace facet {

// Marks are JSON objects with an "id", written when their folder is whole. One
// that is missing or cannot be read is null.
nlohmann::json ReadMark(const std::string& path);
bool HasMark(const std::string& path, const std::string& id);
void WriteMark(const std::string& path, const nlohmann::json& mark);

enum class Progress { kNothing, kReconstructed, kEvaluated };

class Layout {
 public:
  // The plan must outlive it.
  explicit Layout(const AblationPlan& plan);

  std::string ScanFolder(size_t scan) const;
  std::string StateFolder(size_t scan) const;
  // Path of facet-`name`.
  std::string Program(const std::string& name) const;

  std::string ScanId(size_t scan) const;
  std::string StateId(size_t scan) const;
  std::string EvaluationId(size_t scan) const;
  // Of the artefacts that runs begin from; empty while there is no state.
  std::string StateHash(size_t scan) const;
  // A run before it is read: its id comes from all its flags and the state, its
  // folder is the one of an earlier ablation with that id, or a new one.
  RunResult Run(size_t scan,
                size_t variant,
                const std::string& state_hash) const;
  Progress ProgressOf(const RunResult& run) const;
  // Tells builds of facet-reconstruct apart.
  const std::string& Build() const { return build_; }

 private:
  std::string Folder(const std::string& kind, size_t scan) const;

  const AblationPlan& plan_;
  std::string build_;
};

// Hash of the artefacts of a state.
std::string HashOfState(const std::string& state_folder);

// Gives a run folder the artefacts of a state.
void CopyState(const std::string& state_folder, const std::string& run_folder);

}  // namespace facet
