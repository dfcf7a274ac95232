// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The figures of one run, from the files of its folder (docs/formats.md).
#pragma once

#include <string>
#include <vector>

namespace facet {

// When a figure of two runs may be compared.
enum class Comparable {
  kAlways,            // measured against the truth, or time
  kSameObservations,  // the frozen set is the same
  kSameEnergy,        // the energy is the same function: also E(0), lambdas
};

struct Figure {
  std::string column;  // of results.csv
  std::string title;   // with unit, in tables; empty = not shown there
  Comparable comparable = Comparable::kAlways;
  std::string pointer;  // JSON pointer into report.json or into evaluation.json
  enum Source { kReport, kEvaluation, kPhotos, kComputed } source = kReport;
};

// All figures, in the order of the columns of results.csv. kPhotos are those of
// evaluation.json that exist only if frames were held out.
const std::vector<Figure>& Figures();
// Position in Figures(); the column must exist.
size_t FigureIndex(const std::string& column);

// A line of trace.csv.
struct TracePoint {
  int level = 0;  // of the image pyramid; energies of others are not comparable
  int round = 0;
  std::string phase;
  double e_c = 0, e_p = 0, e_s = 0, e_tex = 0, rms_grey = 0;
  // Mean over the problems of a phase, summed over the phases so far: what a
  // pose, a plane or the joint system has been iterated.
  double iterations = 0;
  double wall_s = 0, cpu_s = 0;
  // Against the truth, from evaluation.json; NaN = not known.
  double ate_mm = 0, plane_angle_deg = 0, plane_offset_mm = 0;
};

struct RunResult {
  size_t scan = 0, variant = 0;
  std::string id, folder;
  std::string problem = "not run";  // empty = finished
  std::string fingerprint;          // of texels and observations
  std::vector<double> figures;      // by Figures(), NaN = does not exist
  std::vector<TracePoint> trace;
  // Against the first variant of the scan.
  bool same_observations = true, same_energy = true;

  double Get(const std::string& column) const {
    return figures.empty() ? Missing() : figures[FigureIndex(column)];
  }
  // NaN if it must not be compared with the first variant.
  double Compared(size_t figure) const;

 private:
  static double Missing();
};

// Reads report.json, trace.csv and, if there, evaluation.json of a finished
// run. Computed figures are left NaN but for the times of the schedule. Throws
// InputError.
void ReadRun(const std::string& folder, bool held_out, RunResult* result);

}  // namespace facet
