// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <limits>
#include <queue>
#include <string>

#include "mesh/quadric.h"
#include "mesh/simplify_internal.h"
#include "mesh/simplify_shape.h"
#include "util/errors.h"

namespace facet {
namespace {

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

// An edge in the queue. It is out of date when the versions of its ends have
// moved on.
struct Candidate {
  double cost;
  int edge;
  int choice;  // of the target, see Plan
  uint32_t stamp;
  bool operator<(const Candidate& other) const {  // the cheapest on top
    return cost != other.cost ? cost > other.cost : edge > other.edge;
  }
};

// What a collapse would do: `halfedge` points from the vertex that goes to the
// one that stays and moves to `target`.
struct Collapse {
  HalfedgeHandle halfedge;
  Eigen::Vector3d target;
  double cost = 0;
  int last_choice = 0;
};

constexpr int kNumChoices = 4;

}  // namespace

struct Collapser::Impl {
  Impl(const TriMesh& mesh,
       const PlanarPartition& partition_in,
       const SimplifyOptions& options_in)
      : partition(partition_in), options(options_in), limits(options_in) {
    BuildKernel(mesh);
    MarkBorders();
    BuildQuadrics(mesh);
  }

  void BuildKernel(const TriMesh& mesh);
  void MarkBorders();
  void BuildQuadrics(const TriMesh& mesh);

  EdgeClass ClassOf(EdgeHandle e) const;
  bool MayCollapse(EdgeHandle e) const;
  Collapse Plan(EdgeHandle e, int choice) const;
  bool LinkAllows(const Collapse& collapse) const;
  bool ShapeAllows(const Collapse& collapse) const;
  void Execute(const Collapse& collapse);
  void Push(EdgeHandle e);
  void Fill(int classes);
  void Requeue(VertexHandle kept);
  void CountRing(HalfedgeHandle h, int sign);
  double ErrorOf(const Collapse& collapse) const;
  template <typename Wanted, typename Done>
  void Run(const Wanted& wanted, const Done& done);

  uint32_t Stamp(EdgeHandle e) const {
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    return version[kernel.from_vertex_handle(h).idx()] +
           version[kernel.to_vertex_handle(h).idx()];
  }
  bool IsCorner(int v) const {
    return border_degree[v] != 0 && border_degree[v] != 2;
  }
  int ClusterOf(EdgeHandle e) const {  // of an edge inside a cluster
    return label[kernel.face_handle(kernel.halfedge_handle(e, 0)).idx()];
  }

  const PlanarPartition& partition;
  const SimplifyOptions options;
  const ShapeLimits limits;
  Kernel kernel;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double total_area = 0;
  std::vector<Eigen::Vector3d> position;  // about `center`, a vertex
  std::vector<Quadric> quadric;           // a vertex
  std::vector<double> weight;             // area in the quadric, a vertex
  std::vector<uint32_t> version;          // a vertex
  std::vector<int> border_degree;         // border edges at a vertex
  std::vector<int> label;                 // a face
  std::vector<uint8_t> border;            // an edge
  std::vector<uint8_t> rejected;          // an edge, tried in vain
  std::vector<int> cluster_faces;         // faces left in a cluster
  std::vector<int> cluster_inner;         // candidates of step 1 in a cluster
  int num_faces = 0, num_border = 0, num_collapses = 0;
  double max_error = 0;
  int active = 0;  // classes of edges that may collapse now
  std::priority_queue<Candidate> queue;
};

void Collapser::Impl::BuildKernel(const TriMesh& mesh) {
  for (const auto& v : mesh.vertices) center += v;
  center /= static_cast<double>(std::max<size_t>(1, mesh.NumVertices()));
  kernel.reserve(
      mesh.NumVertices(), 3 * mesh.NumFaces() / 2 + 1000, mesh.NumFaces());
  position.reserve(mesh.NumVertices());
  for (const auto& v : mesh.vertices) {
    kernel.new_vertex();
    position.push_back(v - center);
  }
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const auto& face = mesh.faces[f];
    const auto added = kernel.add_face(
        VertexHandle(face[0]), VertexHandle(face[1]), VertexHandle(face[2]));
    if (!added.is_valid()) {
      throw UnsolvableError(
          "simplification: the mesh is not manifold at face " +
          std::to_string(f) + "; split non-manifold edges and vertices first");
    }
    total_area += mesh.FaceArea(f);
  }
  label = partition.face_cluster;
  num_faces = static_cast<int>(mesh.NumFaces());
  cluster_faces.assign(partition.clusters.size(), 0);
  for (const int id : label) ++cluster_faces[id];
}

