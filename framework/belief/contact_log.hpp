// SPDX-License-Identifier: MIT
// The results of all taps, and how they are read now: the height of a contact without the offset of arm and motion, and
// whether it is on an object. Later taps may change how earlier ones are read.
#pragma once

#include "belief/camera_view.hpp"
#include "belief/height_map_options.hpp"
#include "gp/offset_model.hpp"

#include <palpate/scene.hpp>
#include <palpate/tap.hpp>

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpate {

/// Taps, and the data that models learn from: first the points of the prior view, then the contacts. A row is the index
/// of a datum. Heights are metres above the desk.
class ContactLog {
 public:
  /// `scene` must outlive the log. Throws Error for a prior view that cannot be read.
  ContactLog(const HeightMapOptions& options, const Scene& scene);

  /// How a result is read.
  struct Reading {
    double height = 0.0;  ///< metres, in the frame of the scene
    bool on = false;      ///< on an object
  };
  /// Returns how the contact of the next tap would be read. Changes nothing.
  Reading read(const TapResult& result, int motion) const;
  /// Whether the config estimates the offset of arm and motions (`belief.height.offset`).
  bool has_offset() const { return offset_.has_value(); }
  /// Returns the variance of that estimate now, which all heights share, square metres; 0 without.
  double offset_variance() const { return offset_ ? offset_->at(seconds_).variance : 0.0; }

  /// Adds a tap, and reads all contacts again if offsets are estimated. `noise`: standard deviation of a height by the
  /// most precise motion, metres.
  void add(const TapRequest& request, const TapResult& result, double noise);

  /// Whether the label of a contact before the latest has changed since reset_changed_labels().
  bool has_changed_labels() const { return changed_; }
  void reset_changed_labels() { changed_ = false; }

  int taps() const { return taps_; }

  // The contacts, in their order, and the number of the tap of each.
  const std::vector<Touch>& contacts() const { return contacts_; }
  const std::vector<Touch>& object_contacts() const { return object_contacts_; }
  const std::vector<int>& tap_numbers() const { return tap_numbers_; }

  // The data.
  int size() const { return prior_size() + static_cast<int>(contacts_.size()); }
  int prior_size() const { return static_cast<int>(prior_.size()); }
  const std::vector<ViewedSquare>& prior() const { return prior_; }
  const Touch& datum(int row) const;
  /// Rows of the data on an object, ascending, and the number of those in the prior view.
  const std::vector<int>& object_rows() const { return object_rows_; }
  int prior_objects() const { return prior_objects_; }
  /// Returns for each datum how far its height is trusted, in (0, 1]: `noise`^2 over the variance of its own noise, and
  /// of a contact times 1 - `outlier_probability` (of each contact). Both factors come in tenths, and a contact has
  /// 0.001 at least.
  Eigen::VectorXd trust(const Eigen::VectorXd& outlier_probability, double noise) const;
  /// Whether any datum has another noise than the others.
  bool has_uneven_noise() const { return uneven_; }

 private:
  void read_again();
  void find_object_rows();

  const Scene& scene_;
  int taps_ = 0;
  double seconds_ = 0.0;  ///< robot time of all taps
  std::optional<OffsetModel> offset_;
  std::vector<ViewedSquare> prior_;
  int prior_objects_ = 0;
  std::vector<Touch> contacts_, object_contacts_;
  std::vector<int> object_rows_;
  bool changed_ = false;
  bool uneven_ = false;
  // Of each contact.
  std::vector<int> tap_numbers_, motions_;
  std::vector<double> raw_heights_, begins_;  ///< above the desk as measured; robot time before the tap
  std::vector<double> shares_;                ///< variance of the most precise motion over that of its own
};

}  // namespace palpate
