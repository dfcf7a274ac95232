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

// At most, but for single larger clusters. Much smaller regions leave much to
// their seams; much larger ones do not fit into the cache.
constexpr int kFacesPerRegion = 40000;

// SimplifyByPlanes with regions of another size.
SimplifyResult SimplifyInRegions(const TriMesh& mesh,
                                 const PlanarPartition& partition,
                                 const SimplifyOptions& options,
                                 int faces_per_region);

class Collapser {
 public:
  // Throws UnsolvableError if the mesh is not manifold.
  Collapser(const TriMesh& mesh,
            const PlanarPartition& partition,
            const SimplifyOptions& options,
            int faces_per_region);
  ~Collapser();

  void RunCounts();
  void RunBudget();

  // Writes mesh (without colours), face labels and vertex births.
  void Extract(SimplifyResult* result) const;

 private:
  friend class CollapseTask;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace facet