void Collapser::Impl::MarkBorders() {
  border.assign(kernel.n_edges(), 0);
  rejected.assign(kernel.n_edges(), 0);
  border_degree.assign(kernel.n_vertices(), 0);
  version.assign(kernel.n_vertices(), 0);
  for (const EdgeHandle e : kernel.edges()) {
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    const auto left = kernel.face_handle(h);
    const auto right = kernel.opposite_face_handle(h);
    if (left.is_valid() && right.is_valid() &&
        label[left.idx()] == label[right.idx()]) {
      continue;
    }
    border[e.idx()] = 1;
    ++num_border;
    ++border_degree[kernel.from_vertex_handle(h).idx()];
    ++border_degree[kernel.to_vertex_handle(h).idx()];
  }
  cluster_inner.assign(partition.clusters.size(), 0);
  for (const EdgeHandle e : kernel.edges()) {
    if (ClassOf(e) == kInner) ++cluster_inner[ClusterOf(e)];
  }
}

void Collapser::Impl::BuildQuadrics(const TriMesh& mesh) {
  const double point_weight =
      options.point_share * total_area / std::max(1, num_faces);
  const double share = options.cluster_plane_share;
  quadric.reserve(position.size());
  for (const auto& p : position) {
    quadric.push_back(Quadric::Point(p, point_weight));
  }
  weight.assign(position.size(), 1e-30);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const Eigen::Vector3d cross = mesh.FaceCross(f);
    const double norm = cross.norm();
    if (!(norm > 0)) continue;
    const Eigen::Vector3d n = cross / norm;
    const double w = norm / 6;  // a third of the area, per corner
    const Plane& plane = partition.clusters[label[f]].plane;
    Quadric q =
        Quadric::Plane(n, -n.dot(position[mesh.faces[f][0]]), (1 - share) * w);
    q += Quadric::Plane(plane.normal, plane.SignedDistance(center), share * w);
    for (const int v : mesh.faces[f]) {
      quadric[v] += q;
      weight[v] += w;
    }
  }
  for (const EdgeHandle e : kernel.edges()) {
    if (!border[e.idx()]) continue;
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    const int a = kernel.from_vertex_handle(h).idx();
    const int b = kernel.to_vertex_handle(h).idx();
    const Eigen::Vector3d d = position[b] - position[a];
    const double length_sq = d.squaredNorm();
    if (!(length_sq > 0)) continue;
    const Quadric q = Quadric::Line(
        position[a],
        d / std::sqrt(length_sq),
        length_sq * (kernel.is_boundary(e) ? options.mesh_boundary_weight
                                           : options.cluster_border_weight));
    quadric[a] += q;
    quadric[b] += q;
  }
}

EdgeClass Collapser::Impl::ClassOf(EdgeHandle e) const {
  if (border[e.idx()]) return kBorder;
  const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
  const int ends = (border_degree[kernel.from_vertex_handle(h).idx()] > 0) +
                   (border_degree[kernel.to_vertex_handle(h).idx()] > 0);
  if (ends == 2 || (ends == 1 && !options.collapse_to_border)) return kChord;
  return kInner;
}

bool Collapser::Impl::MayCollapse(EdgeHandle e) const {
  const EdgeClass edge_class = ClassOf(e);
  if (!(edge_class & active)) return false;
  if (edge_class != kBorder) return true;
  if (options.keep_mesh_boundary && kernel.is_boundary(e)) return false;
  const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
  return !IsCorner(kernel.from_vertex_handle(h).idx()) ||
         !IsCorner(kernel.to_vertex_handle(h).idx());
}

// Choice 0 is the best target; where its shape is refused, choices 1 to 3 are
// the midpoint and the two ends. With an end that has to stay there is only 0.
Collapse Collapser::Impl::Plan(EdgeHandle e, int choice) const {
  Collapse plan;
  plan.halfedge = kernel.halfedge_handle(e, 0);
  int from = kernel.from_vertex_handle(plan.halfedge).idx();
  int to = kernel.to_vertex_handle(plan.halfedge).idx();
  // The end that has to stay put: a corner, or the border end of an inner edge.
  const auto fixed = [&](int v) {
    return border[e.idx()] ? IsCorner(v) : border_degree[v] > 0;
  };
  if (fixed(from)) {
    std::swap(from, to);
    plan.halfedge = kernel.opposite_halfedge_handle(plan.halfedge);
  }
  plan.last_choice = fixed(to) ? 0 : kNumChoices - 1;
  const Quadric q = quadric[from] + quadric[to];
  const Eigen::Vector3d& a = position[from];
  const Eigen::Vector3d& b = position[to];
  plan.target = b;
  if (plan.last_choice != 0) {
    Eigen::Vector3d best;
    if (choice == 3) {
      plan.target = a;
    } else if (choice <= 1) {
      plan.target = 0.5 * (a + b);
      if (choice == 0 && q.Minimum(&best) &&
          (best - plan.target).squaredNorm() <= 4 * (a - b).squaredNorm()) {
        plan.target = best;
      }
    }
  }
  plan.cost = q(plan.target);
  return plan;
}

