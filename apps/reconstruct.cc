// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-reconstruct: an RGB-D scan and its dense mesh in, a light textured mesh
// of planes out.
#include "apps/flags/reconstruct.h"

#include <gflags/gflags.h>

#include "apps/init_app.h"
#include "pipeline/reconstruct.h"
#include "pipeline/stage_clock.h"
#include "util/parallel_for.h"
#include "util/resources.h"

DECLARE_int32(threads);
DECLARE_string(profile);

namespace {

int Main() {
  const facet::Stopwatch watch;
  const facet::ReconstructOptions options =
      facet::ReconstructOptionsFromFlags();
  facet::SetNumThreads(FLAGS_threads);
  const nlohmann::json report = facet::Reconstruct(options);
  char line[300];
  std::snprintf(line,
                sizeof(line),
                "done in %.1f s (%.1f CPU s): %s/report.json",
                watch.WallSeconds(),
                watch.CpuSecondsSince(),
                options.output_path.c_str());
  facet::PrintLine(line);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const facet::AppDescription description = {
      "Turns an RGB-D scan and its dense mesh into a light, textured mesh of "
      "planes.\n  facet-reconstruct --sequence=SCAN --mesh=DENSE.ply "
      "--output=RUN",
      [] { return facet::ProfileFlags(FLAGS_profile); }};
  return facet::RunApp(argc, argv, description, Main);
}
