// SPDX-License-Identifier: MIT
// How a run begins, goes on and ends in its directory, whoever makes its taps: what session.cpp and callers_run.hpp
// have in common, and nobody else uses.
#pragma once

#include "record/run_directory.hpp"
#include "record/session.hpp"
#include "record/summary.hpp"
#include "space/from_any_side.hpp"

#include <array>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpate {

/// A run in a directory that this process holds, from its first tap here to what ends it. As the journal of its
/// experiment it asks the supervisor, passes taps to the record first and to the observer after it, and writes maps
/// where the config asks for them.
class Course final : public Journal {
 public:
  /// All must outlive it; the directory is set up. Observer and supervisor may be null.
  Course(const ResolvedConfig& config, RunDirectory& directory, Experiment& experiment, const Stopwatch& watch,
         Journal* observer = nullptr, Supervisor* supervisor = nullptr)
      : config_(config),
        directory_(directory),
        experiment_(experiment),
        watch_(watch),
        observer_(observer),
        supervisor_(supervisor) {}

  bool permits(const TapRecord& tap) override;
  void announce(const TapRecord& tap) override;
  void record(const TapRecord& tap, const std::array<double, kPhases>& seconds) override;

  /// Makes all taps that are left, and finishes.
  RunReport run() {
    return finish(failure_in([&] { experiment_.run(*this); }));
  }

  /// Goes on with the run by `part`, and says of an exception why the run ends with it; "" if there was none.
  template <class Part>
  static std::string failure_in(const Part& part) {
    try {
      part();
      return {};
    } catch (const std::exception& trouble) {
      return trouble.what();
    } catch (...) {
      return "a plugin threw an object that is not a std::exception";
    }
  }

  /// Writes what ends a run. `failure`: why it did not end well, else ""; then it is thrown, once all is written.
  RunReport finish(std::string failure);

 private:
  void look_at_surface();
  void write_maps(int number) const;

  const ResolvedConfig& config_;
  RunDirectory& directory_;
  Experiment& experiment_;
  const Stopwatch& watch_;
  Journal* observer_;
  Supervisor* supervisor_;
  // Of the state that the tap under way was chosen from, for the observer.
  Errors errors_;
  std::optional<double> expected_rmse_;
};

/// What a run was when it began, as its manifest says; "" where that is not known.
struct RecordedRun {
  std::string name;
  std::string identity;  ///< ResolvedConfig::identity
};
RecordedRun recorded_run(const std::filesystem::path& directory);

enum class Taps { by_backend, by_caller };

/// An experiment, and the directory for its record; neither where the directory has the finished run already.
struct Begun {
  std::unique_ptr<RunDirectory> directory;
  std::unique_ptr<Experiment> experiment;
};

/// A run begun in `directory`, as start_run() says. Throws Error, too, where `supervised` taps put nothing at risk.
Begun begin_run(const Workshop& workshop, const ResolvedConfig& config, const std::filesystem::path& directory,
                bool force, bool supervised);

/// The experiment as it was after the recorded taps of a directory that this process holds; none where the run is done.
/// Throws Error as resume_run() does.
std::unique_ptr<Experiment> go_on(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                                  const ResumeOptions& options, Taps taps, bool supervised);

/// Throws Error where the taps of a run are made by somebody else. `command`: of the program, that was to make them.
void check_who_taps(const ResolvedConfig& config, Taps taps, const std::string& command);

}  // namespace palpate
