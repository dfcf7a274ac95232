// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_c as Evaluation::kReference hands it to Ceres: an autodiff residual block
// an observation and channel (costs/photometric.h), in double, with Ceres's own
// losses. What the compressed blocks are checked and measured against.
#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <vector>

#include "costs/photometric.h"
#include "costs/plane_photometric_cost.h"
#include "problems/texture_problem.h"

namespace facet {

// weight * rho.
ceres::LossFunction* CreateReferenceLoss(const Formulation& formulation,
                                         double weight);

// The residual of `texel` in `image`, in the warp cell (a, b).
PhotometricCost MakeReferenceCost(const TextureProblem& problem,
                                  const SampledImage& image,
                                  int a,
                                  int b,
                                  uint32_t texel);

// The observations `segments` of plane `index` as functions of the block
// `plane`; the rest is that of `state`. `weight` multiplies rho.
void AddReferencePlane(const TextureProblem& problem,
                       const ReconState& state,
                       const std::vector<PlaneSegment>& segments,
                       int index,
                       double weight,
                       double* plane,
                       ceres::Problem* ceres_problem);

// The observations `ids` of a keyframe in the warp cell (a, b) as functions of
// `parameters`: the pose, and with warp the cell's four vertices.
void AddReferenceCell(const TextureProblem& problem,
                      const ReconState& state,
                      int keyframe,
                      int a,
                      int b,
                      const uint32_t* ids,
                      size_t num_ids,
                      double weight,
                      const std::vector<double*>& parameters,
                      ceres::Problem* ceres_problem);

}  // namespace facet
