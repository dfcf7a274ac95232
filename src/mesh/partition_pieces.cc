// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <algorithm>

#include "mesh/partition_steps.h"

namespace facet {
namespace {

struct Pieces {
  std::vector<int> face_piece;
  std::vector<double> area;  // by piece
  std::vector<int> cluster;  // by piece
};

// Edge-connected pieces of the clusters, in the order of their first faces.
Pieces FindPieces(const TriMesh& mesh,
                  const FaceNeighbors& neighbors,
                  const std::vector<int>& label) {
  Pieces pieces;
  pieces.face_piece.assign(mesh.NumFaces(), -1);
  std::vector<int> stack;
  for (size_t seed = 0; seed < mesh.NumFaces(); ++seed) {
    if (pieces.face_piece[seed] >= 0) continue;
    const int piece = static_cast<int>(pieces.area.size());
    double area = 0;
    pieces.face_piece[seed] = piece;
    stack.push_back(static_cast<int>(seed));
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      area += mesh.FaceArea(f);
      for (int i = neighbors.begin[f]; i < neighbors.begin[f + 1]; ++i) {
        const int g = neighbors.neighbors[i];
        if (label[g] != label[f] || pieces.face_piece[g] >= 0) continue;
        pieces.face_piece[g] = piece;
        stack.push_back(g);
      }
    }
    pieces.area.push_back(area);
    pieces.cluster.push_back(label[seed]);
  }
  return pieces;
}

}  // namespace

std::vector<std::pair<int, int>> ClusterPairs(const FaceNeighbors& neighbors,
                                              const std::vector<int>& label) {
  std::vector<std::pair<int, int>> pairs;
  for (size_t f = 0; f < label.size(); ++f) {
    for (int i = neighbors.begin[f]; i < neighbors.begin[f + 1]; ++i) {
      const int other = label[neighbors.neighbors[i]];
      if (label[f] < other) pairs.emplace_back(label[f], other);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

int SplitIntoPieces(const TriMesh& mesh,
                    const FaceNeighbors& neighbors,
                    int num_clusters,
                    bool absorb,
                    std::vector<int>* label,
                    int* loose_pieces) {
  const Pieces pieces = FindPieces(mesh, neighbors, *label);
  const int num_pieces = static_cast<int>(pieces.area.size());
  std::vector<int> largest(num_clusters, -1);
  for (int p = 0; p < num_pieces; ++p) {
    int& best = largest[pieces.cluster[p]];
    if (best < 0 || pieces.area[p] > pieces.area[best]) best = p;
  }
  // The one cluster that a piece touches: -1 = none yet, -2 = several. Pieces
  // of one cluster do not touch each other.
  std::vector<int> touches(num_pieces, -1);
  for (size_t f = 0; f < label->size(); ++f) {
    int& touched = touches[pieces.face_piece[f]];
    for (int i = neighbors.begin[f]; i < neighbors.begin[f + 1]; ++i) {
      const int other = (*label)[neighbors.neighbors[i]];
      if (other == (*label)[f] || other == touched) continue;
      touched = touched == -1 ? other : -2;
    }
  }
  std::vector<int> target(num_pieces);
  int count = num_clusters;
  *loose_pieces = 0;
  for (int p = 0; p < num_pieces; ++p) {
    const int cluster = pieces.cluster[p];
    if (largest[cluster] == p) {
      target[p] = cluster;
      continue;
    }
    ++*loose_pieces;
    target[p] = absorb && touches[p] >= 0 ? touches[p] : count++;
  }
  for (size_t f = 0; f < label->size(); ++f) {
    (*label)[f] = target[pieces.face_piece[f]];
  }
  return count;
}

}  // namespace facet
