// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Quadric error metrics (Garland and Heckbert 1997; method, Sec. 3.2):
//
//   Q(v) = v' A v + 2 b' v + c                                        [m^4]
//
// A weighted sum of squared distances to planes, lines and points; the weights
// are areas [m^2], so Q / area is a mean squared distance.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace facet {

class Quadric {
 public:
  Quadric() = default;

  // Squared distance to the plane n.x + w = 0, |n| = 1.
  static Quadric Plane(const Eigen::Vector3d& n, double w, double weight) {
    Quadric q;
    q.xx_ = weight * n.x() * n.x();
    q.xy_ = weight * n.x() * n.y();
    q.xz_ = weight * n.x() * n.z();
    q.yy_ = weight * n.y() * n.y();
    q.yz_ = weight * n.y() * n.z();
    q.zz_ = weight * n.z() * n.z();
    q.b_ = weight * w * n;
    q.c_ = weight * w * w;
    return q;
  }

  // Squared distance to the line through p along e, |e| = 1:
  // A = I - e e', b = -A p, c = p' A p.
  static Quadric Line(const Eigen::Vector3d& p,
                      const Eigen::Vector3d& e,
                      double weight) {
    Quadric q;
    q.xx_ = weight * (1 - e.x() * e.x());
    q.xy_ = -weight * e.x() * e.y();
    q.xz_ = -weight * e.x() * e.z();
    q.yy_ = weight * (1 - e.y() * e.y());
    q.yz_ = -weight * e.y() * e.z();
    q.zz_ = weight * (1 - e.z() * e.z());
    q.b_ = -q.TimesA(p);
    q.c_ = -q.b_.dot(p);
    return q;
  }

  // Squared distance to the point p.
  static Quadric Point(const Eigen::Vector3d& p, double weight) {
    Quadric q;
    q.xx_ = q.yy_ = q.zz_ = weight;
    q.b_ = -weight * p;
    q.c_ = weight * p.squaredNorm();
    return q;
  }

  Quadric& operator+=(const Quadric& other) {
    xx_ += other.xx_;
    xy_ += other.xy_;
    xz_ += other.xz_;
    yy_ += other.yy_;
    yz_ += other.yz_;
    zz_ += other.zz_;
    b_ += other.b_;
    c_ += other.c_;
    return *this;
  }
  friend Quadric operator+(Quadric a, const Quadric& b) { return a += b; }

  // Rounding may leave a tiny negative number; costs must not be.
  double operator()(const Eigen::Vector3d& v) const {
    return std::max(0.0, v.dot(TimesA(v) + 2.0 * b_) + c_);
  }

  // The minimiser -A^-1 b. False, and *v untouched, where a pivot of A falls
  // below 1e-6 of its trace: then no single point is the best one.
  bool Minimum(Eigen::Vector3d* v) const {
    const double limit = 1e-6 * (xx_ + yy_ + zz_);
    if (!(xx_ > limit)) return false;
    const double l10 = xy_ / xx_, l20 = xz_ / xx_;
    const double d1 = yy_ - l10 * xy_;
    if (!(d1 > limit)) return false;
    const double t = yz_ - l10 * xz_;
    const double l21 = t / d1;
    const double d2 = zz_ - l20 * xz_ - l21 * t;
    if (!(d2 > limit)) return false;
    const double y0 = -b_.x();
    const double y1 = -b_.y() - l10 * y0;
    const double y2 = -b_.z() - l20 * y0 - l21 * y1;
    v->z() = y2 / d2;
    v->y() = y1 / d1 - l21 * v->z();
    v->x() = y0 / xx_ - l10 * v->y() - l20 * v->z();
    return true;
  }

 private:
  Eigen::Vector3d TimesA(const Eigen::Vector3d& v) const {
    return Eigen::Vector3d(xx_ * v.x() + xy_ * v.y() + xz_ * v.z(),
                           xy_ * v.x() + yy_ * v.y() + yz_ * v.z(),
                           xz_ * v.x() + yz_ * v.y() + zz_ * v.z());
  }

  double xx_ = 0, xy_ = 0, xz_ = 0, yy_ = 0, yz_ = 0, zz_ = 0;
  Eigen::Vector3d b_ = Eigen::Vector3d::Zero();
  double c_ = 0;
};

}  // namespace facet
