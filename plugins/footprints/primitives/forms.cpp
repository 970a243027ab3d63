// SPDX-License-Identifier: MIT
#include "forms.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "primitives/forms.cpp"
#include "math/highway.hpp"

// Compiled for each set of instructions, as a compiler makes vectors of it. Products are not fused with sums: what is
// computed is the same to the last bit.
HWY_BEFORE_NAMESPACE();
namespace palpate::footprints::HWY_NAMESPACE {
namespace {

/// How far a form reaches, as Form::reach.
HWY_INLINE float reach_of(float along, float across, float ellipse) {
  const float box = std::abs(along) + std::abs(across);
  const float round = std::sqrt(along * along + across * across);
  return ellipse > 0.0F ? round : box;
}

void mark(const Form& other, const float* __restrict xs, const float* __restrict ys, const float* __restrict as,
          const float* __restrict bs, const float* __restrict cosines, const float* __restrict sines,
          const float* __restrict ellipses, std::size_t count, std::uint8_t keeps, std::uint8_t* __restrict met) {
  const SingleForm one = single(other);
  const float ellipse = one.box ? 0.0F : 1.0F;
  for (std::size_t from = 0; from < count; from += Forms::kRound) {
    float within[Forms::kRound];
    for (std::size_t k = 0; k < Forms::kRound; ++k) {
      const std::size_t i = from + k;
      // See no_line_between(): what is left between the two on each line, at most.
      const float dx = xs[i] - one.x;
      const float dy = ys[i] - one.y;
      const float u = one.cosine * dx + one.sine * dy;
      const float v = one.cosine * dy - one.sine * dx;
      const float other_u = cosines[i] * dx + sines[i] * dy;
      const float other_v = cosines[i] * dy - sines[i] * dx;
      const float c = one.cosine * cosines[i] + one.sine * sines[i];
      const float s = one.cosine * sines[i] - one.sine * cosines[i];
      const float square = dx * dx + dy * dy;
      const float between =
          square - reach_of(one.a * u, one.b * v, ellipse) - reach_of(as[i] * other_u, bs[i] * other_v, ellipses[i]);
      const float along = std::abs(u) - one.a - reach_of(as[i] * c, bs[i] * s, ellipses[i]);
      const float across = std::abs(v) - one.b - reach_of(as[i] * s, bs[i] * c, ellipses[i]);
      const float other_along = std::abs(other_u) - as[i] - reach_of(one.a * c, one.b * s, ellipse);
      const float other_across = std::abs(other_v) - bs[i] - reach_of(one.a * s, one.b * c, ellipse);
      const float most = std::max(std::max(std::max(along, across), std::max(other_along, other_across)), between);
      const float inner = one.b + bs[i];
      within[k] = square <= inner * inner ? -1.0F : most;
    }
    for (std::size_t k = 0; k < Forms::kRound; ++k)
      met[from + k] = static_cast<std::uint8_t>((met[from + k] & keeps) | (within[k] <= 0.0F ? 1 : 0));
  }
}

void add_up(const std::uint8_t* __restrict more, std::size_t count, std::uint8_t* __restrict sums) {
  for (std::size_t from = 0; from < count; from += Forms::kRound) {
    for (std::size_t k = 0; k < Forms::kRound; ++k)
      sums[from + k] = static_cast<std::uint8_t>(sums[from + k] + more[from + k]);
  }
}

}  // namespace
}  // namespace palpate::footprints::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::footprints {

void Forms::clear() {
  count_ = 0;
  for (auto* numbers : {&x_, &y_, &a_, &b_, &cosine_, &sine_, &ellipse_}) numbers->clear();
}

void Forms::add(const Form& form) {
  if (count_ == x_.size()) {
    for (auto* numbers : {&x_, &y_, &a_, &b_, &cosine_, &sine_, &ellipse_}) numbers->resize(count_ + kRound, 0.0F);
  }
  const SingleForm one = single(form);
  x_[count_] = one.x;
  y_[count_] = one.y;
  a_[count_] = one.a;
  b_[count_] = one.b;
  cosine_[count_] = one.cosine;
  sine_[count_] = one.sine;
  ellipse_[count_++] = one.box ? 0.0F : 1.0F;
}

void Forms::mark_met(const Form& other, bool too, std::vector<std::uint8_t>& met) const {
  met.resize(x_.size(), 0);
  PALPATE_DISPATCH(mark)
  (other, x_.data(), y_.data(), a_.data(), b_.data(), cosine_.data(), sine_.data(), ellipse_.data(), x_.size(),
   too ? 1 : 0, met.data());
}

void Forms::count_met(const std::vector<std::uint8_t>& met, std::vector<std::uint8_t>& times) {
  times.resize(met.size(), 0);
  PALPATE_DISPATCH(add_up)(met.data(), met.size(), times.data());
}

}  // namespace palpate::footprints
#endif
