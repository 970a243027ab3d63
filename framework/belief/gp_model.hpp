// SPDX-License-Identifier: MIT
// One Gaussian process of the belief: kernel, fitting, hyperparameters and posterior. The posterior is built only when
// another part of the run first needs it.
#pragma once

#include <palpate/phase_clock.hpp>
#include "belief/contact_log.hpp"
#include "gp/candidate_grid.hpp"
#include "gp/gaussian_process.hpp"

#include <palpate/plugin.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace palpate {

/// A GP as the config describes it.
struct GpDescription {
  const char* stream;  ///< name of the random stream of its fits
  PluginChoice kernel, fitting;
  std::vector<GpSettings> outputs;
  EngineSettings engine;
  bool labels = false;        ///< whether output 0 is the labels instead of the heights
  bool only_objects = false;  ///< whether the GP learns only from data on objects
};

class GpModel {
 public:
  /// Creates the plugins. `candidates` and `context` must outlive the model. Throws Error if the fitting or the engine
  /// cannot work with the kernel.
  GpModel(GpDescription description, const CandidateGrid& candidates, const Context& context);

  /// Adds a second output, the labels. Must be called before show().
  void add_labels(const GpSettings& settings) { description_.outputs.push_back(settings); }

  /// Returns whether a fit is due after any of the first `taps` contacts.
  bool is_fitted_within(int taps) const;

  const EngineSettings& engine() const { return description_.engine; }

  /// Builds the posterior and the maps of the outputs 0 to `output`, unless they exist. Returns whether something was
  /// built.
  bool show(int output);
  bool is_built() const { return process_ != nullptr; }
  bool shows(int output) const { return process_ && process_->shown() > output; }
  const GaussianProcess& process() const { return *process_; }
  /// Returns the fit after the latest contact; null if no fit was due after this contact.
  const FitSummary* last_fit() const { return fit_at_ > 0 && fit_at_ == process_->size() ? &fit_ : nullptr; }
  int failed_fits() const { return failed_fits_; }
  /// Returns the current standard deviation of the noise of output 0.
  double noise() const { return process_ ? process_->settings().noise : description_.outputs.front().noise; }

  // Updates. Each function does nothing before show(), and marks the maps as stale if the posterior changes.
  /// Adds the data of the log that the GP lacks, one by one, with a fit after each datum for which a fit is due. So a
  /// model that is built late passes through the same states as a model that was built before the first tap.
  void add_data(const ContactLog& log, PhaseClock* clock);
  /// Sets the heights of all data to their current readings.
  void set_heights(const ContactLog& log);
  /// Set the positions of all data, or the trust in all data. `positions` has one row, and `trust` one value, per datum
  /// of the log.
  void set_positions(const ContactLog& log, const Points& positions);
  void set_trust(const ContactLog& log, const Eigen::VectorXd& trust);
  /// Removes all data, because labels have changed.
  void reset();

  /// Returns whether the maps are older than the posterior.
  bool is_stale() const { return stale_; }
  void set_stale(bool stale) { stale_ = stale; }
  void update_maps() { process_->update_maps(); }

 private:
  void create_plugins();
  int size(const ContactLog& log) const {
    return description_.only_objects ? static_cast<int>(log.object_rows().size()) : log.size();
  }
  int prior_size(const ContactLog& log) const {
    return description_.only_objects ? log.prior_objects() : log.prior_size();
  }
  /// Returns the row of the log that contains the datum with the index `datum` in this model.
  int row(const ContactLog& log, int datum) const {
    return description_.only_objects ? log.object_rows()[static_cast<std::size_t>(datum)] : datum;
  }
  void fit(int taps, PhaseClock* clock);

  GpDescription description_;
  const CandidateGrid& candidates_;
  const Context& context_;
  std::shared_ptr<Kernel> kernel_;
  std::shared_ptr<Fitting> fitting_;
  std::unique_ptr<GaussianProcess> process_;
  bool stale_ = false;
  FitSummary fit_;
  int fit_at_ = 0;  ///< number of data at the latest fit
  int failed_fits_ = 0;
};

}  // namespace palpate
