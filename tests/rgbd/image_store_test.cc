// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/image_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/temp_dir.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using ::testing::HasSubstr;

cv::Mat RandomImage(int rows, int cols, int type, int seed) {
  cv::Mat image(rows, cols, type);
  cv::RNG random(static_cast<uint64_t>(seed));
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         cv::norm(a, b, cv::NORM_INF) == 0;
}

// Memory of the process that belongs to files [KB]; negative if unknown.
long FileKb() {
  std::ifstream in("/proc/self/status");
  std::string word;
  long kb = -1;
  while (in >> word) {
    if (word == "RssFile:") in >> kb;
  }
  return kb;
}

// Every type and size that a run keeps, read by several threads while others
// release them, a part of an image among them. Breaks if releasing loses what
// was written, or places overlap.
TEST(ImageStore, ImagesSurviveReleases) {
  const TempDir dir;
  const ImageStore store = ImageStore::InFolder(dir.path());
  const cv::Mat large = RandomImage(90, 100, CV_8UC3, 1);
  const std::vector<cv::Mat> images = {RandomImage(48, 64, CV_8UC3, 2),
                                       RandomImage(47, 61, CV_16UC1, 3),
                                       RandomImage(300, 400, CV_32FC1, 4),
                                       large(cv::Rect(10, 20, 33, 44))};
  std::vector<cv::Mat> kept(40);
  ParallelFor(0, kept.size(), [&](size_t i) {
    kept[i] = store.Keep(images[i % images.size()]);
  });
  std::vector<int> same(10 * kept.size());
  ParallelFor(0, same.size(), [&](size_t i) {
    same[i] = Same(kept[i % kept.size()], images[i % images.size()]) ? 1 : 0;
    ReleasePages(kept[(i * 7) % kept.size()]);
  });
  EXPECT_THAT(same, ::testing::Each(1));
}

// Breaks if what is kept counts as memory of the process, or what was read
// still does after its release.
TEST(ImageStore, OnlyWhatIsReadIsResident) {
  if (FileKb() < 0) GTEST_SKIP() << "the system does not say";
  const TempDir dir;
  const ImageStore store = ImageStore::InFolder(dir.path());
  const long image_kb = 16384, slack_kb = 2048;
  const cv::Mat image = RandomImage(4096, 4096, CV_8UC1, 1);
  const long before = FileKb();
  const cv::Mat kept = store.Keep(image);
  EXPECT_LT(FileKb(), before + slack_kb);
  EXPECT_TRUE(Same(kept, image));
  if (FileKb() < before + image_kb - slack_kb) {
    GTEST_SKIP() << "the folder is in memory";
  }
  ReleasePages(kept);
  EXPECT_LT(FileKb(), before + slack_kb);
}

// Images and copies of their headers outlive the store, places are used again
// only when the last header is gone, and two stores in a folder are separate.
TEST(ImageStore, ImagesOwnTheirPlace) {
  const TempDir dir;
  const cv::Mat image = RandomImage(64, 64, CV_8UC1, 1);
  const cv::Mat other = RandomImage(64, 64, CV_8UC1, 2);
  cv::Mat copy;
  {
    const ImageStore a = ImageStore::InFolder(dir.path());
    const ImageStore b = ImageStore::InFolder(dir.path());
    cv::Mat first = a.Keep(image);
    copy = first;
    first = b.Keep(other);
    const cv::Mat second = a.Keep(other);
    EXPECT_TRUE(Same(copy, image));
    EXPECT_TRUE(Same(first, other));
    EXPECT_TRUE(Same(second, other));
  }
  ReleasePages(copy);
  EXPECT_TRUE(Same(copy, image));
}

// Breaks if a run that is killed leaves its images behind.
TEST(ImageStore, TheFileHasNoName) {
  const TempDir dir;
  const ImageStore store = ImageStore::InFolder(dir.path());
  const cv::Mat kept = store.Keep(RandomImage(64, 64, CV_8UC1, 1));
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

// Without a file there is one header more and nothing else.
TEST(ImageStore, InMemoryItIsTheImageItself) {
  const cv::Mat image = RandomImage(64, 64, CV_8UC1, 1);
  const ImageStore store;
  EXPECT_FALSE(store.InFile());
  const cv::Mat kept = store.Keep(image);
  EXPECT_EQ(kept.data, image.data);
  ReleasePages(kept);
  ReleasePages(cv::Mat());
  EXPECT_TRUE(Same(kept, RandomImage(64, 64, CV_8UC1, 1)));
}

TEST(ImageStore, SaysWhereItCannotWrite) {
  const TempDir dir;
  try {
    ImageStore::InFolder(dir / "no_such_folder");
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("no_such_folder"));
    EXPECT_THAT(e.what(), HasSubstr("--max_memory_gb"));
  }
}

// A file that must not grow stands for a full disk. Breaks if the end of the
// disk is met as a signal, or only when the image is read.
TEST(ImageStore, AFullDiskIsAnError) {
  const TempDir dir;
  const ImageStore store = ImageStore::InFolder(dir.path());
  const cv::Mat image = RandomImage(256, 256, CV_8UC1, 1);
  const cv::Mat kept = store.Keep(image);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight = {100000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &tight);
  EXPECT_THROW(store.Keep(image), InputError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(Same(kept, image));
  EXPECT_TRUE(Same(store.Keep(image), image));
}

}  // namespace
}  // namespace facet
