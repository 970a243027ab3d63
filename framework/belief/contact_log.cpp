// SPDX-License-Identifier: MIT
#include "belief/contact_log.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Trust is rounded to steps, because each change of the trust rebuilds a GP.
constexpr double kTrustSteps = 10.0;
constexpr double kLeastTrust = 1e-3;

}  // namespace

ContactLog::ContactLog(const HeightMapOptions& options, const Scene& scene)
    : reader_(options.height.offset, scene), prior_(viewed_squares(options.prior, scene)), uneven_(!prior_.empty()) {
  find_objects();
  prior_objects_ = static_cast<int>(object_rows_.size());
}

void ContactLog::find_objects() {
  object_rows_.clear();
  object_contacts_.clear();
  for (int row = 0; row < size(); ++row) {
    if (!datum(row).on) continue;
    object_rows_.push_back(row);
    if (row >= prior_size()) object_contacts_.push_back(datum(row));
  }
}

const Touch& ContactLog::datum(int row) const {
  return row < prior_size() ? prior_[static_cast<std::size_t>(row)].touch
                            : contacts_[static_cast<std::size_t>(row - prior_size())];
}

void ContactLog::add(const TapRequest& request, const TapResult& result, double noise) {
  ++taps_;
  changed_ = reader_.add(request, result, contacts_) || changed_;
  if (!result.is_contact()) return;
  tap_numbers_.push_back(taps());
  const double more = request.height_noise;
  const double share = more > 0.0 ? noise * noise / (noise * noise + more * more) : 1.0;
  shares_.push_back(std::round(share * kTrustSteps) / kTrustSteps);
  uneven_ = uneven_ || shares_.back() < 1.0;
  find_objects();
}

Eigen::VectorXd ContactLog::trust(const Eigen::VectorXd& outlier_probability, double noise) const {
  const double variance = noise * noise;
  Eigen::VectorXd out(size());
  for (int i = 0; i < prior_size(); ++i) {
    const double deviation = prior_[static_cast<std::size_t>(i)].deviation;
    const double more = deviation * deviation;
    out(i) = more > 0.0 ? std::max(1e-12, variance / (variance + more)) : 1.0;
  }
  const Eigen::Map<const Eigen::ArrayXd> shares(shares_.data(), static_cast<Eigen::Index>(shares_.size()));
  const auto trusted = 1.0 - (outlier_probability.array() * kTrustSteps).round() / kTrustSteps;
  out.tail(shares.size()) = (shares * trusted).max(kLeastTrust);
  return out;
}

}  // namespace palpate
