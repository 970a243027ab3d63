// SPDX-License-Identifier: MIT
#include "forms.hpp"

#include "clones.hpp"

namespace palpate::footprints {
namespace {

/// How far a form reaches, as Form::reach.
PALPATE_INLINE double reach_of(double along, double across, double ellipse) {
  const double box = std::abs(along) + std::abs(across);
  const double round = std::sqrt(along * along + across * across);
  return ellipse > 0.0 ? round : box;
}

PALPATE_CLONES void mark(const Form& other, const double* __restrict xs, const double* __restrict ys,
                         const double* __restrict as, const double* __restrict bs, const double* __restrict cosines,
                         const double* __restrict sines, const double* __restrict ellipses, std::size_t count,
                         std::uint8_t* __restrict met) {
  const Form one = other;
  const double ellipse = one.family == Form::Family::ellipse ? 1.0 : 0.0;
  for (std::size_t from = 0; from < count; from += Forms::kRound) {
    double within[Forms::kRound];
    for (std::size_t k = 0; k < Forms::kRound; ++k) {
      const std::size_t i = from + k;
      // See no_line_between(): what is left between the two on each line, at most.
      const double dx = xs[i] - one.x;
      const double dy = ys[i] - one.y;
      const double u = one.cosine * dx + one.sine * dy;
      const double v = one.cosine * dy - one.sine * dx;
      const double other_u = cosines[i] * dx + sines[i] * dy;
      const double other_v = cosines[i] * dy - sines[i] * dx;
      const double c = one.cosine * cosines[i] + one.sine * sines[i];
      const double s = one.cosine * sines[i] - one.sine * cosines[i];
      const double square = dx * dx + dy * dy;
      const double between =
          square - reach_of(one.a * u, one.b * v, ellipse) - reach_of(as[i] * other_u, bs[i] * other_v, ellipses[i]);
      const double along = std::abs(u) - one.a - reach_of(as[i] * c, bs[i] * s, ellipses[i]);
      const double across = std::abs(v) - one.b - reach_of(as[i] * s, bs[i] * c, ellipses[i]);
      const double other_along = std::abs(other_u) - as[i] - reach_of(one.a * c, one.b * s, ellipse);
      const double other_across = std::abs(other_v) - bs[i] - reach_of(one.a * s, one.b * c, ellipse);
      const double most = std::max(std::max(std::max(along, across), std::max(other_along, other_across)), between);
      const double inner = one.b + bs[i];
      within[k] = square <= inner * inner ? -1.0 : most;
    }
    for (std::size_t k = 0; k < Forms::kRound; ++k)
      met[from + k] = static_cast<std::uint8_t>(met[from + k] | (within[k] <= 0.0 ? 1 : 0));
  }
}

PALPATE_CLONES void add_up(const std::uint8_t* __restrict more, std::size_t count, std::uint8_t* __restrict sums) {
  for (std::size_t from = 0; from < count; from += Forms::kRound) {
    for (std::size_t k = 0; k < Forms::kRound; ++k)
      sums[from + k] = static_cast<std::uint8_t>(sums[from + k] + more[from + k]);
  }
}

}  // namespace

void Forms::clear() {
  count_ = 0;
  for (auto* numbers : {&x_, &y_, &a_, &b_, &cosine_, &sine_, &ellipse_}) numbers->clear();
}

void Forms::add(const Form& form) {
  if (count_ == x_.size()) {
    for (auto* numbers : {&x_, &y_, &a_, &b_, &cosine_, &sine_, &ellipse_}) numbers->resize(count_ + kRound, 0.0);
  }
  x_[count_] = form.x;
  y_[count_] = form.y;
  a_[count_] = form.a;
  b_[count_] = form.b;
  cosine_[count_] = form.cosine;
  sine_[count_] = form.sine;
  ellipse_[count_++] = form.family == Form::Family::ellipse ? 1.0 : 0.0;
}

void Forms::mark_met(const Form& other, std::vector<std::uint8_t>& met) const {
  met.resize(x_.size(), 0);
  mark(other, x_.data(), y_.data(), a_.data(), b_.data(), cosine_.data(), sine_.data(), ellipse_.data(), x_.size(),
       met.data());
}

void Forms::count_met(const std::vector<std::uint8_t>& met, std::vector<std::uint8_t>& times) {
  times.resize(met.size(), 0);
  add_up(met.data(), met.size(), times.data());
}

}  // namespace palpate::footprints
