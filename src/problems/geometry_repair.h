// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Faces that the geometry step must not spoil (method, Sec. 8.5). Internal to
// FitGeometry.
#pragma once

#include <vector>

#include "problems/geometry_problem.h"

namespace facet {

// Blends vertices of spoilt faces - turned over against themselves or their
// plane, or collapsed - back towards where they were in `before`: v = v0 + t (v
// - v0), t is halved, and 0 after five times. Ends with no spoilt face, at the
// latest when all are back. Returns the number of vertices blended.
int RepairFaces(const TriMesh& before,
                const PlanarPartition& labels,
                const std::vector<Plane>& planes,
                TriMesh* mesh);

// Fills the counts of faces of the summary.
void CountSpoiltFaces(const TriMesh& before,
                      const PlanarPartition& labels,
                      const std::vector<Plane>& planes,
                      const TriMesh& mesh,
                      GeometrySummary* summary);

}  // namespace facet
