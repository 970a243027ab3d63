// SPDX-License-Identifier: MIT
// What the taps so far say: the height GP and the label GP over the candidates, the footprint, and of
// `surface: two_part` the process of the heights on an object; each built when it is asked for and never before. Where
// heights and labels have the same kernel and the same ratio of noise to signal they are two outputs of one process,
// with one factorisation.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/phases.hpp"
#include "experiment/systematic.hpp"
#include "gp/candidates.hpp"
#include "gp/doubt.hpp"
#include "gp/process.hpp"
#include "view/view.hpp"

#include <palpate/backend.hpp>
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <vector>

namespace palpate {

/// How a tap was made: whether the initial design chose it, by which motion, and what that adds to the noise of its
/// height, metres.
struct Manner {
  bool initial = false;
  int motion = 0;
  double roughness = 0.0;
};

/// The belief behind the acquisitions, and what the metrics and the record want beyond it. A plain value: taps are
/// noted by observe(), quantities asked for by ask(), the maps brought up to date by update(); what reads, computes
/// nothing. A map that nobody asked for, or that update() has not seen the last tap of, throws std::logic_error.
class TapBelief final : public Belief {
 public:
  /// `candidates`, `context` and `clock` must outlive the belief.
  TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context, PhaseClock& clock);

  /// What a contact of the tap that comes next says: its height less what motion and arm are thought to add, where the
  /// config has that learnt, and by it, by the scene's rule, whether it is one with an object.
  struct Reading {
    double height = 0.0;  ///< metres
    bool on = false;
  };
  Reading read(const Contact& contact, int motion = 0) const;
  /// What is taken off the heights of a motion as of now, where that is learnt.
  std::optional<Systematic::Estimate> systematic(int motion = 0) const;

  /// Notes a tap. Only contacts reach the models: heights above the desk, and labels 1 or 0, as they read. Where the
  /// config has learnt what is added to all heights, every contact so far is read again by what is thought of it now.
  void observe(const Target& place, const Contact& contact, const Manner& manner = {});

  /// Of the contacts so far: the motions that they were made by; those with an object; the number of the first tap that
  /// made one.
  const std::vector<int>& motions() const { return motions_; }
  const std::vector<Touch>& hits() const { return hits_; }
  std::optional<int> first_hit_tap() const;
  /// Returns the contacts so far whose label is not the one of read() before they were observed, by ascending tap.
  std::vector<Relabelled> relabelled() const;

  /// What was seen before the first tap, which all models know before any contact; and whether an object was.
  bool sees_object() const { return !hits_seen_.empty(); }

  /// From now on these quantities are kept and belong to the record: builds the models that they lack, with all taps so
  /// far, and updates. Models go through the very states that they would have had, had they been there from the first
  /// tap.
  void ask(Quantities wanted);
  /// The same, but nothing more belongs to the record.
  void build(Quantities wanted);

  /// Whether all models behind some quantities are built: then to build these costs a map, and no model changes.
  bool has_models_of(Quantities quantities) const;

  /// Has the models take in the taps noted since, one by one, fits included, and their maps follow.
  void update();

  /// The models behind some quantities, by their names: "height GP", "footprint primitives".
  std::vector<std::string> models_of(Quantities quantities) const;

  /// The quantities that belong to the record: those that were asked for, and what comes from the same models.
  Quantities recorded() const { return known(asked_); }

  /// What the reconstruction of the surface is made of.
  Quantities surface_reads() const;

  // Belief, for acquisitions.
  const Points& candidates() const override { return candidates_.points; }
  Area area() const override { return context_.scene.area(); }
  int taps() const override { return static_cast<int>(targets_.size()); }
  int initial_taps() const override { return initial_taps_; }
  const std::vector<Target>& targets() const override { return targets_; }
  const std::vector<Touch>& touches() const override { return touches_; }
  const Eigen::VectorXd& uncertainty() const override { return kept(uncertainty_); }
  const Eigen::VectorXd& weight() const override { return kept(clip_ ? weight_ : weight_mean_); }
  const Eigen::VectorXd& probability() const override { return kept(probability_); }
  const OutlineSample& outlines() const override { return outlines_; }
  const Eigen::VectorXd& height_mean() const override { return kept(height_mean_); }
  const Eigen::VectorXd& height_variance() const override { return kept(two_part_ ? object_variance_ : variance_); }

