// SPDX-License-Identifier: MIT
// Arguments of `palpate resume`.
#pragma once

#include "cli/launch_options.hpp"

#include <string>

namespace palpate::cli {

struct ResumeArguments {
  std::string directory;
  ResumeOptions options;
  bool step = false;
  std::string jobs;  ///< numbers of jobs of a sweep, for example 0-7,12; "": all
  LaunchArguments launch;
};

}  // namespace palpate::cli
