// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Compiled once for each instruction set, with FACET_PRODUCT_NAMESPACE set.
// Eigen goes by a name of its own in each: its templates would otherwise have
// the same symbols everywhere, and the linker would keep those of any one file.
#if defined(EIGEN_CORE_H) || defined(EIGEN_CORE_MODULE_H)
#error "block_product_impl.h must come before Eigen"
#endif
#define Eigen FACET_PRODUCT_EIGEN
#include <Eigen/Core>

#include "problems/block_product.h"

namespace facet::FACET_PRODUCT_NAMESPACE {

extern void SubtractProduct(const BlockProduct& p);

void SubtractProduct(const BlockProduct& p) {
  using Stride = Eigen::OuterStride<>;
  using Input = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Stride>;
  using Output = Eigen::Map<Eigen::MatrixXd, Eigen::Unaligned, Stride>;
  const Stride stride(p.input_stride);
  Output(p.c, p.rows, p.cols, Stride(p.output_stride)).noalias() -=
      Input(p.a, p.depth, p.rows, stride).transpose() *
      Input(p.b, p.depth, p.cols, stride);
}

}  // namespace facet::FACET_PRODUCT_NAMESPACE
