// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/photometric_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "problems/color_step.h"
#include "texture/fingerprint.h"
#include "texture/visibility.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/warnings.h"

namespace facet {
namespace {

ImageView<float> ViewOf(const cv::Mat& image) {
  return {image.ptr<float>(), image.cols, image.rows,
          static_cast<ptrdiff_t>(image.step1())};
}

std::string PhaseLine(int round, const std::string& phase,
                      const EnergyTerms& e, double lambda1, double lambda2,
                      const char* mark, double wall_s) {
  char line[200];
  std::snprintf(line, sizeof(line),
                "  %5d  %-7s %12.4f %12.4f %12.4f %12.4f %9.4f %10.4f %9.3f  %-8s "
                "%7.1f",
                round, phase.c_str(), e.e_c, lambda1 * e.e_p,
                lambda2 * e.e_s, e.e_tex, e.e_prior, e.e_depth, e.rms_grey, mark, wall_s);
  return line;
}

struct Sampled {
  TexelSet texels;
  std::vector<TexelTile> tiles;
  Observations observations;
  VisibilityCounts counts;
};

// A stride for which the observations stay below the limit: estimated from a
// coarse sample, whose count scales with 1 / stride^2.
int ChooseStride(const std::function<Sampled(int)>& sample, size_t limit) {
  constexpr int kProbe = 8;
  const double dense = static_cast<double>(sample(kProbe).observations.size()) *
                       kProbe * kProbe;
  const double stride = std::ceil(std::sqrt(dense / static_cast<double>(limit)));
  return std::clamp(static_cast<int>(stride), 1, 32);
}

void CountFrames(const TextureProblem& problem, PhotometricResult* result) {
  result->plane_texels = problem.plane_texels;
  result->plane_frames.assign(problem.NumPlanes(), 0);
  std::vector<int> last(problem.NumPlanes(), -1);
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    for (size_t i = problem.observations.begin[k];
         i < problem.observations.begin[k + 1]; ++i) {
      const int plane = problem.texels.plane[problem.observations.texel[i]];
      if (last[plane] == k) continue;
      last[plane] = k;
      ++result->plane_frames[plane];
    }
  }
  for (const uint16_t views : problem.views) {
    result->texels_observed += views > 0 ? 1 : 0;
  }
}

void CheckObserved(const Observations& observations,
                   const VisibilityCounts& c,
                   int num_keyframes) {
  if (observations.size() > 0) return;
  char text[700];
  std::snprintf(
      text, sizeof(text),
      "no keyframe sees the mesh: of %zu candidate observations of %d "
      "keyframes %zu are behind or too far, %zu outside the image, %zu "
      "grazing or from behind, %zu without depth, %zu at depth edges, %zu "
      "contradict the sensor depth, %zu at edges of the mesh, %zu are occluded, "
      "%zu seen too rarely; run "
      "facet-check-input to find the convention that fits, or lower "
      "--keyframe_window where texels are seen too rarely",
      c.candidates, num_keyframes, c.behind_or_far, c.outside_image, c.grazing,
      c.depth_missing, c.depth_edge, c.depth_disagrees, c.mesh_edge, c.occluded,
      c.too_few_views);
  throw UnsolvableError(text);
}

void StoreResult(const TextureProblem& problem,
                 const ReconState& state,
                 PhotometricResult* result) {
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    result->cam_from_world.push_back(state.CamFromWorld(k));
  }
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    result->planes.push_back(state.PlaneAt(j, problem.anchors[j]));
  }
  if (std::any_of(state.warps.begin(), state.warps.end(),
                  [](double f) { return f != 0; })) {
    result->warps = state.warps;
  }
  CountFrames(problem, result);
}

}  // namespace

