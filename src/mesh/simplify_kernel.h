// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the collapsing loop works on. Internal to the simplification: the only
// header that includes OpenMesh, for simplify_*.cc alone.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <vector>

#include "mesh/indexed_heap.h"
#include "mesh/quadric.h"
#include "mesh/simplify_internal.h"
#include "mesh/simplify_shape.h"

namespace facet {

struct KernelTraits : public OpenMesh::DefaultTraits {
  typedef OpenMesh::Vec3d Point;
  VertexAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using Kernel = OpenMesh::TriMesh_ArrayKernelT<KernelTraits>;
using EdgeHandle = Kernel::EdgeHandle;
using HalfedgeHandle = Kernel::HalfedgeHandle;
using VertexHandle = Kernel::VertexHandle;

enum EdgeClass { kInner = 1, kBorder = 2, kChord = 4 };

// What a collapse would do: `halfedge` points from the vertex that goes to the
// one that stays and moves to `target`.
struct Collapse {
  HalfedgeHandle halfedge;
  Eigen::Vector3d target;
  double cost = 0;
  bool fixed_target = false;  // the vertex that stays may not move
};

// Of a vertex, in one line of the cache.
struct alignas(64) VertexData {
  Eigen::Vector3d position;  // about Collapser::Impl::center
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();  // normals times area
  double weight = 1e-30;                             // area in the quadric
  int border_degree = 0;                             // border edges at it
};

constexpr int kNumTargets = 4;  // of a collapse, see Plan

struct Collapser::Impl {
  Impl(const TriMesh& mesh,
       const PlanarPartition& partition_in,
       const SimplifyOptions& options_in)
      : partition(partition_in),
        options(options_in),
        soft_limits(ShapeLimits::Soft(options_in)),
        hard_limits(ShapeLimits::Hard(options_in)) {
    BuildKernel(mesh);
    MarkBorders();
    BuildQuadrics(mesh);
  }

  void BuildKernel(const TriMesh& mesh);
  void MarkBorders();
  void BuildQuadrics(const TriMesh& mesh);

  EdgeClass ClassOf(EdgeHandle e) const;
  bool MayCollapse(EdgeHandle e) const;
  Collapse Plan(EdgeHandle e, int target) const;
  bool LinkAllows(const Collapse& collapse) const;
  bool RingsAllow(HalfedgeHandle h) const;
  bool ShapeAllows(const Collapse& collapse, const ShapeLimits& limits) const;
  void Execute(const Collapse& collapse);
  void Push(EdgeHandle e);
  void Reject(EdgeHandle e);
  void Retry(EdgeHandle e, bool fixed_target);
  void Fill(int classes);
  void RemoveFlatFaces();
  bool CollapseSideOf(OpenMesh::FaceHandle face);
  bool FlipSideOf(OpenMesh::FaceHandle face);
  bool NudgeCornerOf(OpenMesh::FaceHandle face);
  bool MayMove(VertexHandle v, const Eigen::Vector3d& target) const;
  double AreaOf(OpenMesh::FaceHandle face) const;
  void Requeue(VertexHandle kept);
  void CountRing(HalfedgeHandle h, int sign);
  double ErrorOf(const Collapse& collapse) const;
  double CostQuantile(double share) const;
  bool Sweep(double goal, double max_cost);
  template <typename Wanted, typename Done>
  void Run(const Wanted& wanted, const Done& done);

  int ClusterOf(EdgeHandle e) const {  // of an edge inside a cluster
    return label[kernel.face_handle(kernel.halfedge_handle(e, 0)).idx()];
  }

  const PlanarPartition& partition;
  const SimplifyOptions options;
  const ShapeLimits soft_limits, hard_limits;
  Kernel kernel;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double total_area = 0;
  std::vector<VertexData> vertices;
  std::vector<Quadric> quadric;    // a vertex
  std::vector<int> label;          // a face
  std::vector<uint8_t> border;     // an edge
  std::vector<uint8_t> rejected;   // an edge, tried in vain
  std::vector<uint8_t> attempt;    // an edge: see Run
  std::vector<int> cluster_faces;  // faces left in a cluster
  std::vector<int> cluster_inner;  // candidates of step 1 in a cluster
  int num_faces = 0, num_border = 0, num_collapses = 0;
  double max_error = 0;
  int active = 0;                      // classes of edges that may collapse now
  IndexedHeap queue = IndexedHeap(0);  // edges by cost
};

}  // namespace facet
