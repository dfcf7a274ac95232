// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/init_app.h"

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <sstream>
#include <vector>

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

bool IsFlag(const std::string& name) {
  gflags::CommandLineFlagInfo info;
  if (gflags::GetCommandLineFlagInfo(name.c_str(), &info)) return true;
  return name.compare(0, 2, "no") == 0 &&
         gflags::GetCommandLineFlagInfo(name.c_str() + 2, &info) &&
         info.type == "bool";
}

// gflags skips unknown flags of flag files: a typing error would be silent.
void CheckFlagFile(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos || line[begin] == '#') continue;
    if (line[begin] != '-') return;  // flags of named programs from here on
    const size_t name = line.find_first_not_of('-', begin);
    if (name == std::string::npos) continue;
    const size_t end = line.find_first_of("= \t\r", name);
    const std::string flag = line.substr(name, end - name);
    if (IsFlag(flag)) continue;
    throw OptionsError(path + ", line " + std::to_string(number) +
                       ": unknown flag '" + flag + "', see --help");
  }
}

// Checks the files of every --flagfile=A,B or --flagfile A,B.
void CheckFlagFiles(int argc, char** argv) {
  const std::string name = "flagfile";
  for (int i = 1; i < argc; ++i) {
    std::string arg = argv[i];
    arg.erase(0, std::min(arg.find_first_not_of('-'), arg.size()));
    if (arg.compare(0, name.size(), name) != 0) continue;
    std::string files;
    if (arg.size() == name.size() && i + 1 < argc) files = argv[i + 1];
    if (arg.size() > name.size() && arg[name.size()] == '=') {
      files = arg.substr(name.size() + 1);
    }
    std::stringstream list(files);
    for (std::string file; std::getline(list, file, ',');) CheckFlagFile(file);
  }
}

int ShowHelp(const char* program, const AppDescription& description) {
  gflags::ShowUsageWithFlagsRestrict(program, description.help_filter.c_str());
  return kExitOk;
}

}  // namespace

std::string FlagsText(const std::set<std::string>& without) {
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  std::string text;
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    if (flag.filename.find("apps/") == std::string::npos) continue;
    if (without.count(flag.name) > 0) continue;
    text += "--" + flag.name + "=" + flag.current_value + "\n";
  }
  return text;
}

int RunApp(int argc,
           char** argv,
           const AppDescription& description,
           const std::function<int()>& body) {
  const std::string program = argv[0];
  gflags::SetUsageMessage(description.usage);
  gflags::SetVersionString(FACET_VERSION);
  // Progress is read by people and scripts, also through a pipe.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  try {
    CheckFlagFiles(argc, argv);
    if (description.profile_flags) {
      int count = argc;
      std::vector<char*> copy(argv, argv + argc + 1);
      char** arguments = copy.data();
      gflags::ParseCommandLineNonHelpFlags(&count, &arguments, true);
      if (WantsHelp()) return ShowHelp(argv[0], description);
      gflags::ReadFlagsFromString(description.profile_flags(), argv[0], true);
    }
    gflags::ParseCommandLineNonHelpFlags(&argc, &argv, true);
    if (WantsHelp()) return ShowHelp(argv[0], description);
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