PhotometricResult RunPhotometricStage(
    const TriMesh& mesh,
    const PlanarPartition& partition,
    const std::vector<Plane>& planes,
    const Atlas& atlas,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& cam_from_world,
    const KeyframeImages& images,
    const VisibilityOptions& visibility,
    const PhotometricOptions& options,
    const std::function<void(const std::string&)>& print) {
  PhotometricResult result;
  const RayScene scene(mesh);
  std::vector<Eigen::Vector3d> anchors;
  for (const PlaneCluster& cluster : partition.clusters) {
    anchors.push_back(cluster.centroid);
  }
  const auto sample = [&](int stride) {
    Sampled s;
    s.texels = SampleTexels(mesh, partition, atlas,
                            {stride, options.edge_margin_m});
    s.tiles = SortTexelsIntoTiles(planes, anchors, options.tile_texels,
                                  &s.texels);
    s.observations =
        ComputeObservations(s.texels, planes, scene, sequence, keyframes,
                            cam_from_world, visibility, &s.counts);
    CheckObserved(s.observations, s.counts, static_cast<int>(keyframes.size()));
    return s;
  };
  result.stride = options.stride > 0
                      ? options.stride
                      : ChooseStride(sample, options.max_observations);
  Sampled sampled = sample(result.stride);
  result.texels = sampled.texels.size();
  result.observation_fingerprint =
      ObservationFingerprint(sampled.texels, sampled.observations);
  result.visibility = sampled.counts;

  TextureProblem problem;
  problem.formulation = options.formulation;
  problem.camera = sequence.calibration().color;
  problem.lattice = {options.warp_columns, options.warp_rows,
                     problem.camera.width, problem.camera.height};
  result.lattice = problem.lattice;
  for (size_t k = 0; k < keyframes.size(); ++k) {
    problem.images.push_back(ViewOf(images.smooth[k]));
    problem.raw_images.push_back(ViewOf(images.luma[k]));
  }
  std::vector<std::array<cv::Mat, 3>> channels;
  if (options.formulation.channels == Channels::kRgb) {
    channels.resize(keyframes.size());
    ParallelFor(0, channels.size(), [&](size_t k) {
      channels[k] = SmoothChannels(images.rgb[k], options.smoothing_sigma_px);
    });
    problem.more_images.resize(2);
    for (size_t k = 0; k < channels.size(); ++k) {
      problem.images[k] = ViewOf(channels[k][0]);
      problem.more_images[0].push_back(ViewOf(channels[k][1]));
      problem.more_images[1].push_back(ViewOf(channels[k][2]));
    }
  }
  problem.texels = std::move(sampled.texels);
  problem.observations = std::move(sampled.observations);
  problem.tiles = std::move(sampled.tiles);
  problem.anchors = anchors;
  problem.initial_cam_from_world = cam_from_world;
  if (options.weights.depth_weight > 0) {
    problem.depth_moments =
        ComputeDepthMoments(partition, planes, scene, sequence, keyframes,
                            cam_from_world, DepthMomentOptions());
  }
  CheckObservationLimit(problem.formulation,
                        problem.observations.size() * problem.NumChannels());
  FinishTextureProblem(&problem);

  ReconState state = InitialState(problem, planes);
  EnergyWeights weights = options.weights;
  weights.texel_weight = result.stride * result.stride;
  weights.lambda1 = InitialLambda1(problem, weights, state);
  result.lambda1 = weights.lambda1;
  weights.prior.scale = InitialPriorScale(problem, weights, state);

  print("  round  phase            E_c   lambda1 E_p   lambda2 E_s        E_tex"
        "   E_prior    E_depth  rms grey  result    wall s");
  result.initial = EvaluateEnergy(problem, weights, state, true);
  print(PhaseLine(0, "start", result.initial, weights.lambda1, weights.lambda2,
                  "", 0));
  result.trace = RunSchedule(
      problem, weights, options.solver, ParseSchedule(options.schedule),
      options.stop,
      [&](const TraceRow& row) {
        print(PhaseLine(row.round, row.phase.blocks, row.phase.after,
                        weights.lambda1, weights.lambda2,
                        row.phase.accepted ? "accepted" : "undone",
                        row.wall_s));
      },
      &state);
  // Poses and planes moved after the last colour step.
  SolveColors(problem, &state);
  result.final_terms = EvaluateEnergy(problem, weights, state, true);
  StoreResult(problem, state, &result);
  return result;
}

}  // namespace facet
