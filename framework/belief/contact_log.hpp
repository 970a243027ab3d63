// SPDX-License-Identifier: MIT
// The contacts of all taps as they are read now, and the data that models learn from them.
#pragma once

#include "belief/camera_view.hpp"
#include "belief/contact_reader.hpp"
#include "belief/height_map_options.hpp"

#include <palpate/scene.hpp>
#include <palpate/tap.hpp>

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace palpate {

/// Taps, and the data that models learn from: first the points of the prior view, then the contacts. A row is the index
/// of a datum. Heights are metres above the desk.
class ContactLog {
 public:
  /// `scene` must outlive the log. Throws Error for a prior view that cannot be read.
  ContactLog(const HeightMapOptions& options, const Scene& scene);

  /// Returns how contacts are read now.
  const ContactReader& reader() const { return reader_; }

  /// Adds a tap, and reads all contacts again if offsets are estimated. `noise`: standard deviation of a height by the
  /// most precise motion, metres.
  void add(const TapRequest& request, const TapResult& result, double noise);

  /// Returns whether the label of a contact before the latest has changed since the last call.
  bool take_label_changes() { return std::exchange(changed_, false); }

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
  void find_objects();

  ContactReader reader_;
  int taps_ = 0;
  std::vector<ViewedSquare> prior_;
  int prior_objects_ = 0;
  std::vector<Touch> contacts_, object_contacts_;
  std::vector<int> object_rows_;
  bool changed_ = false;
  bool uneven_ = false;
  // Of each contact.
  std::vector<int> tap_numbers_;
  std::vector<double> shares_;  ///< variance of the most precise motion over that of its own
};

}  // namespace palpate
