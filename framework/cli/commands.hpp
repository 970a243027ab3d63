// SPDX-License-Identifier: MIT
// One function a command. Each prints its result on stdout and returns the exit status; errors are thrown.
#pragma once

#include "config/compose.hpp"
#include "plugin/host.hpp"
#include "record/session.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::cli {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kBusy = 75;
constexpr int kInterrupted = 130;

/// What all commands share.
struct Program {
  const Installation& installation;
  const PluginHost& host;
  Composer& composer;
  Workshop workshop;
};

struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string runs = "runs";
  bool json = false;
  bool quiet = false;
  bool dry_run = false;
  bool force = false;
  bool print_config = false;
  bool origins = false;
};
int run(Program& program, const RunArguments& arguments);

struct SweepArguments {
  std::string config;
  std::vector<std::string> axes;
  std::string runs = "runs";
  int workers = 1;
  bool list = false;
  bool quiet = false;
};
int sweep(Program& program, const SweepArguments& arguments);

struct ResumeArguments {
  std::string directory;
  bool retry_failed = false;
  bool force = false;
  bool quiet = false;
  int workers = 1;
};
int resume(Program& program, const ResumeArguments& arguments);

int status(const std::string& directory);
int replay(Program& program, const std::string& directory);
int validate(Program& program, const std::vector<std::string>& configs);
int plugins(Program& program, const std::string& what, bool json);
int schema(Program& program);

}  // namespace palpate::cli
