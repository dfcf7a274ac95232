// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Paint styles that depend on the size of their surface: printed matter and the
// view out of the window. Arguments as in EvaluatePaint.
#pragma once

#include "synth/paint.h"

namespace facet {

Eigen::Vector3f PaintPoster(const Paint& p,
                            float u,
                            float v,
                            const Eigen::Vector2f& size);
Eigen::Vector3f PaintPrint(const Paint& p,
                           float u,
                           float v,
                           const Eigen::Vector2f& size);
Eigen::Vector3f PaintCover(const Paint& p,
                           float u,
                           float v,
                           const Eigen::Vector2f& size);
Eigen::Vector3f PaintCardboard(const Paint& p,
                               float u,
                               float v,
                               const Eigen::Vector2f& size);
Eigen::Vector3f PaintOutside(const Paint& p,
                             float u,
                             float v,
                             const Eigen::Vector2f& size);

}  // namespace facet