  /// Variance of the height GP, all taps seen, square metres: height_variance() unless the surface is two_part.
  /// There where the uncertainty is.
  const Eigen::VectorXd& all_taps_variance() const { return kept(variance_); }

  /// The mean of the label GP as it comes, whatever `label.clip` says.
  const Eigen::VectorXd& weight_mean() const { return kept(weight_mean_); }

  /// One output of a process.
  struct Output {
    const Process* process = nullptr;
    int output = 0;
    const FitSummary* last_fit = nullptr;  ///< the fit after the latest tap; null if none was due then
    explicit operator bool() const { return process != nullptr; }
  };
  /// The processes as far as they were built, null if nothing has asked for them. u comes from the height GP,
  /// height_mean() and height_variance() from the surface GP: the same one for `surface: single`, that of the taps
  /// on an object for `two_part`.
  Output height_gp() const { return output(heights_, 0); }
  Output label_gp() const { return output(labels(), label_output()); }
  Output surface_gp() const { return output(surface(), 0); }
  bool two_part() const { return two_part_; }
  /// Whether the probability is the weight, clipped: then what is shown of the outline is w, else p.
  bool footprint_is_weight() const { return !footprint_; }
  /// The footprint, if it is not the weight and was asked for; else null.
  const Footprint* footprint() const { return footprint_asked_ ? footprint_.get() : nullptr; }

  /// The probability that each contact so far lies, by the config's `height.outlier_probability`; empty where all are
  /// believed, or no height was asked for.
  const Eigen::VectorXd& doubt() const { return doubt_; }
  /// What rounding made necessary in the sum over which contacts are believed; jitter in square metres.
  const FactorReport& factors_of_outliers() const { return doubted_.report(); }
  int variances_clamped() const { return is_judged() ? doubted_.variances_clamped() : 0; }
  /// Those of at least kWorthALook, by the numbers of their taps.
  struct SuspectedOutlier {
    int tap = 0;
    double probability = 0.0;
    double by_label = 0.0;  ///< the part of it that the outlines account for, without a look at its height
  };
  std::vector<SuspectedOutlier> suspected_outliers() const;
  /// From which on a second look at the same place is worth a thought.
  static constexpr double kWorthALook = 0.1;
  /// The same of one contact; 0 where all are believed.
  double doubt_of(std::size_t contact) const {
    return contact < static_cast<std::size_t>(doubt_.size()) ? doubt_(static_cast<Eigen::Index>(contact)) : 0.0;
  }

  /// Whether the objects are thought to have been pushed since that contact: then it says nothing of its place any
  /// more.
  bool moved(std::size_t contact) const {
    const auto row = static_cast<Eigen::Index>(sights_.size() + contact);
    return contact < touches_taken_ && (places_now_.row(row) - places_.row(row)).squaredNorm() > 0.0;
  }

  /// Fits that found nothing better and kept the old values.
  int failed_fits() const { return heights_.failed_fits + labels_.failed_fits + object_.failed_fits; }

  /// Height of the desk, metres.
  double desk() const { return desk_; }

  /// Standard deviation of the noise of one tap's height, metres.
  double height_noise() const;

  /// Of a candidate: the height, and the probability if that is among the `wanted`. What predictable() says of these
  /// was asked for: where contacts are doubted, a height at one place needs no map.
  Prediction predict(int candidate, Quantities wanted) const;
  Quantities predictable(Quantities wanted) const;

 private:
  /// How far a tap is trusted comes in steps, so that a process is not made anew after every tap.
  static constexpr double kSteps = 10.0;

  /// A process and all that it is made from; built when it is asked for.
  struct Model {
    const char* name = "";
    PluginChoice kernel_choice, fitting_choice;
    std::shared_ptr<Kernel> kernel;
    std::shared_ptr<Fitting> fitting;
    std::vector<ProcessSettings> outputs;
    bool of_labels = false;  ///< the first output is the labels
    std::unique_ptr<Process> process;
    bool stale = false;  ///< its maps are older than the process
    FitSummary fit;
    int fit_at = 0;  ///< taps that the process had at its latest fit
    int failed_fits = 0;
  };

