// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/mesh_regions.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace facet {
namespace {

struct Cluster {
  int id = 0, faces = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
};

// Planes that were merged bring no centroids that one could rely on.
std::vector<Cluster> CollectClusters(const TriMesh& mesh,
                                     const std::vector<int>& label) {
  std::vector<Cluster> clusters;
  for (size_t f = 0; f < label.size(); ++f) {
    const size_t id = static_cast<size_t>(label[f]);
    if (id >= clusters.size()) clusters.resize(id + 1);
    ++clusters[id].faces;
    clusters[id].center += mesh.vertices[mesh.faces[f][0]];
  }
  for (size_t id = 0; id < clusters.size(); ++id) {
    clusters[id].id = static_cast<int>(id);
    clusters[id].center /= std::max(1, clusters[id].faces);
  }
  return clusters;
}

class Divider {
 public:
  Divider(int faces_per_region, size_t num_clusters)
      : most_(faces_per_region), region_(num_clusters, 0) {}

  void Divide(std::vector<Cluster>::iterator begin,
              std::vector<Cluster>::iterator end) {
    int64_t faces = 0;
    Eigen::AlignedBox3d box;
    for (auto c = begin; c != end; ++c) {
      faces += c->faces;
      box.extend(c->center);
    }
    if (faces <= most_ || end - begin <= 1) {
      for (auto c = begin; c != end; ++c) region_[c->id] = count_;
      ++count_;
      return;
    }
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    std::sort(begin, end, [axis](const Cluster& a, const Cluster& b) {
      return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis]
                                              : a.id < b.id;
    });
    // Where both halves are nearest to half of the faces; neither is empty.
    auto middle = begin + 1;
    for (int64_t below = begin->faces;
         middle + 1 != end && 2 * below + middle->faces <= faces;
         ++middle) {
      below += middle->faces;
    }
    Divide(begin, middle);
    Divide(middle, end);
  }

  const std::vector<int>& ClusterRegions() const { return region_; }
  int Count() const { return count_; }

 private:
  const int most_;
  std::vector<int> region_;  // of a cluster
  int count_ = 0;
};

}  // namespace

MeshRegions DivideIntoRegions(const TriMesh& mesh,
                              const std::vector<int>& label,
                              int faces_per_region) {
  std::vector<Cluster> clusters = CollectClusters(mesh, label);
  // Clusters without faces are in no region.
  const size_t num_clusters = clusters.size();
  clusters.erase(std::remove_if(clusters.begin(),
                                clusters.end(),
                                [](const Cluster& c) { return c.faces == 0; }),
                 clusters.end());
  Divider divider(faces_per_region, num_clusters);
  divider.Divide(clusters.begin(), clusters.end());

  MeshRegions regions;
  regions.begin.assign(divider.Count() + 1, 0);
  for (const int id : label) ++regions.begin[divider.ClusterRegions()[id] + 1];
  for (int r = 0; r < divider.Count(); ++r) {
    regions.begin[r + 1] += regions.begin[r];
  }
  regions.faces.resize(label.size());
  std::vector<int> next(regions.begin.begin(), regions.begin.end() - 1);
  for (size_t f = 0; f < label.size(); ++f) {
    regions.faces[next[divider.ClusterRegions()[label[f]]]++] =
        static_cast<int>(f);
  }
  return regions;
}

}  // namespace facet
