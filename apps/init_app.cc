// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/init_app.h"

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <cstdio>
#include <cstring>
#include <exception>

#include "util/errors.h"

namespace facet {
namespace {

int Fail(const char* program, const char* what, int code) {
  const char* name = std::strrchr(program, '/');
  std::fprintf(stderr, "%s: error: %s\n", name ? name + 1 : program, what);
  return code;
}

// gflags answers --help with exit code 1 and hides the flags of other files:
// answer ourselves.
bool WantsHelp() {
  std::string value;
  for (const char* flag : {"help", "helpshort", "helpfull", "h"}) {
    if (gflags::GetCommandLineOption(flag, &value) && value == "true") {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string RawFlagValue(int argc, char** argv, const std::string& name) {
  std::string value;
  for (int i = 1; i < argc; ++i) {
    const char* arg = argv[i];
    while (*arg == '-') ++arg;
    if (std::strncmp(arg, name.c_str(), name.size()) != 0) continue;
    const char* rest = arg + name.size();
    if (*rest == '=') value = rest + 1;
    if (*rest == '\0' && i + 1 < argc) value = argv[i + 1];
  }
  return value;
}

int RunApp(int argc,
           char** argv,
           const AppDescription& description,
           const std::function<int()>& body) {
  const std::string program = argv[0];
  gflags::SetUsageMessage(description.usage);
  gflags::SetVersionString(FACET_VERSION);
  try {
    if (description.profile_flags) {
      gflags::ReadFlagsFromString(description.profile_flags(argc, argv),
                                  argv[0], true);
    }
    gflags::ParseCommandLineNonHelpFlags(&argc, &argv, true);
    if (WantsHelp()) {
      gflags::ShowUsageWithFlagsRestrict(argv[0], "apps/");
      return kExitOk;
    }
    gflags::HandleCommandLineHelpFlags();
    google::InitGoogleLogging(program.c_str());
    FLAGS_logtostderr = true;
    if (argc > 1) {
      throw OptionsError(std::string("unexpected argument '") + argv[1] +
                         "': every input is a flag, see --help");
    }
    return body();
  } catch (const OptionsError& e) {
    return Fail(program.c_str(), e.what(), kExitOptions);
  } catch (const InputError& e) {
    return Fail(program.c_str(), e.what(), kExitInput);
  } catch (const UnsolvableError& e) {
    return Fail(program.c_str(), e.what(), kExitUnsolvable);
  } catch (const std::bad_alloc&) {
    return Fail(program.c_str(),
                "out of memory: use a coarser mesh, fewer frames or a larger "
                "--texel_size",
                kExitUnsolvable);
  } catch (const std::exception& e) {
    return Fail(program.c_str(), e.what(), kExitInternal);
  }
}

}  // namespace facet
