// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes as Ceres parameter blocks: (n_x, n_y, n_z, d), |n| = 1, with d the
// signed distance of the plane's anchor (geometry/plane.h). Three degrees of
// freedom: S^2 x R. Cost functions return ambient rows over the four numbers.
#pragma once

#include <ceres/product_manifold.h>
#include <ceres/sphere_manifold.h>

namespace facet {

inline constexpr int kPlaneSize = 4;

using AnchoredPlaneManifold =
    ceres::ProductManifold<ceres::SphereManifold<3>, ceres::EuclideanManifold<1>>;

}  // namespace facet
