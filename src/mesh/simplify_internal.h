// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The collapsing loop behind SimplifyByPlanes. Internal to the simplification;
// OpenMesh stays behind simplify_kernel.h.
#pragma once

#include <memory>
#include <vector>

#include "mesh/simplify.h"

namespace facet {

class Collapser {
 public:
  // Throws UnsolvableError if the mesh is not manifold.
  Collapser(const TriMesh& mesh,
            const PlanarPartition& partition,
            const SimplifyOptions& options);
  ~Collapser();

  void RunCounts();
  void RunBudget();

  // Writes mesh (without colours), face labels and vertex births.
  void Extract(SimplifyResult* result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace facet
