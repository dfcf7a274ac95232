// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/reference_blocks.h"

#include <ceres/loss_function.h>

#include "costs/photometric.h"
#include "costs/se3_manifold.h"

namespace facet {

ceres::LossFunction* CreateReferenceLoss(const Formulation& formulation,
                                         double weight) {
  ceres::LossFunction* loss = nullptr;
  switch (formulation.loss) {
    case LossKind::kSquared:
      break;
    case LossKind::kHuber:
      loss = new ceres::HuberLoss(formulation.loss_scale);
      break;
    case LossKind::kCauchy:
      loss = new ceres::CauchyLoss(formulation.loss_scale);
      break;
    case LossKind::kTukey:
      loss = new ceres::TukeyLoss(formulation.loss_scale);
      break;
  }
  return new ceres::ScaledLoss(loss, weight, ceres::TAKE_OWNERSHIP);
}

PhotometricCost MakeReferenceCost(const TextureProblem& problem,
                                  const SampledImage& image,
                                  int a,
                                  int b,
                                  uint32_t texel) {
  return PhotometricCost(image,
                         problem.camera,
                         problem.lattice,
                         a,
                         b,
                         problem.texels.position[texel].cast<double>(),
                         problem.anchors[problem.texels.plane[texel]],
                         problem.formulation.out_of_image);
}

void AddReferencePlane(const TextureProblem& problem,
                       const ReconState& state,
                       const std::vector<PlaneSegment>& segments,
                       int index,
                       double weight,
                       double* plane,
                       ceres::Problem* ceres_problem) {
  const size_t num_texels = problem.texels.size();
  for (int channel = 0; channel < problem.NumChannels(); ++channel) {
    for (const PlaneSegment& segment : segments) {
      const int k = segment.keyframe;
      const SampledImage image = SampledImageOf(problem, channel, k);
      const double* pose = state.poses.data() + kPoseSize * k;
      const double* warp =
          state.warps.data() +
          2 * static_cast<size_t>(problem.lattice.NumVertices()) * k;
      const Pose cam_from_world = PoseFromBlock(pose);
      for (size_t i = 0; i < segment.num_ids; ++i) {
        const uint32_t id = segment.ids[i];
        const Eigen::Vector2d u = problem.camera.Project<double>(
            cam_from_world *
            ProjectOntoPlane<double>(plane,
                                     problem.texels.position[id].cast<double>(),
                                     problem.anchors[index]));
        const WarpCell c = problem.lattice.Locate(u.x(), u.y());
        const double* top = warp + 2 * problem.lattice.VertexIndex(c.a, c.b);
        const double* bottom = top + 2 * problem.lattice.columns;
        const double vertices[8] = {top[0],
                                    top[1],
                                    top[2],
                                    top[3],
                                    bottom[0],
                                    bottom[1],
                                    bottom[2],
                                    bottom[3]};
        ceres_problem->AddResidualBlock(
            PhotometricPlaneCost::Create(PhotometricPlaneCost(
                MakeReferenceCost(problem, image, c.a, c.b, id),
                pose,
                state.colors[channel * num_texels + id],
                vertices)),
            CreateReferenceLoss(problem.formulation, weight),
            plane);
      }
    }
  }
}

void AddReferenceCell(const TextureProblem& problem,
                      const ReconState& state,
                      int keyframe,
                      int a,
                      int b,
                      const uint32_t* ids,
                      size_t num_ids,
                      double weight,
                      const std::vector<double*>& parameters,
                      ceres::Problem* ceres_problem) {
  const size_t num_texels = problem.texels.size();
  for (int channel = 0; channel < problem.NumChannels(); ++channel) {
    const SampledImage image = SampledImageOf(problem, channel, keyframe);
    for (size_t i = 0; i < num_ids; ++i) {
      const uint32_t id = ids[i];
      const double* plane =
          state.planes.data() + kPlaneSize * problem.texels.plane[id];
      ceres_problem->AddResidualBlock(
          PhotometricFrameCost::Create(
              PhotometricFrameCost(MakeReferenceCost(problem, image, a, b, id),
                                   plane,
                                   state.colors[channel * num_texels + id]),
              parameters.size() > 1),
          CreateReferenceLoss(problem.formulation, weight),
          parameters);
    }
  }
}

}  // namespace facet
