// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Loops over index ranges on several threads. Determinism rule of facet: a
// parallel loop writes only to places that belong to its index; sums are made
// per index or per fixed-size chunk and added up in index order afterwards, so
// results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace facet {

// Sets how many threads ParallelFor may use, for the whole process.
// 0 = one per core. Call from main().
void SetNumThreads(int num_threads);
int NumThreads();

// Calls body(i) for every i in [begin, end), `grain` indices a task.
void ParallelFor(size_t begin,
                 size_t end,
                 const std::function<void(size_t)>& body,
                 size_t grain = 1);

// Calls body(chunk_begin, chunk_end) for consecutive chunks of exactly `chunk`
// indices (the last one may be shorter). The chunks do not depend on the number
// of threads; chunk number = (chunk_begin - begin) / chunk.
void ParallelForChunks(size_t begin,
                       size_t end,
                       size_t chunk,
                       const std::function<void(size_t, size_t)>& body);

}  // namespace facet
