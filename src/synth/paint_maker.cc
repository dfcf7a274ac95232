// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/paint_maker.h"

#include "synth/procedural.h"

namespace facet {

using Eigen::Vector3f;

Paint PaintMaker::Make(PaintStyle style) {
  Paint paint;
  paint.style = style;
  paint.seed = static_cast<uint32_t>(random_.NextBits() >> 33);
  return paint;
}

Paint PaintMaker::Wood() {
  Paint paint = Make(PaintStyle::kWood);
  paint.base = HsvColor(static_cast<float>(Range(0.06, 0.11)),
                        static_cast<float>(Range(0.35, 0.6)),
                        static_cast<float>(Range(0.5, 0.8)));
  paint.accent = 0.6f * paint.base;
  return paint;
}

Paint PaintMaker::Print() {
  Paint paint = Make(PaintStyle::kPrint);
  paint.base = Vector3f(0.9f, 0.89f, 0.86f);
  paint.accent = HsvColor(Unit(), 0.5f, 0.25f);
  return paint;
}

Paint PaintMaker::Cover() {
  Paint paint = Make(PaintStyle::kCover);
  paint.base = HsvColor(Unit(),
                        static_cast<float>(Range(0.25, 0.75)),
                        static_cast<float>(Range(0.3, 0.8)));
  paint.accent = HsvColor(Unit(),
                          static_cast<float>(Range(0.2, 0.7)),
                          static_cast<float>(Range(0.4, 0.9)));
  return paint;
}

Paint PaintMaker::Fabric() {
  Paint paint = Make(PaintStyle::kFabric);
  const float hue = Unit();
  paint.base = HsvColor(hue,
                        static_cast<float>(Range(0.2, 0.55)),
                        static_cast<float>(Range(0.4, 0.7)));
  paint.accent =
      HsvColor(hue + 0.3f * Unit(), 0.4f, static_cast<float>(Range(0.45, 0.8)));
  return paint;
}

}  // namespace facet
