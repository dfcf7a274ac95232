// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The scans of an ablation: real ones from a file, synthetic ones by seed and
// noise.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace facet {

struct ScanSpec {
  std::string name;   // letters, digits, - _ . : part of file names
  std::string group;  // scans of one group are averaged in tables and plots
  std::string sequence, mesh;
  std::string true_poses, true_planes, true_mesh;  // empty = not known
  std::string flags;  // --name=value ... that hold for this scan alone
  // NaN = not known.
  double seed = std::numeric_limits<double>::quiet_NaN();
  double noise_mm = std::numeric_limits<double>::quiet_NaN();
  double noise_deg = std::numeric_limits<double>::quiet_NaN();
  bool synthetic = false;  // to be made by facet-synthesize and facet-fuse
};

// A JSON file (docs/formats.md). Relative paths count from its folder; all are
// returned absolute. Throws InputError naming the file and the scan.
std::vector<ScanSpec> ReadScans(const std::string& path);

// One a seed and noise level, in FOLDER/<name>/. Throws OptionsError unless
// noise_deg is empty (then 0.04 degrees a millimetre) or as long as noise_mm.
std::vector<ScanSpec> SyntheticScans(const std::vector<int>& seeds,
                                     const std::vector<double>& noise_mm,
                                     const std::vector<double>& noise_deg,
                                     const std::string& folder);

}  // namespace facet
