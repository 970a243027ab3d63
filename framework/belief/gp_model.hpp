// SPDX-License-Identifier: MIT
// One Gaussian process of the belief: kernel, fitting and hyperparameters, and the posterior, which is built when a
// reader first needs it.
#pragma once

#include <palpate/phases.hpp>
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
  const char* stream;  ///< names the random numbers of its fits
  PluginChoice kernel, fitting;
  std::vector<GpSettings> outputs;
  EngineSettings engine;
  bool labels = false;        ///< output 0 has the labels, not the heights
  bool only_objects = false;  ///< it learns from data on an object
};

class GpModel {
 public:
  /// Creates the plugins. `candidates` and `context` must outlive the model. Throws Error if the fitting or the engine
  /// cannot work with the kernel.
  GpModel(GpDescription description, const CandidateGrid& candidates, const Context& context);

  /// Adds a second output, the labels. Only before show().
  void add_labels(const GpSettings& settings) { description_.outputs.push_back(settings); }

  /// Whether a fit is due after any of the first `taps` contacts.
  bool is_fitted_within(int taps) const;

  const EngineSettings& engine() const { return description_.engine; }

  /// Builds the posterior, with the maps of an output from 0. Returns whether anything was missing.
  bool show(int output);
  bool is_built() const { return process_ != nullptr; }
  bool shows(int output) const { return process_ && process_->shown() > output; }
  const GaussianProcess& process() const { return *process_; }
  /// The fit after the latest contact; null if none was due then.
  const FitSummary* last_fit() const { return fit_at_ > 0 && fit_at_ == process_->size() ? &fit_ : nullptr; }
  int failed_fits() const { return failed_fits_; }
  /// Standard deviation of the noise of output 0, now.
  double noise() const { return process_ ? process_->settings().noise : description_.outputs.front().noise; }

  // Updates; each does nothing before show(), and notes whether maps have become stale.
  /// Takes in the data since, one by one, each with its fit: so a model that is built late has the states of one that
  /// was there from the first tap.
  void add_data(const ContactLog& log, PhaseClock* clock);
  /// Sets the heights of all data as they are read now.
  void set_heights(const ContactLog& log);
  /// Sets the positions of all data, and how far each is trusted; a row or number for each datum of the log.
  void set_positions(const ContactLog& log, const Points& positions);
  void set_trust(const ContactLog& log, const Eigen::VectorXd& trust);
  /// Forgets all data, as labels have changed.
  void reset();

  /// Whether the maps are older than the posterior.
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
  /// The row in the log of a datum of this model.
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
