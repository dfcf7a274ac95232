// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/photometric_stage.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "pipeline/photometric_level.h"
#include "pipeline/texel_sampler.h"
#include "problems/color_step.h"
#include "texture/fingerprint.h"
#include "util/background.h"

namespace facet {
namespace {

std::string PhaseLine(const std::string& round,
                      const std::string& phase,
                      const EnergyTerms& e,
                      double lambda1,
                      double lambda2,
                      const char* mark,
                      double wall_s) {
  char line[200];
  std::snprintf(line,
                sizeof(line),
                "  %5s  %-7s %12.4f %12.4f %12.4f %12.4f %10.4f %9.3f  "
                "%-8s %7.1f",
                round.c_str(),
                phase.c_str(),
                e.e_c,
                lambda1 * e.e_p,
                lambda2 * e.e_s,
                e.e_tex,
                e.e_prior + e.e_depth + e.SumOfTerms(),
                e.rms_grey,
                mark,
                wall_s);
  return line;
}

// Shown only where something rests: by default nothing does.
std::string RestText(const PhaseSummary& phase) {
  if (phase.resting == 0) return "";
  return "  " + std::to_string(phase.resting) + " of " +
         std::to_string(phase.resting + phase.problems) + " rest";
}

// On fewer pixels a texture says nothing.
constexpr int kMinLevelPx = 24;

int UsefulLevels(int levels, const Pinhole& camera) {
  const int size = std::min(camera.width, camera.height);
  while (levels > 1 && size >> (levels - 1) < kMinLevelPx) --levels;
  return levels;
}

// Observations that the exposures are calibrated from, at most: they are means
// over large areas.
constexpr size_t kExposureSamples = 1000000;

std::string ExposureLine(const ExposureCalibration& exposure) {
  char line[200];
  std::snprintf(
      line,
      sizeof(line),
      "  exposures: a grey of 0.5 becomes %.2f to %.2f; rms of colours "
      "about their means %.2f -> %.2f of 255, %zu samples",
      exposure.min_grey,
      exposure.max_grey,
      exposure.rms_before,
      exposure.rms_after,
      exposure.samples);
  return line;
}

// Runs the schedule on poses and planes of `state` (colours are those of the
// problem) and appends to the trace.
void RunLevel(const TextureProblem& problem,
              const EnergyWeights& weights,
              const PhotometricOptions& options,
              const Schedule& schedule,
              int level,
              const std::function<void(const std::string&)>& print,
              ReconState* state,
              Trace* trace) {
  state->colors.assign(problem.NumChannels() * problem.texels.size(), 0.0f);
  SolveColors(problem, state);
  const double wall_s = trace->rows.empty() ? 0 : trace->rows.back().wall_s;
  const double cpu_s = trace->rows.empty() ? 0 : trace->rows.back().cpu_s;
  const std::string prefix = level > 0 ? std::to_string(level) + ":" : "";
  Trace part = RunSchedule(
      problem,
      weights,
      options.solver,
      schedule,
      options.stop,
      [&](const TraceRow& row) {
        print(PhaseLine(prefix + std::to_string(row.round),
                        row.phase.blocks,
                        row.phase.after,
                        weights.lambda1,
                        weights.lambda2,
                        row.phase.accepted ? "accepted" : "undone",
                        wall_s + row.wall_s) +
              RestText(row.phase));
      },
      state);
  for (TraceRow& row : part.rows) {
    row.level = level;
    row.wall_s += wall_s;
    row.cpu_s += cpu_s;
    trace->rows.push_back(row);
  }
}

// All levels but the finest, from the coarsest on. While a level is solved the
// next one is made, unless memory is short. Takes their samples.
void RunCoarseLevels(const LevelInputs& inputs,
                     const KeyframeImages& images,
                     const std::vector<int>& strides,
                     const EnergyWeights& weights,
                     const Schedule& schedule,
                     const ReconState& start,
                     const std::function<void(const std::string&)>& print,
                     std::vector<SampledTexels>* samples,
                     ReconState* state,
                     Trace* trace) {
  const PhotometricOptions& options = inputs.options;
  const auto weights_of = [&](int level) {
    EnergyWeights scaled = weights;
    scaled.texel_weight *= 1 << (2 * level);
    return scaled;
  };
  const auto make = [&](int level) {
    auto made = std::make_unique<PhotometricLevel>(
        inputs,
        PyramidLevel(images, level, options.smoothing_sigma_px),
        level,
        strides[level],
        std::move((*samples)[level]));
    made->AddTerms(options.terms, start, weights_of(level).texel_weight);
    return made;
  };
  std::unique_ptr<PhotometricLevel> next;
  for (int level = static_cast<int>(strides.size()) - 1; level > 0; --level) {
    const std::unique_ptr<PhotometricLevel> current =
        next ? std::move(next) : make(level);
    Background making([&] {
      if (level > 1 && !images.store.InFile()) next = make(level - 1);
    });
    RunLevel(current->problem(),
             weights_of(level),
             options,
             WithoutWarps(schedule),
             level,
             print,
             state,
             trace);
    making.Finish();
  }
}

// Coarse levels have energies of their own: what they found must also be better
// at the finest one, or its solution starts from `start`.
void UndoIfWorse(const TextureProblem& problem,
                 const EnergyWeights& weights,
                 const ReconState& start,
                 double start_objective,
                 const std::function<void(const std::string&)>& print,
                 ReconState* state) {
  state->colors.assign(problem.NumChannels() * problem.texels.size(), 0.0f);
  SolveColors(problem, state);
  if (EvaluateEnergy(problem, weights, *state).Objective() <= start_objective) {
    return;
  }
  print("  the coarse levels raised the energy of the finest: undone");
  *state = start;
}

void CountFrames(const TextureProblem& problem, PhotometricResult* result) {
  result->plane_texels = problem.plane_texels;
  result->plane_frames.assign(problem.NumPlanes(), 0);
  std::vector<int> last(problem.NumPlanes(), -1);
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    for (size_t i = problem.observations.begin[k];
         i < problem.observations.begin[k + 1];
         ++i) {
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

void StoreResult(const TextureProblem& problem,
                 const ReconState& state,
                 PhotometricResult* result) {
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    result->cam_from_world.push_back(state.CamFromWorld(k));
  }
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    result->planes.push_back(state.PlaneAt(j, problem.anchors[j]));
  }
  if (std::any_of(state.warps.begin(), state.warps.end(), [](double f) {
        return f != 0;
      })) {
    result->warps = state.warps;
  }
  CountFrames(problem, result);
}

}  // namespace

PhotometricResult RunPhotometricStage(
    const TriMesh& mesh,
    const PlanarPartition& partition,
    const std::vector<Plane>& planes,
    const std::vector<SurfaceMoments>& surface,
    const Atlas& atlas,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& cam_from_world,
    const VisibilityOptions& visibility,
    const PhotometricOptions& options,
    KeyframeImages* keyframe_images,
    const std::function<void(const std::string&)>& print) {
  PhotometricResult result;
  const RayScene scene(mesh);
  const TexelSampler sampler(mesh,
                             partition,
                             planes,
                             atlas,
                             scene,
                             sequence,
                             keyframes,
                             cam_from_world,
                             visibility,
                             options);
  result.stride = options.stride > 0 ? options.stride : sampler.ChooseStride();
  const int levels = UsefulLevels(options.levels, sequence.calibration().color);
  std::vector<int> strides;
  for (int level = 0; level < levels; ++level) {
    strides.push_back(result.stride << level);
  }
  std::vector<SampledTexels> samples = sampler.Sample(strides);
  SampledTexels& sampled = samples[0];
  Background fingerprint([&] {
    result.observation_fingerprint =
        ObservationFingerprint(sampled.texels, sampled.observations);
  });
  if (options.exposure) {
    result.exposure =
        CalibrateExposures(sampled.texels,
                           Thinned(sampled.observations, kExposureSamples),
                           planes,
                           sequence.calibration().color,
                           cam_from_world,
                           *keyframe_images,
                           options.exposure_calibration);
    print(ExposureLine(result.exposure));
  }
  SetExposures(
      result.exposure.exposures, options.smoothing_sigma_px, keyframe_images);
  const KeyframeImages& images = *keyframe_images;
  result.texels = sampled.texels.size();
  fingerprint.Finish();
  result.visibility = sampled.counts;

  const Schedule schedule =
      ParseSchedule(options.schedule, options.solver.joint_method);
  CheckObservationLimit(
      options.formulation,
      PhasesOf(schedule, options.solver.joint_method),
      sampled.observations.size() *
          (options.formulation.channels == Channels::kRgb ? 3 : 1));
  std::vector<DepthMoment> depth_moments;
  if (options.weights.depth_weight > 0) {
    depth_moments = ComputeDepthMoments(partition,
                                        planes,
                                        scene,
                                        sequence,
                                        keyframes,
                                        cam_from_world,
                                        DepthMomentOptions());
  }
  const LevelInputs inputs = {options,
                              sequence,
                              cam_from_world,
                              sampler.anchors(),
                              depth_moments,
                              surface,
                              atlas.spacing_m};
  PhotometricLevel finest(inputs, images, 0, result.stride, std::move(sampled));
  const TextureProblem& problem = finest.problem();
  result.lattice = problem.lattice;
  ReconState state = InitialState(problem, planes);
  EnergyWeights weights = options.weights;
  weights.texel_weight = result.stride * result.stride;
  weights.lambda1 = InitialLambda1(problem, weights, state);
  result.lambda1 = weights.lambda1;
  weights.prior.scale = InitialPriorScale(problem, weights, state);
  const ReconState start = state;
  finest.AddTerms(options.terms, start, weights.texel_weight);

  print(
      "  round  phase            E_c   lambda1 E_p   lambda2 E_s        E_tex"
      "     others  rms grey  result    wall s");
  // Coarse levels leave threads idle, and do not need to know this.
  Background initial([&] { result.initial = finest.Evaluate(weights, start); });
  if (images.store.InFile()) initial.Finish();  // not the memory of both
  RunCoarseLevels(inputs,
                  images,
                  strides,
                  weights,
                  schedule,
                  start,
                  print,
                  &samples,
                  &state,
                  &result.trace);
  initial.Finish();
  result.trace.initial = result.initial;
  print(PhaseLine(
      "0", "start", result.initial, weights.lambda1, weights.lambda2, "", 0));
  if (levels > 1) {
    UndoIfWorse(
        problem, weights, start, result.initial.Objective(), print, &state);
  }
  RunLevel(
      problem, weights, options, schedule, 0, print, &state, &result.trace);
  // Poses and planes moved after the last colour step.
  SolveColors(problem, &state);
  result.final_terms = finest.Evaluate(weights, state);
  StoreResult(problem, state, &result);
  return result;
}

}  // namespace facet
