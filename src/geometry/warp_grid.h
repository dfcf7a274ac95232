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
  Eigen::Vector2d Apply(const double* f, const Eigen::Vector2d& u) const {
    const WarpCell c = Locate(u.x(), u.y());
    const double* f00 = f + 2 * VertexIndex(c.a, c.b);
    const double* f10 = f00 + 2;
    const double* f01 = f00 + 2 * columns;
    const double* f11 = f01 + 2;
    const double w00 = (1 - c.alpha) * (1 - c.beta),
                 w10 = c.alpha * (1 - c.beta);
    const double w01 = (1 - c.alpha) * c.beta, w11 = c.alpha * c.beta;
    return {u.x() + w00 * f00[0] + w10 * f10[0] + w01 * f01[0] + w11 * f11[0],
            u.y() + w00 * f00[1] + w10 * f10[1] + w01 * f01[1] + w11 * f11[1]};
  }
};

}  // namespace facet
