// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The image warp of the paper (Eq. main), after Zhou and Koltun 2014:
//
//   F(u) = u + sum_l delta_l(u) f_l           [px]
//
// with delta_l the bilinear hat functions of a lattice of `columns` x `rows`
// control vertices whose outer ones lie on the image border: cell size
// (W-1)/(columns-1) by (H-1)/(rows-1). The 20 x 16 of the paper counts
// vertices; with the pose that makes 6 + 640 unknowns a frame, as published.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace facet {

// Where a pixel lies in the lattice: cell (a, b) and local coordinates.
struct WarpCell {
  int a = 0, b = 0;            // cell column and row
  double alpha = 0, beta = 0;  // in [0, 1] inside the image
};

struct WarpLattice {
  int columns = 20, rows = 16;  // control vertices
  int width = 0, height = 0;    // of the image [px]

  int NumVertices() const { return columns * rows; }
  int NumCells() const { return (columns - 1) * (rows - 1); }
  double CellWidth() const { return (width - 1.0) / (columns - 1); }
  double CellHeight() const { return (height - 1.0) / (rows - 1); }
  int VertexIndex(int column, int row) const { return row * columns + column; }
  int CellIndex(int a, int b) const { return b * (columns - 1) + a; }

  // The cell of u. Points outside the image belong to the nearest cell with
  // local coordinates beyond [0, 1]: the field continues as a polynomial.
  WarpCell Locate(double u, double v) const {
    WarpCell cell;
    const double x = u / CellWidth(), y = v / CellHeight();
    cell.a = std::clamp(static_cast<int>(x), 0, columns - 2);
    cell.b = std::clamp(static_cast<int>(y), 0, rows - 2);
    cell.alpha = x - cell.a;
    cell.beta = y - cell.b;
    return cell;
  }

  // F(u) for the field f: NumVertices() pairs (f_x, f_y), row-major.
  template <typename T>
  Eigen::Matrix<T, 2, 1> Apply(const T* f,
                               const Eigen::Matrix<T, 2, 1>& u) const {
    const T x = u.x() * T(columns - 1) / T(width - 1);
    const T y = u.y() * T(rows - 1) / T(height - 1);
    const int a = std::clamp(static_cast<int>(x), 0, columns - 2);
    const int b = std::clamp(static_cast<int>(y), 0, rows - 2);
    const T alpha = x - T(a), beta = y - T(b);
    const T* f00 = f + 2 * VertexIndex(a, b);
    const T* f01 = f00 + 2 * columns;
    const T w00 = (1 - alpha) * (1 - beta), w10 = alpha * (1 - beta);
    const T w01 = (1 - alpha) * beta, w11 = alpha * beta;
    return {u.x() + w00 * f00[0] + w10 * f00[2] + w01 * f01[0] + w11 * f01[2],
            u.y() + w00 * f00[1] + w10 * f00[3] + w01 * f01[1] + w11 * f01[3]};
  }
};

}  // namespace facet
