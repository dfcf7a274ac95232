// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The stages that need no images: from the file of the dense mesh to the light
// one (paper, Sec. 3). They leave the warnings to whoever runs them.
#pragma once

#include "pipeline/artefacts.h"
#include "pipeline/config.h"

namespace facet {

// The mesh of --mesh, cleaned and manifold, without a partition yet. Throws
// InputError that names the file.
MeshArtefact ReadDenseMesh(const ReconstructOptions& options);

// Planar clusters, merged to planes: fills `dense->partition` and what the
// stage has to report.
void PartitionDense(const ReconstructOptions& options, MeshArtefact* dense);

// The light mesh, with the colours of the vertices that are left.
MeshArtefact SimplifyDense(const ReconstructOptions& options,
                           const MeshArtefact& dense);

}  // namespace facet
