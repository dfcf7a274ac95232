// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes as Ceres parameter blocks: (n_x, n_y, n_z, d), |n| = 1, with d the
// signed distance of the plane's anchor (geometry/plane.h). Cost functions
// return ambient rows over the four numbers; how the block moves is the
// manifold's business alone, so that parametrisations can be compared with the
// same costs (method, Sec. 7.2).
#pragma once

#include <ceres/manifold.h>
#include <ceres/product_manifold.h>
#include <ceres/sphere_manifold.h>

#include <Eigen/Core>
#include <memory>

namespace facet {

inline constexpr int kPlaneSize = 4;

enum class PlaneKind {
  kAnchored,     // S^2 x R: n and the distance d of the anchor
  kRaw4,         // four free numbers (n, w), normalised after the solve (paper)
  kNormalised4,  // four free numbers (n, w), divided by |n| at every step
  kOrigin,       // S^2 x R: n and the distance w of the world's origin
  kUnit4,        // (n, w) / |(n, w)| on S^3: depends on the unit of length
};

using AnchoredPlaneManifold =
    ceres::ProductManifold<ceres::SphereManifold<3>,
                           ceres::EuclideanManifold<1>>;

// (n, w) <- ((n, w) + delta) / |n + delta_n|. Four numbers for three degrees of
// freedom: the Jacobian has rank 3 (its null vector is (n, w) itself), so
// solvers need damping. Minus(y, x) = y - x.
class NormalisedPlaneManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPlaneSize; }
  int TangentSize() const override { return kPlaneSize; }
  bool Plus(const double* x,
            const double* delta,
            double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y,
             const double* x,
             double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

// v = (n, w) / |(n, w)| moves on the sphere S^3. Steps that end at the plane at
// infinity (n = 0) fail.
class UnitVectorPlaneManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPlaneSize; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x,
            const double* delta,
            double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y,
             const double* x,
             double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  ceres::SphereManifold<4> sphere_;
};

// A manifold over (n, w) about the world's origin as one over blocks (n, d)
// about `anchor`: w = d - n.c is linear.
class PlaneAboutOrigin : public ceres::Manifold {
 public:
  PlaneAboutOrigin(std::unique_ptr<ceres::Manifold> inner,
                   const Eigen::Vector3d& anchor);
  int AmbientSize() const override { return kPlaneSize; }
  int TangentSize() const override { return inner_->TangentSize(); }
  bool Plus(const double* x,
            const double* delta,
            double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y,
             const double* x,
             double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  std::unique_ptr<ceres::Manifold> inner_;
  Eigen::Matrix4d to_origin_, to_anchor_;
};

// The manifold of a plane block about `anchor` (world, [m]). The caller, in
// general a ceres::Problem, owns it.
ceres::Manifold* CreatePlaneManifold(PlaneKind kind,
                                     const Eigen::Vector3d& anchor);

}  // namespace facet
