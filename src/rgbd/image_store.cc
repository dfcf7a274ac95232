// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/image_store.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "util/errors.h"

namespace facet {
namespace {

size_t WholePages(size_t bytes) {
  static const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
  return (bytes + page - 1) / page * page;
}

}  // namespace

// An open file without a name, and which of its parts are free.
class ImageStore::File {
 public:
  explicit File(const std::string& folder) : folder_(folder) {
    std::string path = folder + "/.images.XXXXXX";
    descriptor_ = mkstemp(path.data());
    if (descriptor_ < 0) Fail("create");
    unlink(path.c_str());
    fcntl(descriptor_, F_SETFD, FD_CLOEXEC);
  }
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  // Written, not copied into the mapping: a full disk is an error of a write
  // but would be a fatal signal there.
  off_t Write(const uchar* data, size_t bytes) {
    const off_t begin = Take(WholePages(bytes));
    for (size_t done = 0; done < bytes;) {
      const ssize_t n = pwrite(descriptor_,
                               data + done,
                               bytes - done,
                               begin + static_cast<off_t>(done));
      if (n < 0 && errno == EINTR) continue;
      if (n == 0) errno = ENOSPC;
      if (n <= 0) Fail("write");
      done += static_cast<size_t>(n);
    }
    return begin;
  }

  uchar* Map(off_t begin, size_t bytes) {
    void* data =
        mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor_, begin);
    if (data == MAP_FAILED) Fail("map");
    return static_cast<uchar*>(data);
  }

  void GiveBack(off_t begin, size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_[WholePages(bytes)].push_back(begin);
  }

 private:
  // Images come in a few sizes: what is free is used again as a whole.
  off_t Take(size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<off_t>& same_size = free_[bytes];
    off_t begin = end_;
    if (same_size.empty()) {
      end_ += static_cast<off_t>(bytes);
    } else {
      begin = same_size.back();
      same_size.pop_back();
    }
    return begin;
  }

  [[noreturn]] void Fail(const char* what) const {
    const std::string why = std::strerror(errno);
    throw InputError(std::string("cannot ") + what +
                     " the scratch file for images in " + folder_ + ": " + why +
                     "; make room there, or keep images in memory with a "
                     "larger --max_memory_gb");
  }

  const std::string folder_;
  int descriptor_ = -1;
  std::mutex mutex_;
  off_t end_ = 0;
  std::map<size_t, std::vector<off_t>> free_;  // by size
};

struct ImageStore::Place {
  std::shared_ptr<File> file;
  off_t begin = 0;
};

// What OpenCV calls when the last header of an image is gone.
class ImageStore::Places : public cv::MatAllocator {
 public:
  static const Places* Get() {
    static const Places places;
    return &places;
  }

  // A header of the image in the file.
  static cv::Mat Hold(const Place& place, const cv::Mat& image) {
    const size_t bytes = image.total() * image.elemSize();
    uchar* data = place.file->Map(place.begin, bytes);
    auto* u = new cv::UMatData(Get());
    u->data = u->origdata = data;
    u->size = bytes;
    u->refcount = 1;
    u->userdata = new Place(place);
    cv::Mat held(image.rows, image.cols, image.type(), data);
    held.u = u;
    return held;
  }

  void deallocate(cv::UMatData* u) const override {
    munmap(u->origdata, u->size);
    const std::unique_ptr<Place> place(static_cast<Place*>(u->userdata));
    place->file->GiveBack(place->begin, u->size);
    u->userdata = nullptr;
    delete u;
  }

  // Only for headers made above.
  using Flag = cv::AccessFlag;
  cv::UMatData* allocate(int dims,
                         const int* sizes,
                         int type,
                         void* data,
                         size_t* step,
                         Flag flags,
                         cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(
        dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData*, Flag, cv::UMatUsageFlags) const override {
    return false;
  }
};

ImageStore ImageStore::InFolder(const std::string& folder) {
  ImageStore store;
  store.file_ = std::make_shared<File>(folder);
  return store;
}

cv::Mat ImageStore::Keep(const cv::Mat& image) const {
  if (!file_ || image.empty()) return image;
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  const off_t begin =
      file_->Write(whole.data, whole.total() * whole.elemSize());
  return Places::Hold({file_, begin}, whole);
}

void ReleasePages(const cv::Mat& image) {
  if (!image.u || image.u->currAllocator != ImageStore::Places::Get()) return;
  madvise(image.u->origdata, image.u->size, MADV_DONTNEED);
}

}  // namespace facet