// Link condition on the mesh (OpenMesh) and on the labels.
bool Collapser::Impl::LinkAllows(const Collapse& collapse) const {
  const HalfedgeHandle h = collapse.halfedge;
  // is_collapse_ok only tags status bits of the one-rings: logically const.
  if (!const_cast<Kernel&>(kernel).is_collapse_ok(h)) return false;
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  // A closed tetrahedron passes the test of the one-rings.
  if (kernel.valence(from) == 3 && kernel.valence(to) == 3) return false;

  int lost_cluster = -1;
  for (const HalfedgeHandle side : {h, kernel.opposite_halfedge_handle(h)}) {
    if (kernel.is_boundary(side)) continue;
    const int id = label[kernel.face_handle(side).idx()];
    if (cluster_faces[id] <= 1 + (id == lost_cluster)) return false;
    lost_cluster = id;
    // A face whose other sides are both border joins two chains if it goes.
    const EdgeHandle next =
        kernel.edge_handle(kernel.next_halfedge_handle(side));
    const EdgeHandle prev =
        kernel.edge_handle(kernel.prev_halfedge_handle(side));
    if (border[next.idx()] && border[prev.idx()]) return false;
  }
  return true;
}

bool Collapser::Impl::ShapeAllows(const Collapse& collapse) const {
  const VertexHandle from = kernel.from_vertex_handle(collapse.halfedge);
  const VertexHandle to = kernel.to_vertex_handle(collapse.halfedge);
  for (const VertexHandle moved : {from, to}) {
    const VertexHandle other = moved == from ? to : from;
    if (moved == to && collapse.target == position[to.idx()]) continue;
    for (auto it = kernel.cvoh_iter(moved); it.is_valid(); ++it) {
      if (kernel.is_boundary(*it)) continue;
      const VertexHandle v2 = kernel.to_vertex_handle(*it);
      const VertexHandle v3 =
          kernel.to_vertex_handle(kernel.next_halfedge_handle(*it));
      if (v2 == other || v3 == other) continue;
      const int id = label[kernel.face_handle(*it).idx()];
      if (!MayMoveCorner(position[moved.idx()],
                         collapse.target,
                         position[v2.idx()],
                         position[v3.idx()],
                         partition.clusters[id].plane.normal,
                         limits)) {
        return false;
      }
    }
  }
  return true;
}

double Collapser::Impl::ErrorOf(const Collapse& collapse) const {
  const int from = kernel.from_vertex_handle(collapse.halfedge).idx();
  const int to = kernel.to_vertex_handle(collapse.halfedge).idx();
  return std::sqrt(collapse.cost / (weight[from] + weight[to]));
}

// Adds `sign` to the counts of edges at both ends of h.
void Collapser::Impl::CountRing(HalfedgeHandle h, int sign) {
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  for (const VertexHandle v : {from, to}) {
    for (const EdgeHandle e : kernel.ve_range(v)) {
      if (v == to && e == kernel.edge_handle(h)) continue;
      const EdgeClass edge_class = ClassOf(e);
      if (edge_class == kBorder) num_border += sign;
      if (edge_class == kInner) cluster_inner[ClusterOf(e)] += sign;
    }
  }
}

void Collapser::Impl::Execute(const Collapse& collapse) {
  const HalfedgeHandle h = collapse.halfedge;
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  max_error = std::max(max_error, ErrorOf(collapse));
  CountRing(h, -1);

  // The two other sides of a face that goes become one edge: a border if one of
  // them was.
  std::pair<VertexHandle, bool> merged[2];
  int num_merged = 0;
  for (const HalfedgeHandle side : {h, kernel.opposite_halfedge_handle(h)}) {
    if (kernel.is_boundary(side)) continue;
    const HalfedgeHandle next = kernel.next_halfedge_handle(side);
    const HalfedgeHandle prev = kernel.prev_halfedge_handle(side);
    merged[num_merged++] = {kernel.to_vertex_handle(next),
                            border[kernel.edge_handle(next).idx()] ||
                                border[kernel.edge_handle(prev).idx()]};
    --cluster_faces[label[kernel.face_handle(side).idx()]];
    --num_faces;
  }
  const uint32_t next_version =
      std::max(version[from.idx()], version[to.idx()]) + 1;
  kernel.collapse(h);
  ++num_collapses;
  for (int i = 0; i < num_merged; ++i) {
    const EdgeHandle e =
        kernel.edge_handle(kernel.find_halfedge(to, merged[i].first));
    border[e.idx()] = merged[i].second;
  }
  position[to.idx()] = collapse.target;
  quadric[to.idx()] += quadric[from.idx()];
  weight[to.idx()] += weight[from.idx()];
  version[to.idx()] = next_version;
  int degree = 0;
  for (const EdgeHandle e : kernel.ve_range(to)) degree += border[e.idx()];
  border_degree[to.idx()] = degree;
  for (const EdgeHandle e : kernel.ve_range(to)) {
    const EdgeClass edge_class = ClassOf(e);
    if (edge_class == kBorder) ++num_border;
    if (edge_class == kInner) ++cluster_inner[ClusterOf(e)];
  }
  Requeue(to);
}

