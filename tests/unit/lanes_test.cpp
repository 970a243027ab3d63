// SPDX-License-Identifier: MIT
// The loops of palpate/simd.hpp on every set that this processor has, compiled as a plugin is: against extended
// precision, and against themselves at other places.
#include "support/testing.hpp"

#include <palpate/simd.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace palpate::simd {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Lanes> sets() {
  std::vector<Lanes> out;
  for (const Lanes one : {Lanes::sse2, Lanes::avx2, Lanes::avx512}) {
    if (one <= widest()) out.push_back(one);
  }
  return out;
}

class EveryLanes : public testing::TestWithParam<Lanes> {
 protected:
  static std::vector<double> exp_of(const std::vector<double>& in) {
    std::vector<double> out(in.size());
    for_each(GetParam(), static_cast<std::ptrdiff_t>(in.size()),
             [from = in.data(), to = out.data()](std::ptrdiff_t i) { to[i] = exp(from[i]); });
    return out;
  }
};

TEST_P(EveryLanes, TakeAnExponentialWithinOneUlp) {
  std::vector<double> in;
  for (int i = -1415999; i <= 1418000; i += 7) in.push_back(i / 2000.0 + 1e-9 * (i % 11));
  for (const double tiny : {0.0, -0.0, 5e-324, -5e-324, 1e-300, -1e-17, 1e-16}) in.push_back(tiny);
  const std::vector<double> out = exp_of(in);
  long double worst = 0.0L;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const long double truth = std::exp(static_cast<long double>(in[i]));
    const auto ulp = static_cast<long double>(std::nextafter(static_cast<double>(truth), kInfinity)) -
                     static_cast<long double>(static_cast<double>(truth));
    worst = std::max(worst, std::abs(out[i] - truth) / ulp);
  }
  RecordProperty("ulp", std::to_string(static_cast<double>(worst)));
  EXPECT_LT(worst, 1.0L);
}

TEST_P(EveryLanes, TakeExponentialsBeyondEveryBound) {
  const double least = std::exp(-708.0);
  const std::vector<double> out =
      exp_of({-kInfinity, -1e300, -1e6, -709.0, 709.8, 800.0, 1e6, 1e300, kInfinity, std::nan("")});
  for (const int i : {0, 1, 2, 3}) EXPECT_DOUBLE_EQ(out[static_cast<std::size_t>(i)], least) << i;
  for (const int i : {4, 5, 6, 7, 8}) EXPECT_EQ(out[static_cast<std::size_t>(i)], kInfinity) << i;
  EXPECT_TRUE(std::isnan(out[9]));
}

TEST_P(EveryLanes, FallByTheSameNumberAsTheExponential) {
  std::vector<double> in{0.0,   5e-324, 1e-17, 707.999,  708.0, std::nextafter(708.0, 709.0),
                         709.0, 1e6,    1e300, kInfinity};
  for (int i = 0; i < 100000; ++i) in.push_back(0.00713 * i);
  std::vector<double> negative(in.size());
  for (std::size_t i = 0; i < in.size(); ++i) negative[i] = -in[i];
  std::vector<double> out(in.size());
  for_each(GetParam(), static_cast<std::ptrdiff_t>(in.size()),
           [from = in.data(), to = out.data()](std::ptrdiff_t i) { to[i] = decay(from[i]); });
  EXPECT_EQ(out, exp_of(negative));
  const double nan = std::nan("");
  double fallen = 0.0;
  for_each(GetParam(), 1, [nan, to = &fallen](std::ptrdiff_t) { *to = decay(nan); });
  EXPECT_TRUE(std::isnan(fallen));
}

TEST_P(EveryLanes, ChooseTheSmallerTheLargerAndTheOther) {
  const double nan = std::nan("");
  const std::vector<double> a{1.0, -1.0, 0.0, kInfinity, -kInfinity, nan, 2.0, 5e-324, 1.0};
  const std::vector<double> b{2.0, -2.0, 0.0, 1.0, 1.0, 3.0, nan, 0.0, 1.0};
  std::vector<double> less(a.size());
  std::vector<double> more(a.size());
  for_each(GetParam(), static_cast<std::ptrdiff_t>(a.size()),
           [first = a.data(), second = b.data(), low = less.data(), high = more.data()](std::ptrdiff_t i) {
             low[i] = min(first[i], second[i]);
             high[i] = max(first[i], second[i]);
           });
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    EXPECT_TRUE(same(less[i], a[i] < b[i] ? a[i] : b[i])) << i << ": " << less[i];
    EXPECT_TRUE(same(more[i], a[i] > b[i] ? a[i] : b[i])) << i << ": " << more[i];
  }
}

TEST_P(EveryLanes, GiveANumberTheSameBytesAtEveryPlaceOfALoop) {
  const auto of = [](double x) { return exp(-0.5 * x * x) * (1.0 + x + x * x / 3.0) / std::sqrt(x + 2.0); };
  std::vector<double> in(43);
  for (std::size_t i = 0; i < in.size(); ++i) in[i] = 0.37 * static_cast<double>(i);
  std::vector<double> whole(in.size());
  for_each(GetParam(), 43, [=, from = in.data(), to = whole.data()](std::ptrdiff_t i) { to[i] = of(from[i]); });
  for (std::ptrdiff_t first = 0; first < 43; ++first) {
    for (const std::ptrdiff_t count : {1, 3, 8, 17}) {
      if (first + count > 43) continue;
      std::vector<double> part(static_cast<std::size_t>(count));
      for_each(GetParam(), count,
               [=, from = in.data() + first, to = part.data()](std::ptrdiff_t i) { to[i] = of(from[i]); });
      for (std::ptrdiff_t i = 0; i < count; ++i) {
        EXPECT_EQ(part[static_cast<std::size_t>(i)], whole[static_cast<std::size_t>(first + i)]) << first << " " << i;
      }
    }
  }
}

TEST_P(EveryLanes, VisitEveryPairOnce) {
  for (const std::ptrdiff_t n : {0, 1, 5, 8, 19}) {
    for (const std::ptrdiff_t m : {0, 1, 4}) {
      std::vector<double> visits(static_cast<std::size_t>(n * m));
      for_each(GetParam(), n, m, [n, to = visits.data()](std::ptrdiff_t i, std::ptrdiff_t j) { to[n * j + i] += 1.0; });
      EXPECT_EQ(visits, std::vector<double>(visits.size(), 1.0));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, EveryLanes, testing::ValuesIn(sets()), [](const auto& one) {
  return one.param == Lanes::sse2 ? "Sse2" : one.param == Lanes::avx2 ? "Avx2" : "Avx512";
});

}  // namespace
}  // namespace palpate::simd
