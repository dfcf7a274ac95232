// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/fingerprint.h"

#include "util/hash.h"

namespace facet {

std::string ObservationFingerprint(const TexelSet& texels,
                                   const Observations& observations) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  Hash64 hash;
  hash.Add(texels.position);
  hash.Add(texels.plane);
  hash.Add(texels.face);
  hash.Add(observations.begin);
  hash.Add(observations.texel);
  return hash.Text();
}

}  // namespace facet