  Model make_model(const char* name, const PluginChoice& kernel, const PluginChoice& fitting,
                   const ProcessSettings& settings) const;
  Quantities known(Quantities asked) const;
  bool equal_for_good(const ExperimentOptions& options) const;
  const Model& labels() const { return joined_ ? heights_ : labels_; }
  int label_output() const { return joined_ ? 1 : 0; }
  /// What a model learns from: what was seen, and then the taps.
  bool of_hits(const Model& model) const { return &model == &object_; }
  int seen(const Model& model) const { return static_cast<int>(of_hits(model) ? hits_seen_.size() : sights_.size()); }
  int data(const Model& model) const {
    return seen(model) + static_cast<int>(of_hits(model) ? hits_.size() : touches_.size());
  }
  const Touch& datum(const Model& model, int number) const;
  const Model& surface() const { return two_part_ ? object_ : heights_; }
  static Output output(const Model& model, int output);
  void show(Model& model, int output);
  void take_in(Model& model);
  void fit(Model& model);
  void map_heights();
  void map_labels();
  void map_object();
  void map_surface(const Process& process);
  Prediction predict_among_lies(int candidate) const;
  /// Whether the surface is that of the judgement, else that of the process.
  bool is_judged() const { return lies_ && doubted_.judged() && doubted_.taps() == object_.process->size(); }
  /// All heights share what is not known of the correction.
  double shared_variance() const { return systematic_ ? systematic_->at(seconds_).variance : 0.0; }
  void map_footprint();
  void read_again();
  void begin_again();
  void begin_again(Model& model);
  Eigen::VectorXd shares_seen(bool of_hits) const;
  void judge();
  void believe();
  void correct();
  void follow();
  const Eigen::VectorXd& kept(const Eigen::VectorXd& map) const;

  const Candidates& candidates_;
  const Context& context_;
  PhaseClock& clock_;
  PosteriorSettings posterior_;
  double desk_;
  bool clip_;
  bool two_part_;
  bool joined_ = false;          ///< heights and labels are two outputs of one process
  std::vector<Target> targets_;  ///< of all taps
  int initial_taps_ = 0;
  Quantities asked_;
  bool current_ = true;   ///< update() has seen all taps
  bool flipped_ = false;  ///< labels of contacts that it has seen are others now
  double seconds_ = 0.0;  ///< robot time of all taps
  std::optional<Systematic> systematic_;
  Model heights_;
  Model labels_;  ///< unless joined
  Model object_;  ///< heights of the taps on an object
  std::vector<Sight> sights_;
  std::vector<std::size_t> hits_seen_;  ///< which of them are of an object
  std::vector<Touch> touches_;          ///< all contacts, heights above the desk
  std::vector<int> numbers_;            ///< of their taps
  Points places_, places_now_;          ///< of all that the footprint has taken: as made, and see Footprint
  std::vector<double> excess_, times_;  ///< of these: heights as they came, when,
  std::vector<int> motions_;            ///< by which motion (also where nothing is learnt),
  std::vector<bool> first_labels_;      ///< as they were read when they were made; only where that may change
  std::vector<double> share_;           ///< and how far its height is to be trusted for that, in [0, 1]
  bool uneven_ = false;                 ///< some less than others
  std::vector<Touch> hits_;             ///< those on an object
  std::optional<double> lies_;          ///< of contacts, where some are not believed
  DoubtedSurface doubted_;              ///< the surface GP, then
  Eigen::VectorXd doubt_, by_label_;    ///< a value a contact
  PluginChoice footprint_choice_;
  std::shared_ptr<Footprint> footprint_;  ///< null where it is the weight
  bool footprint_asked_ = false;
  bool outlines_asked_ = false;
  OutlineSample outlines_;
  bool height_asked_ = false;      ///< and not only whether it is believed
  bool sights_taken_ = false;      ///< by the footprint
  std::size_t touches_taken_ = 0;  ///< likewise
  /// Empty until somebody asks for them.
  Eigen::VectorXd uncertainty_, variance_, height_mean_, object_variance_, weight_mean_, weight_, probability_;
};

}  // namespace palpate
