// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "benchmarks/peers/peer_run.h"

#include <glog/logging.h>
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "mesh/clean.h"
#include "mesh/mesh_io.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/resources.h"

namespace facet {
namespace {

double UserSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " or ") + word;
  }
  return text;
}

PeerArgs ParseArgs(int argc, char** argv, const PeerUsage& usage) {
  const std::string text =
      "usage: METHOD INPUT COUNT OUTPUT" +
      std::string(usage.needs_sequence ? " SEQUENCE" : "") + ", METHOD is " +
      Join(usage.methods);
  if (argc != (usage.needs_sequence ? 6 : 5)) throw OptionsError(text);
  PeerArgs args{argv[1], argv[2], 0, argv[4], argc > 5 ? argv[5] : ""};
  const auto& methods = usage.methods;
  if (std::count(methods.begin(), methods.end(), args.method) == 0) {
    throw OptionsError(text + ", not '" + args.method + "'");
  }
  char* end = nullptr;
  const long count = std::strtol(argv[3], &end, 10);
  if (*argv[3] == '\0' || *end != '\0' || count < 0 || count > 1000000000) {
    throw OptionsError(text + "; COUNT '" + argv[3] + "' is not a number");
  }
  args.count = static_cast<int>(count);
  return args;
}

}  // namespace

TriMesh ReadPeerMesh(const std::string& path) {
  TriMesh mesh = ReadMesh(path).mesh;
  CleanMesh({}, &mesh);
  SplitNonManifold(&mesh);
  return mesh;
}

void WriteSimplified(const std::string& path, TriMesh mesh) {
  std::vector<int> new_index(mesh.NumVertices(), -1);
  TriMesh compact;
  compact.faces = std::move(mesh.faces);
  for (std::array<int, 3>& face : compact.faces) {
    for (int& v : face) {
      if (new_index[v] < 0) {
        new_index[v] = static_cast<int>(compact.vertices.size());
        compact.vertices.push_back(mesh.vertices[v]);
      }
      v = new_index[v];
    }
  }
  WritePly(path, compact);
}

StageMeter::StageMeter() {
  malloc_trim(0);
  ResetPeakRss();
  wall_start_ = std::chrono::steady_clock::now();
  user_start_ = UserSeconds();
}

void StageMeter::Print(const std::string& stage, size_t count) const {
  const double user = UserSeconds() - user_start_;
  const std::chrono::duration<double> wall =
      std::chrono::steady_clock::now() - wall_start_;
  std::printf("%s,%.3f,%.3f,%.1f,%zu\n",
              stage.c_str(),
              user,
              wall.count(),
              PeakRssMb(),
              count);
}

int ExitCodeOf(const char* program, const std::function<void()>& body) {
  int code = kExitInternal;
  std::string what;
  try {
    body();
    return kExitOk;
  } catch (const OptionsError& e) {
    code = kExitOptions;
    what = e.what();
  } catch (const InputError& e) {
    code = kExitInput;
    what = e.what();
  } catch (const UnsolvableError& e) {
    code = kExitUnsolvable;
    what = e.what();
  } catch (const std::exception& e) {
    what = e.what();
  }
  const char* name = std::strrchr(program, '/');
  std::fprintf(stderr,
               "%s: error: %s\n",
               name != nullptr ? name + 1 : program,
               what.c_str());
  return code;
}

int RunPeer(int argc,
            char** argv,
            const PeerUsage& usage,
            const std::function<void(const PeerArgs&)>& body) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_minloglevel = google::ERROR;
  SetNumThreads(1);
  return ExitCodeOf(argv[0], [&] {
    const PeerArgs args = ParseArgs(argc, argv, usage);
    std::printf("stage,user_s,wall_s,peak_mb,count\n");
    body(args);
  });
}

}  // namespace facet
