// SPDX-License-Identifier: MIT
// Stores the contacts of all taps with their current readings (corrected height and label; see contact_reader.hpp), and
// the data from which the models learn.
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

/// Taps, and the data from which the models learn: first the squares of the camera's view, then the contacts. A row is
/// the index of a datum. Heights are metres above the desk.
class ContactLog {
 public:
  /// `scene` must outlive the log. Throws Error if the camera's view cannot be read.
  ContactLog(const HeightMapOptions& options, const Scene& scene);

  /// Returns the reader of contacts in its current state.
  const ContactReader& reader() const { return reader_; }

  /// Adds a tap, and reads all contacts again if offsets are estimated. `noise`: standard deviation of a height that is
  /// measured with the most precise motion, metres.
  void add(const TapRequest& request, const TapResult& result, double noise);

  /// Returns whether the label of a contact has changed since the last call. The latest contact does not count.
  bool take_label_changes() { return std::exchange(changed_, false); }

  int taps() const { return taps_; }

  // The contacts, the contacts with objects, and the tap number of each contact, in the order of the taps.
  const std::vector<Touch>& contacts() const { return contacts_; }
  const std::vector<Touch>& object_contacts() const { return object_contacts_; }
  const std::vector<int>& tap_numbers() const { return tap_numbers_; }

  // The data: squares of the camera's view, and contacts.
  int size() const { return prior_size() + static_cast<int>(contacts_.size()); }
  int prior_size() const { return static_cast<int>(prior_.size()); }
  const std::vector<ViewedSquare>& prior() const { return prior_; }
  const Touch& datum(int row) const;
  /// Return the rows of all data on objects in ascending order, and the number of such rows from the camera's view.
  const std::vector<int>& object_rows() const { return object_rows_; }
  int prior_objects() const { return prior_objects_; }
  /// Returns the trust in the height of each datum, in (0, 1]. The trust is `noise`^2 divided by the noise variance of
  /// the datum. For a contact, it is also multiplied by 1 - `outlier_probability` (one value per contact). Both factors
  /// of a contact are rounded to tenths, and the product is at least 0.001.
  Eigen::VectorXd trust(const Eigen::VectorXd& outlier_probability, double noise) const;
  /// Returns whether the data differ in their noise.
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
  // One value per contact.
  std::vector<int> tap_numbers_;
  /// Variance of heights that the most precise motion measures, divided by the variance for the contact's own motion.
  std::vector<double> shares_;
};

}  // namespace palpate
