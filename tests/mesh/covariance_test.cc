// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/covariance.h"

#include <gtest/gtest.h>

#include "util/random.h"

namespace facet {
namespace {

Eigen::Vector3d RandomPoint(Random* random, double scale) {
  return scale * Eigen::Vector3d(random->Uniform(-1, 1),
                                 random->Uniform(-1, 1),
                                 random->Uniform(-1, 1));
}

SurfaceMoments RandomTriangle(Random* random) {
  const Eigen::Vector3d far(3, -7, 20);
  return TriangleMoments(far + RandomPoint(random, 1),
                         far + RandomPoint(random, 1),
                         far + RandomPoint(random, 1));
}

void ExpectNear(const SurfaceMoments& a,
                const SurfaceMoments& b,
                double tolerance) {
  EXPECT_NEAR(a.area, b.area, tolerance * b.area);
  EXPECT_NEAR((a.centroid - b.centroid).norm(), 0, tolerance * 30);
  EXPECT_NEAR(
      (a.Covariance() - b.Covariance()).norm(), 0, tolerance * b.Trace());
}

// A wrong factor in the closed form: a triangle must have the moments of the
// pieces that subdivision makes of it, and of points strewn over it.
TEST(Covariance, TriangleEqualsItsPieces) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d a = RandomPoint(&random, 2),
                          b = RandomPoint(&random, 2),
                          c = RandomPoint(&random, 2);
    const Eigen::Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
    SurfaceMoments sum = TriangleMoments(a, ab, ca);
    sum = Union(sum, TriangleMoments(ab, b, bc));
    sum = Union(sum, TriangleMoments(ca, bc, c));
    sum = Union(sum, TriangleMoments(ab, bc, ca));
    ExpectNear(sum, TriangleMoments(a, b, c), 1e-12);
  }
}

TEST(Covariance, TriangleEqualsMonteCarlo) {
  Random random(2);
  const Eigen::Vector3d v0(0, 0, 0), v1(2, 0, 0.5), v2(0.3, 1, -0.4);
  const SurfaceMoments m = TriangleMoments(v0, v1, v2);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    double s = random.Uniform(), t = random.Uniform();
    if (s + t > 1) {
      s = 1 - s;
      t = 1 - t;
    }
    const Eigen::Vector3d d = v0 + s * (v1 - v0) + t * (v2 - v0) - m.centroid;
    sum += d * d.transpose();
  }
  EXPECT_NEAR((sum * m.area / n - m.Covariance()).norm(), 0, 0.01 * m.Trace());
}

// Determinant and trace spelled out with a wrong index.
TEST(Covariance, DeterminantAndTrace) {
  Random random(3);
  const SurfaceMoments m =
      Union(RandomTriangle(&random), RandomTriangle(&random));
  EXPECT_NEAR(m.Determinant(),
              m.Covariance().determinant(),
              1e-12 * std::pow(m.Trace(), 3));
  EXPECT_DOUBLE_EQ(m.Trace(), m.Covariance().trace());
}

// Parallel axes wrong: union must not depend on the order, and taking away what
// was added must lead back.
TEST(Covariance, UnionCommutesAndDifferenceInverts) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const SurfaceMoments a = RandomTriangle(&random),
                         b = RandomTriangle(&random),
                         c = RandomTriangle(&random);
    ExpectNear(Union(Union(a, b), c), Union(a, Union(c, b)), 1e-12);
    ExpectNear(Difference(Union(Union(a, b), c), c), Union(a, b), 1e-10);
    ExpectNear(Union(a, SurfaceMoments()), a, 0);
    ExpectNear(Union(SurfaceMoments(), a), a, 0);
  }
}

// The plane of a flat piece is exact, and its normal is on the side asked for.
TEST(Covariance, FitOfAFlatPieceIsExact) {
  const Eigen::Vector3d n = Eigen::Vector3d(1, -2, 3).normalized();
  const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u), o(5, 6, 7);
  const SurfaceMoments m =
      Union(TriangleMoments(o, o + u, o + v), TriangleMoments(o, o - u, o - v));
  for (double sign : {1.0, -1.0}) {
    const Plane plane = FitPlane(m, sign * n);
    EXPECT_NEAR((plane.normal - sign * n).norm(), 0, 1e-12);
    EXPECT_NEAR(plane.SignedDistance(o + u), 0, 1e-12);
  }
  EXPECT_NEAR(RmsHeight(m), 0, 1e-7);
}

// rms to a plane parallel at height h is sqrt(own^2 + h^2).
TEST(Covariance, RmsToShiftedPlane) {
  Random random(5);
  const SurfaceMoments m =
      Union(RandomTriangle(&random), RandomTriangle(&random));
  Plane plane = FitPlane(m, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(RmsToPlane(m, plane), RmsHeight(m), 1e-9);
  plane.offset += 0.3;
  EXPECT_NEAR(RmsToPlane(m, plane), std::hypot(RmsHeight(m), 0.3), 1e-9);
}

}  // namespace
}  // namespace facet
