// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The no-reference blur metric of Crete et al. 2007 (method ch. 5).
#pragma once

#include "geometry/image_view.h"

namespace facet {

// In [0, 1]: 0 sharp, 1 blurred; a constant image is 1. Compares the image's
// neighbour differences with those of its 9-tap box blur, along x and y, and
// returns the larger of both directions.
double CreteBlur(const ImageView<float>& luma);

}  // namespace facet
