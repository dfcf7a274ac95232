// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Where images are held from one use to the next: in ordinary memory, or in a
// scratch file, from which only those that are being read take memory.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace facet {

class ImageStore {
 public:
  // In memory.
  ImageStore() = default;
  // In a file in an existing folder, without a name: it is gone with the last
  // image and the last copy of the store, however the program ends. Throws
  // InputError if the folder cannot be written to. On a file system that lives
  // in memory nothing is saved.
  static ImageStore InFolder(const std::string& folder);

  bool InFile() const { return file_ != nullptr; }

  // The image itself, or its copy in the file, to be read only: a write ends
  // the program. No page of the copy is resident before it is read, and its
  // place is used again when its last header is gone. From any thread. A system
  // maps some 65,000 images at most. Throws InputError if the disk is full or
  // an image cannot be mapped.
  cv::Mat Keep(const cv::Mat& image) const;

 private:
  class File;
  struct Place;
  class Places;
  friend void ReleasePages(const cv::Mat& image);

  std::shared_ptr<File> file_;
};

// Gives the memory of an image in a file back; it is read in again where it is
// used next, also by threads that are at it. Nothing for images in memory.
void ReleasePages(const cv::Mat& image);

}  // namespace facet
