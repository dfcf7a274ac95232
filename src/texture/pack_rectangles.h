// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Rectangles onto pages, by the skyline packer of stb_rect_pack (method,
// Sec. 4.5).
#pragma once

#include <vector>

namespace facet {

struct PackedRectangle {
  int width = 0, height = 0;
  int page = 0, x = 0, y = 0;  // result
};

// Places all rectangles without overlap on pages of page_width x page_height
// and returns the number of pages. None may be larger than a page. The result
// depends on nothing but the arguments.
int PackRectangles(int page_width,
                   int page_height,
                   std::vector<PackedRectangle>* rectangles);

}  // namespace facet
