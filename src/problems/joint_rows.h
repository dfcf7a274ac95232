// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Derivatives of one observation's intensity in the joint solve, from the
// gradient (g1, g2) along the plane's axes that the kernel gives (method,
// Sec. 7.2; design of the joint solve: problems/joint_pass.h).
//
// With q the plane point, all relative to the problem's origin, and
// G = g1 e1 + g2 e2 + gn n the gradient of the intensity in q, which is 0 along
// the viewing direction d = q - camera centre:
//
//   gn          = -(g1 e1.d + g2 e2.d) / (n.d)
//   pose row    (y x RG, RG),   y = R q + t                       left tangent
//   plane row   (-gn (p - c) - s G, -gn),   s = n.(p - q)         ambient (n,
//   d)
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "problems/texture_problem.h"
#include "problems/tile_samples.h"

namespace facet {

// A keyframe's pose in double, world coordinates relative to the origin.
struct FramePose {
  Eigen::Matrix3d r;
  Eigen::Vector3d t, center;
};

std::vector<FramePose> MakeFramePoses(const TextureProblem& problem,
                                      const ReconState& state);

// In-plane axes e1, e2 with n: an orthonormal frame.
struct PlaneFrame {
  Eigen::Vector3d n, e1, e2;
  explicit PlaneFrame(const double* plane)
      : n(Eigen::Map<const Eigen::Vector3d>(plane).normalized()),
        e1(n.unitOrthogonal()),
        e2(n.cross(e1)) {}

  // gn.
  double AlongNormal(double g1, double g2, const Eigen::Vector3d& d) const {
    return -(g1 * d.dot(e1) + g2 * d.dot(e2)) / d.dot(n);
  }
};

// e1, e2 of every plane.
std::vector<PlaneAxes> AxesOfPlanes(const TextureProblem& problem,
                                    const ReconState& state);

}  // namespace facet
