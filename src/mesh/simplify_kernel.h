// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the collapsing loop works on. Internal to the simplification: the only
// header that includes OpenMesh, for simplify_*.cc alone.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "mesh/mesh_regions.h"
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
  // The region in which it and its ring lie with all their faces, -1 = none.
  int region = -1;
};

// What collapses change about the mesh as a whole.
struct Counts {
  int faces = 0, border = 0, collapses = 0;
  double max_error = 0;

  void Add(const Counts& other) {
    faces += other.faces;
    border += other.border;
    collapses += other.collapses;
    max_error = std::max(max_error, other.max_error);
  }
};

constexpr int kNumTargets = 4;  // of a collapse, see Plan

// Elements are numbered region by region. Tasks that work at the same time
// write to elements of their own regions and to counts of their own; what they
// read of others, vertices beside their region, does not change meanwhile.
struct Collapser::Impl {
  Impl(const TriMesh& mesh,
       const PlanarPartition& partition_in,
       const SimplifyOptions& options_in,
       int faces_per_region);

  void BuildKernel(const TriMesh& mesh, const MeshRegions& regions);
  void MarkBorders();
  void BuildQuadrics(const TriMesh& mesh, const MeshRegions& regions);

  EdgeClass ClassOf(EdgeHandle e) const;
  bool MayCollapse(EdgeHandle e) const;
  Collapse Plan(EdgeHandle e, int target) const;
  bool LinkAllows(const Collapse& collapse) const;
  bool RingsAllow(HalfedgeHandle h) const;
  bool ShapeAllows(const Collapse& collapse, const ShapeLimits& limits) const;
  double ErrorOf(const Collapse& collapse) const;
  double CostQuantile(double share) const;
  void Execute(const Collapse& collapse, Counts* counts);
  void CountRing(HalfedgeHandle h, int sign, Counts* counts);

  bool Sweep(double goal, double max_cost);
  void CollapseInside(double budget, double max_cost);
  bool RunRounds(double goal, double budget, double max_cost, double* limit);
  void CollapseInnerInside();

  void RemoveFlatFaces();
  bool CollapseSideOf(OpenMesh::FaceHandle face);
  bool FlipSideOf(OpenMesh::FaceHandle face);
  bool NudgeCornerOf(OpenMesh::FaceHandle face);
  bool MayMove(VertexHandle v, const Eigen::Vector3d& target) const;
  double AreaOf(OpenMesh::FaceHandle face) const;

  // Makes groups of this many consecutive regions the regions that tasks are
  // of. Consecutive ones lie together.
  void GroupRegions(int size);
  int NumLeaves() const { return static_cast<int>(first_edge.size()) - 1; }
  int NumRegions() const { return (NumLeaves() + group_size - 1) / group_size; }
  int FirstLeaf(int region) const {
    return std::min(region * group_size, NumLeaves());
  }
  // Whether the edge, and all that its collapse changes, is inside a region.
  bool IsInside(EdgeHandle e, int region) const {
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    return vertices[kernel.from_vertex_handle(h).idx()].region == region &&
           vertices[kernel.to_vertex_handle(h).idx()].region == region;
  }
  bool IsInsideAny(EdgeHandle e) const {
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    const int region = vertices[kernel.from_vertex_handle(h).idx()].region;
    return region >= 0 && IsInside(e, region);
  }
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
  std::vector<int> birth;          // a vertex: its number in the input
  std::vector<Quadric> quadric;    // a vertex
  std::vector<int> label;          // a face
  std::vector<uint8_t> border;     // an edge
  std::vector<uint8_t> rejected;   // an edge, tried in vain
  std::vector<uint8_t> refused;    // a vertex: may have rejected edges
  std::vector<uint8_t> attempt;    // an edge: see CollapseTask::Run
  std::vector<int> cluster_faces;  // faces left in a cluster
  std::vector<int> cluster_inner;  // candidates of step 1, kCounts only
  // The regions of DivideIntoRegions, the leaves: r has the faces from
  // first_face[r] to first_face[r + 1], and inside edges only among those from
  // first_edge[r] to first_edge[r + 1].
  std::vector<int> first_face, first_edge;
  int group_size = 1;  // leaves in a region
  Counts counts;       // border: kCounts only
  int active = 0;      // classes of edges that may collapse now
};

}  // namespace facet
