// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Files that appear whole or not at all: written to a temporary neighbour and
// renamed. Every output of facet goes through here.
#pragma once

#include <functional>
#include <string>

namespace facet {

// Calls `write` with the path of a temporary file in the folder of `path` (same
// extension, so that writers which look at it work) and renames the result to
// `path`. If `write` throws, the temporary file is removed and `path` is left
// as it was. Creates missing parent folders. Throws InputError when the folder
// cannot be written.
void WriteFileAtomically(
    const std::string& path,
    const std::function<void(const std::string& temporary_path)>& write);

// The same for content that is in memory.
void WriteFileAtomically(const std::string& path, const std::string& content);

// The whole file. Throws InputError naming the path.
std::string ReadFile(const std::string& path);

}  // namespace facet
