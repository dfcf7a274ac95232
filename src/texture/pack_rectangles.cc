// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/pack_rectangles.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstddef>

namespace {

// qsort() may order equal rectangles differently from one C library to the
// next; a stable sort does not.
template <typename Rect>
void StableSort(Rect* rectangles,
                size_t count,
                size_t,
                int (*compare)(const void*, const void*)) {
  std::stable_sort(
      rectangles, rectangles + count, [&](const Rect& a, const Rect& b) {
        return compare(&a, &b) < 0;
      });
}

}  // namespace

#define STBRP_SORT StableSort
#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#include <stb/stb_rect_pack.h>

namespace facet {

int PackRectangles(int page_width,
                   int page_height,
                   std::vector<PackedRectangle>* rectangles) {
  std::vector<stbrp_rect> waiting(rectangles->size());
  for (size_t i = 0; i < waiting.size(); ++i) {
    waiting[i].id = static_cast<int>(i);
    waiting[i].w = (*rectangles)[i].width;
    waiting[i].h = (*rectangles)[i].height;
  }
  std::vector<stbrp_node> nodes(page_width);
  int page = 0;
  for (; !waiting.empty(); ++page) {
    stbrp_context context;
    stbrp_init_target(
        &context, page_width, page_height, nodes.data(), page_width);
    stbrp_pack_rects(
        &context, waiting.data(), static_cast<int>(waiting.size()));
    std::vector<stbrp_rect> left;
    for (const stbrp_rect& rect : waiting) {
      if (!rect.was_packed) {
        left.push_back(rect);
        continue;
      }
      PackedRectangle& out = (*rectangles)[rect.id];
      out.page = page;
      out.x = rect.x;
      out.y = rect.y;
    }
    CHECK_LT(left.size(), waiting.size()) << "a rectangle exceeds its page";
    waiting.swap(left);
  }
  return page;
}

}  // namespace facet
