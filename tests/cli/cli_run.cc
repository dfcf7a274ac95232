// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "tests/cli/cli_run.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "util/atomic_file.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

// In the child: streams to files, then the program.
[[noreturn]] void Execute(const std::string& program,
                          const std::vector<std::string>& arguments,
                          const std::string& out,
                          const std::string& err,
                          int timeout_s) {
  const auto redirect = [](const std::string& file, int stream) {
    const int fd = open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    dup2(fd, stream);
  };
  redirect(out, STDOUT_FILENO);
  redirect(err, STDERR_FILENO);
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) {
    argv.push_back(const_cast<char*>(a.c_str()));
  }
  argv.push_back(nullptr);
  alarm(timeout_s);  // survives exec
  execv(program.c_str(), argv.data());
  _exit(127);
}

// Unlike ReadFile, an empty file is fine.
std::string Slurp(const std::string& path) {
  std::ostringstream content;
  content << std::ifstream(path).rdbuf();
  return content.str();
}

size_t Count(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos;
       at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

std::string Describe(const Outcome& outcome) {
  return outcome.command + "\nexit code " + std::to_string(outcome.code) +
         "\nstderr: " + outcome.err;
}

}  // namespace

Outcome RunProgram(const std::string& program,
                   const std::vector<std::string>& arguments,
                   int timeout_s) {
  const TempDir dir;
  const std::string path = std::string(FACET_BIN_DIR) + "/facet-" + program;
  Outcome outcome;
  outcome.command = path;
  for (const std::string& a : arguments) outcome.command += " '" + a + "'";
  const pid_t child = fork();
  if (child == 0) {
    Execute(path, arguments, dir / "out", dir / "err", timeout_s);
  }
  int status = 0;
  waitpid(child, &status, 0);
  outcome.code =
      WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = Slurp(dir / "out");
  outcome.err = Slurp(dir / "err");
  return outcome;
}

std::string Fixture(const std::string& name) {
  return std::string(FACET_CLI_SCAN_DIR) + "/" + name;
}

Outcome Reconstruct(const std::string& output,
                    const std::vector<std::string>& extra) {
  std::vector<std::string> arguments = {"--flagfile=" + Fixture("small.flags"),
                                        "--sequence=" + Fixture("scan"),
                                        "--mesh=" + Fixture("dense.ply"),
                                        "--output=" + output};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  return RunProgram("reconstruct", arguments);
}

void ExpectRefused(const Outcome& outcome,
                   int code,
                   const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.code, code) << Describe(outcome);
  EXPECT_EQ(Count(outcome.err, "error: "), 1u) << Describe(outcome);
  const size_t at = outcome.err.find("error: ");
  const std::string sentence =
      at == std::string::npos ? "" : outcome.err.substr(at);
  for (const std::string& word : words) {
    EXPECT_NE(sentence.find(word), std::string::npos)
        << "'" << word << "' is not in the message\n"
        << Describe(outcome);
  }
  for (const char* trace : {"terminate called",
                            "Check failed",
                            "stack trace",
                            "Segmentation",
                            "AddressSanitizer"}) {
    EXPECT_EQ(Count(outcome.err, trace), 0u) << Describe(outcome);
  }
}

void ExpectSuccess(const Outcome& outcome) {
  EXPECT_EQ(outcome.code, 0) << Describe(outcome);
}

void ExpectWarning(const Outcome& outcome,
                   const std::string& run_folder,
                   const std::string& words) {
  EXPECT_GE(Count(outcome.err, words), 1u) << Describe(outcome);
  const nlohmann::json report = ReadJson(run_folder + "/report.json");
  EXPECT_NE(report["warnings"].dump().find(words), std::string::npos)
      << report["warnings"];
}

void ExpectNothingIn(const std::string& folder) {
  if (!fs::exists(folder)) return;
  EXPECT_TRUE(fs::is_directory(folder));
  for (const auto& entry : fs::directory_iterator(folder)) {
    ADD_FAILURE() << "left behind: " << entry.path();
  }
}

void ExpectNoPartialFile(const std::string& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos)
        << entry.path();
  }
}

nlohmann::json ReadJson(const std::string& path) {
  return nlohmann::json::parse(ReadFile(path));
}

ScanCopy::ScanCopy() {
  for (const auto& entry : fs::directory_iterator(Fixture("scan"))) {
    fs::create_symlink(entry.path(), dir_ / entry.path().filename().string());
  }
}

std::string ScanCopy::FrameFile(int number, const std::string& rest) const {
  char name[32];
  std::snprintf(name, sizeof(name), "frame-%06d.", number);
  return dir_ / (name + rest);
}

// The rename replaces the link, not what it points to.
void ScanCopy::Write(const std::string& file,
                     const std::string& content) const {
  WriteFileAtomically(file, content);
}

void ScanCopy::SetInfo(const std::string& key, const std::string& value) const {
  std::string text = ReadFile(dir_ / "info.txt");
  const size_t begin = text.find(key + " = ") + key.size() + 3;
  text.replace(begin, text.find('\n', begin) - begin, value);
  Write(dir_ / "info.txt", text);
}

}  // namespace facet
