// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/plane_manifold.h"

#include <utility>

namespace facet {
namespace {

using Vector4 = Eigen::Map<Eigen::Vector4d>;
using ConstVector4 = Eigen::Map<const Eigen::Vector4d>;
template <int Rows, int Columns>
using RowMajor = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;
using RowMajor4X = RowMajor<4, Eigen::Dynamic>;
using RowMajorX4 = RowMajor<Eigen::Dynamic, 4>;

constexpr double kShortestNormal = 1e-12;

// d(x / |n|) / dx.
Eigen::Matrix4d NormalisationJacobian(const Eigen::Vector4d& x) {
  const double length = x.head<3>().norm();
  Eigen::Matrix4d j = Eigen::Matrix4d::Identity();
  j.leftCols<3>() -= x * x.head<3>().transpose() / (length * length);
  return j / length;
}

}  // namespace

bool NormalisedPlaneManifold::Plus(const double* x,
                                   const double* delta,
                                   double* x_plus_delta) const {
  const Eigen::Vector4d sum = ConstVector4(x) + ConstVector4(delta);
  const double length = sum.head<3>().norm();
  if (!(length > kShortestNormal)) return false;
  Vector4 result(x_plus_delta);
  result = sum / length;
  return true;
}

bool NormalisedPlaneManifold::PlusJacobian(const double* x,
                                           double* jacobian) const {
  Eigen::Map<RowMajor<4, 4>> j(jacobian);
  j = NormalisationJacobian(ConstVector4(x));
  return true;
}

bool NormalisedPlaneManifold::Minus(const double* y,
                                    const double* x,
                                    double* y_minus_x) const {
  Vector4 result(y_minus_x);
  result = ConstVector4(y) - ConstVector4(x);
  return true;
}

bool NormalisedPlaneManifold::MinusJacobian(const double* /*x*/,
                                            double* jacobian) const {
  Eigen::Map<RowMajor<4, 4>> j(jacobian);
  j.setIdentity();
  return true;
}

bool UnitVectorPlaneManifold::Plus(const double* x,
                                   const double* delta,
                                   double* x_plus_delta) const {
  const Eigen::Vector4d unit = ConstVector4(x).normalized();
  Vector4 result(x_plus_delta);
  if (!sphere_.Plus(unit.data(), delta, x_plus_delta)) return false;
  const double length = result.head<3>().norm();
  if (!(length > kShortestNormal)) return false;
  result /= length;
  return true;
}

bool UnitVectorPlaneManifold::PlusJacobian(const double* x,
                                           double* jacobian) const {
  const Eigen::Vector4d unit = ConstVector4(x).normalized();
  RowMajor<4, 3> on_sphere;
  sphere_.PlusJacobian(unit.data(), on_sphere.data());
  Eigen::Map<RowMajor<4, 3>> j(jacobian);
  j = NormalisationJacobian(unit) * on_sphere;
  return true;
}

bool UnitVectorPlaneManifold::Minus(const double* y,
                                    const double* x,
                                    double* y_minus_x) const {
  const Eigen::Vector4d from = ConstVector4(x).normalized();
  const Eigen::Vector4d to = ConstVector4(y).normalized();
  return sphere_.Minus(to.data(), from.data(), y_minus_x);
}

bool UnitVectorPlaneManifold::MinusJacobian(const double* x,
                                            double* jacobian) const {
  const ConstVector4 v(x);
  const double length = v.norm();
  const Eigen::Vector4d unit = v / length;
  RowMajor<3, 4> on_sphere;
  sphere_.MinusJacobian(unit.data(), on_sphere.data());
  Eigen::Map<RowMajor<3, 4>> j(jacobian);
  j = on_sphere * (Eigen::Matrix4d::Identity() - unit * unit.transpose()) /
      length;
  return true;
}

PlaneAboutOrigin::PlaneAboutOrigin(std::unique_ptr<ceres::Manifold> inner,
                                   const Eigen::Vector3d& anchor)
    : inner_(std::move(inner)),
      to_origin_(Eigen::Matrix4d::Identity()),
      to_anchor_(Eigen::Matrix4d::Identity()) {
  to_origin_.bottomLeftCorner<1, 3>() = -anchor.transpose();
  to_anchor_.bottomLeftCorner<1, 3>() = anchor.transpose();
}

bool PlaneAboutOrigin::Plus(const double* x,
                            const double* delta,
                            double* x_plus_delta) const {
  const Eigen::Vector4d from = to_origin_ * ConstVector4(x);
  Eigen::Vector4d to;
  if (!inner_->Plus(from.data(), delta, to.data())) return false;
  Vector4 result(x_plus_delta);
  result = to_anchor_ * to;
  return true;
}

bool PlaneAboutOrigin::PlusJacobian(const double* x, double* jacobian) const {
  const Eigen::Vector4d at = to_origin_ * ConstVector4(x);
  RowMajor4X inner(4, TangentSize());
  if (!inner_->PlusJacobian(at.data(), inner.data())) return false;
  Eigen::Map<RowMajor4X> j(jacobian, 4, TangentSize());
  j.noalias() = to_anchor_ * inner;
  return true;
}

bool PlaneAboutOrigin::Minus(const double* y,
                             const double* x,
                             double* y_minus_x) const {
  const Eigen::Vector4d to = to_origin_ * ConstVector4(y);
  const Eigen::Vector4d from = to_origin_ * ConstVector4(x);
  return inner_->Minus(to.data(), from.data(), y_minus_x);
}

bool PlaneAboutOrigin::MinusJacobian(const double* x, double* jacobian) const {
  const Eigen::Vector4d at = to_origin_ * ConstVector4(x);
  RowMajorX4 inner(TangentSize(), 4);
  if (!inner_->MinusJacobian(at.data(), inner.data())) return false;
  Eigen::Map<RowMajorX4> j(jacobian, TangentSize(), 4);
  j.noalias() = inner * to_origin_;
  return true;
}

ceres::Manifold* CreatePlaneManifold(PlaneKind kind,
                                     const Eigen::Vector3d& anchor) {
  std::unique_ptr<ceres::Manifold> inner;
  switch (kind) {
    case PlaneKind::kAnchored:
      return new AnchoredPlaneManifold;
    case PlaneKind::kRaw4:
      inner = std::make_unique<ceres::EuclideanManifold<4>>();
      break;
    case PlaneKind::kNormalised4:
      inner = std::make_unique<NormalisedPlaneManifold>();
      break;
    case PlaneKind::kOrigin:
      inner = std::make_unique<AnchoredPlaneManifold>();
      break;
    case PlaneKind::kUnit4:
      inner = std::make_unique<UnitVectorPlaneManifold>();
      break;
  }
  return new PlaneAboutOrigin(std::move(inner), anchor);
}

}  // namespace facet
