// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/partition_steps.h"

namespace facet {
namespace {

class BorderSwapper {
 public:
  BorderSwapper(const TriMesh& mesh,
                const FaceNeighbors& neighbors,
                const PartitionOptions& options,
                std::vector<int>* label)
      : mesh_(mesh), neighbors_(neighbors), options_(options), label_(*label) {
    int num_clusters = 0;
    for (int l : label_) num_clusters = std::max(num_clusters, l + 1);
    count_.assign(num_clusters, 0);
    for (int l : label_) ++count_[l];
    energy_.resize(num_clusters);
    Resum();
  }

  double Energy() const {
    double sum = 0;
    for (double e : energy_) sum += e;
    return sum;
  }

  void Run(PartitionReport* report) {
    std::vector<int> front = BorderFaces(), next;
    std::vector<char> queued(mesh_.NumFaces(), 0);
    double energy = Energy();
    const size_t max_moves = 50 * mesh_.NumFaces();
    while (!front.empty() && report->swap_sweeps < options_.max_swap_sweeps &&
           report->swapped_faces < max_moves) {
      ++report->swap_sweeps;
      size_t moves = 0;
      for (int face : front) {
        queued[face] = 0;
        if (!TryMove(face)) continue;
        ++moves;
        Push(face, &queued, &next);
        ForNeighbors(face, [&](int g) { Push(g, &queued, &next); });
      }
      report->swapped_faces += moves;
      moves_since_resum_ += moves;
      if (moves_since_resum_ > mesh_.NumFaces() / 4) Resum();
      const double now = Energy();
      if (!(energy - now > options_.min_swap_decrease * energy)) break;
      energy = now;
      front.swap(next);
      next.clear();
    }
    Resum();
  }

 private:
  template <typename Visit>
  void ForNeighbors(int face, const Visit& visit) const {
    for (int i = neighbors_.begin[face]; i < neighbors_.begin[face + 1]; ++i) {
      visit(neighbors_.neighbors[i]);
    }
  }

  static void Push(int face,
                   std::vector<char>* queued,
                   std::vector<int>* queue) {
    if ((*queued)[face]) return;
    (*queued)[face] = 1;
    queue->push_back(face);
  }

  std::vector<int> BorderFaces() const {
    std::vector<int> faces;
    for (int f = 0; f < static_cast<int>(mesh_.NumFaces()); ++f) {
      bool border = false;
      ForNeighbors(f, [&](int g) { border |= label_[g] != label_[f]; });
      if (border) faces.push_back(f);
    }
    return faces;
  }

  // Many removals lose digits; this brings them back.
  void Resum() {
    moments_ = ClusterMoments(mesh_, label_, count_.size());
    for (size_t c = 0; c < count_.size(); ++c) {
      energy_[c] = ClusterEnergy(options_.energy, moments_[c]);
    }
    moves_since_resum_ = 0;
  }

  bool TryMove(int face) {
    const int from = label_[face];
    if (count_[from] < 2) return false;
    int best = -1;
    double best_gain = 0, best_energy = 0, rest_energy = 0;
    SurfaceMoments self, rest, best_moments;
    int tried[3];
    int num_tried = 0;
    bool possible = true;
    ForNeighbors(face, [&](int g) {
      const int to = label_[g];
      if (to == from || !possible) return;
      for (int k = 0; k < num_tried; ++k) {
        if (tried[k] == to) return;
      }
      if (num_tried == 0) {
        self = FaceMoments(mesh_, face);
        rest = Difference(moments_[from], self);
        // Too little would remain to be known by subtraction.
        possible = rest.area > 1e-3 * moments_[from].area;
        if (!possible) return;
        rest_energy = ClusterEnergy(options_.energy, rest);
      }
      if (num_tried < 3) tried[num_tried++] = to;
      const SurfaceMoments both = Union(moments_[to], self);
      const double both_energy = ClusterEnergy(options_.energy, both);
      const double gain =
          energy_[from] + energy_[to] - rest_energy - both_energy;
      // Rounding must not make a face go to and fro.
      if (gain > best_gain && gain > 1e-12 * (energy_[from] + energy_[to])) {
        best_gain = gain;
        best = to;
        best_moments = both;
        best_energy = both_energy;
      }
    });
    if (best < 0) return false;
    if (options_.max_rms_m > 0 &&
        RmsHeight(best_moments) > options_.max_rms_m) {
      return false;
    }
    moments_[from] = rest;
    energy_[from] = rest_energy;
    moments_[best] = best_moments;
    energy_[best] = best_energy;
    --count_[from];
    ++count_[best];
    label_[face] = best;
    return true;
  }

  const TriMesh& mesh_;
  const FaceNeighbors& neighbors_;
  const PartitionOptions& options_;
  std::vector<int>& label_;
  std::vector<SurfaceMoments> moments_;
  std::vector<double> energy_;
  std::vector<int> count_;
  size_t moves_since_resum_ = 0;
};

}  // namespace

void SwapBorders(const TriMesh& mesh,
                 const FaceNeighbors& neighbors,
                 const PartitionOptions& options,
                 std::vector<int>* label,
                 PartitionReport* report) {
  BorderSwapper swapper(mesh, neighbors, options, label);
  report->greedy_energy = swapper.Energy();
  if (options.swap_borders) swapper.Run(report);
  report->swapped_energy = swapper.Energy();
}

}  // namespace facet
