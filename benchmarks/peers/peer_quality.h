// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// How good a result is, by the same measure for facet and its peers: computed
// from the faces or the labels alone, whatever the tool says of itself.
#pragma once

#include <vector>

#include "eval/mesh_distance.h"
#include "mesh/mesh_checks.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct SimplificationQuality {
  MeshDistance distance;  // to and from the dense mesh
  MeshChecks checks;
  // Of the area: its normal points away from that of the nearest dense face.
  double flipped_share = 0;
};

SimplificationQuality MeasureSimplification(const TriMesh& model,
                                            const TriMesh& dense,
                                            const MeshDistanceOptions& options);

struct PartitionQuality {
  size_t clusters = 0;
  double unlabelled_share = 0;  // of the area
  // Distance of the labelled surface to the least-squares plane of its cluster,
  // rms over the area, by exact integrals [m].
  double rms_m = 0;
};

// `label` by face, negative = no cluster. Throws UnsolvableError if no face has
// one.
PartitionQuality MeasurePartition(const TriMesh& mesh,
                                  const std::vector<int>& label);

}  // namespace facet