void Collapser::Impl::Push(EdgeHandle e) {
  rejected[e.idx()] = 0;
  if (MayCollapse(e)) queue.push({Plan(e, 0).cost, e.idx(), 0, Stamp(e)});
}

// After a collapse: the edges of the kept vertex have new costs, and edges
// around it that were rejected may have become valid.
void Collapser::Impl::Requeue(VertexHandle kept) {
  for (auto it = kernel.cvoh_iter(kept); it.is_valid(); ++it) {
    Push(kernel.edge_handle(*it));
  }
  for (auto it = kernel.cvoh_iter(kept); it.is_valid(); ++it) {
    for (const EdgeHandle e : kernel.ve_range(kernel.to_vertex_handle(*it))) {
      if (rejected[e.idx()]) Push(e);
    }
  }
}

void Collapser::Impl::Fill(int classes) {
  active = classes;
  queue = {};
  for (const EdgeHandle e : kernel.edges()) Push(e);  // skips deleted edges
}

// Collapses the cheapest valid candidate for which wanted(edge, plan) holds
// until done() or the queue is empty.
template <typename Wanted, typename Done>
void Collapser::Impl::Run(const Wanted& wanted, const Done& done) {
  while (!queue.empty() && !done()) {
    const Candidate top = queue.top();
    queue.pop();
    const EdgeHandle e(top.edge);
    if (kernel.status(e).deleted() || Stamp(e) != top.stamp) continue;
    const Collapse plan = Plan(e, top.choice);
    if (!(ErrorOf(plan) <= options.max_error_m) || !wanted(e, plan)) continue;
    if (!LinkAllows(plan)) {
      rejected[e.idx()] = 1;
    } else if (ShapeAllows(plan)) {
      Execute(plan);
    } else if (top.choice < plan.last_choice) {
      const int choice = top.choice + 1;
      queue.push({Plan(e, choice).cost, top.edge, choice, top.stamp});
    } else {
      rejected[e.idx()] = 1;
    }
  }
}

Collapser::Collapser(const TriMesh& mesh,
                     const PlanarPartition& partition,
                     const SimplifyOptions& options)
    : impl_(std::make_unique<Impl>(mesh, partition, options)) {}

Collapser::~Collapser() = default;

void Collapser::RunCounts() {
  Impl& m = *impl_;
  const double goal = std::max<double>(m.options.min_border_edges,
                                       m.options.border_ratio * m.num_border);
  const auto always = [](EdgeHandle, const Collapse&) { return true; };
  for (int pass = 0; pass < m.options.passes; ++pass) {
    m.Fill(kInner);
    m.Run(
        [&m](EdgeHandle e, const Collapse&) {
          return m.cluster_inner[m.ClusterOf(e)] > m.options.inner_target;
        },
        [] { return false; });
    m.Fill(kBorder);
    m.Run(always, [&m, goal] { return m.num_border <= goal; });
  }
}

void Collapser::RunBudget() {
  Impl& m = *impl_;
  const double budget = m.options.target_faces > 0
                            ? m.options.target_faces
                            : m.options.faces_per_m2 * m.total_area;
  m.Fill(kInner | kBorder);
  m.Run(
      [&m, budget](EdgeHandle, const Collapse& plan) {
        return m.num_faces > budget || m.ErrorOf(plan) < m.options.free_error_m;
      },
      [] { return false; });
}

void Collapser::Extract(SimplifyResult* result) const {
  const Impl& m = *impl_;
  std::vector<int> index(m.position.size(), -1);
  for (const auto f : m.kernel.faces()) {
    std::array<int, 3> face;
    int k = 0;
    for (const VertexHandle v : m.kernel.fv_range(f)) {
      int& i = index[v.idx()];
      if (i < 0) {
        i = static_cast<int>(result->vertex_birth.size());
        result->vertex_birth.push_back(v.idx());
        result->mesh.vertices.push_back(m.position[v.idx()] + m.center);
      }
      face[k++] = i;
    }
    result->mesh.faces.push_back(face);
    result->partition.face_cluster.push_back(m.label[f.idx()]);
  }
  result->report.collapses = m.num_collapses;
  result->report.max_error_m = m.max_error;
}

}  // namespace facet
