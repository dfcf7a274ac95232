// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the programs of the comparison with peer tools have in common: they all
// work on the identical mesh, measure their algorithm alone and say it in the
// same words. One program a peer, so that memory and libraries are its own.
//
// Every program prints CSV: `stage,user_s,wall_s,peak_mb,count`, a line a
// stage.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"

namespace facet {

// The mesh as facet's stages get it: read, cleaned, manifold. Throws
// InputError.
TriMesh ReadPeerMesh(const std::string& path);

// Writes a simplified mesh without the vertices that no face uses.
void WriteSimplified(const std::string& path, TriMesh mesh);

// Measures from its construction to Print(). Construct it when the input is in
// the peer's own form and every other copy is freed: what the heap holds but
// does not use goes back to the system, and the peak of the memory starts anew.
// It includes the peer's input and its loaded libraries.
class StageMeter {
 public:
  StageMeter();
  // `count`: faces or clusters that came out.
  void Print(const std::string& stage, size_t count) const;

 private:
  std::chrono::steady_clock::time_point wall_start_;
  double user_start_;
};

// Arguments after the program's name: METHOD INPUT COUNT OUTPUT [SEQUENCE].
struct PeerArgs {
  std::string method, input;
  int count = 0;  // faces, clusters or iterations
  std::string output, sequence;
};

struct PeerUsage {
  std::vector<std::string> methods;
  bool needs_sequence = false;
};

// One thread, quiet logs, the CSV header; maps exceptions to exit codes with
// one sentence, as facet's programs do. Returns the exit code.
int RunPeer(int argc,
            char** argv,
            const PeerUsage& usage,
            const std::function<void(const PeerArgs&)>& body);

// Runs `body` and turns what it throws into an exit code and one sentence.
int ExitCodeOf(const char* program, const std::function<void()>& body);

}  // namespace facet
