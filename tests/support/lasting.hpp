// SPDX-License-Identifier: MIT
// Programs that are killed, and what their runs and sweeps have to look like at the end all the same.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate::test {

/// Starts palpate in `folder` and kills it after so many microseconds, whatever it does then.
void run_and_kill(const std::vector<std::string>& words, const std::filesystem::path& folder, int microseconds);

/// How many kills of a kind: as PALPATE_KILLS says, or the usual number, or few where few are to stand for many.
int wanted_kills(int usual, int few);

/// The only directory of a run or sweep, or nothing if the program was killed before it made one.
std::filesystem::path run_in(const std::filesystem::path& runs);

/// What a file of a run or a sweep must hold whether or not that was killed: clocks, memory and what tells of attempts
/// are left out.
std::string lasting(const std::filesystem::path& file);
/// The same of all files of a run or a sweep, by their names.
std::map<std::string, std::string> lasting_files(const std::filesystem::path& directory);

}  // namespace palpate::test
