// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/warnings.h"

#include <glog/logging.h>

#include <mutex>

namespace facet {
namespace {

std::mutex mutex;
std::vector<std::string>& Store() {
  static std::vector<std::string> store;
  return store;
}

}  // namespace

void AddWarning(const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(mutex);
  LOG(WARNING) << sentence;
  Store().push_back(sentence);
}

void RestoreWarnings(const std::vector<std::string>& sentences) {
  const std::lock_guard<std::mutex> lock(mutex);
  Store().insert(Store().end(), sentences.begin(), sentences.end());
}

std::vector<std::string> Warnings() {
  const std::lock_guard<std::mutex> lock(mutex);
  return Store();
}

}  // namespace facet
