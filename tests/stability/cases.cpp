// SPDX-License-Identifier: MIT
#include "stability/cases.hpp"

#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate::stability {
namespace {

constexpr double kUsualNoise = 1e-8;

class Matrix {
 public:
  std::vector<Case> rows;

  /// Starts a case with this variance of its noise and a name that says what makes it extreme.
  template <class... Args>
  Case& add(double noise_variance, fmt::format_string<Args...> name, Args&&... args) {
    rows.emplace_back();
    rows.back().name = fmt::format(name, std::forward<Args>(args)...);
    std::replace(rows.back().name.begin(), rows.back().name.end(), ' ', '_');
    rows.back().noise_variance = noise_variance;
    return rows.back();
  }
};

void add_length_scales(Matrix& matrix) {
  for (const char* kernel : {"rbf", "matern52"}) {
    for (const double length : {1e-6, 1e-4, 1e-2, 0.07, 0.3, 1.0, 10.0, 1e3, 1e6}) {
      for (const double noise : {0.0, 1e-16, 1e-8, 1e-4, 1.0}) {
        Case& one = matrix.add(noise, "{} length {} noise {}", kernel, length, noise);
        one.kernel = kernel;
        one.length = length;
      }
    }
    for (const double length : {0.07, 1.0, 1e3}) {
      for (const double noise : {0.0, 1e-8}) {
        Case& one = matrix.add(noise, "{} rough data length {} noise {}", kernel, length, noise);
        one.kernel = kernel;
        one.length = length;
        one.data = Data::rough;
      }
    }
  }
}

void add_units(Matrix& matrix) {
  for (const double signal : {1e-12, 1e-6, 1e6, 1e12}) {
    for (const double noise : {0.0, 1e-16, 1e-4, 1.0}) {
      matrix.add(noise, "signal {} noise {}", signal, noise).signal = signal;
    }
  }
  for (const double height : {1e-9, 1e-6, 1e-3, 1e3, 1e6}) {
    for (const double noise : {0.0, 1e-8}) {
      matrix.add(noise, "heights {} noise {}", height, noise).height = height;
    }
  }
  for (const auto& [signal, height] : {std::pair(1e-12, 1e6), std::pair(1e12, 1e-9), std::pair(1e12, 1e6)}) {
    Case& one = matrix.add(1e-8 * signal * signal, "signal {} heights {}", signal, height);
    one.signal = signal;
    one.height = height;
  }
}

void add_layouts(Matrix& matrix) {
  const std::vector<std::pair<const char*, Layout>> layouts{{"duplicates", Layout::duplicates},
                                                            {"one place", Layout::one_place},
                                                            {"pairs", Layout::pairs},
                                                            {"collinear", Layout::collinear},
                                                            {"grid", Layout::grid}};
  for (const auto& [name, layout] : layouts) {
    for (const double noise : {0.0, 1e-16, 1e-12, 1e-8, 1e-4}) {
      for (const auto& [text, data] : {std::pair("", Data::smooth), std::pair(" rough data", Data::rough)}) {
        Case& one = matrix.add(noise, "{}{} noise {}", name, text, noise);
        one.layout = layout;
        one.data = data;
      }
    }
    Case& rough = matrix.add(0.0, "{} matern52", name);
    rough.layout = layout;
    rough.kernel = "matern52";
    Case& moved = matrix.add(0.0, "{} offset 1e6 m", name);
    moved.layout = layout;
    moved.offset = 1e6;
    moved.gap = 1.2e-10;  // the next number after 1e6
  }
  for (const double gap : {1e-9, 1e-7, 1e-5, 1e-3}) {
    Case& one = matrix.add(0.0, "pairs {} m apart", gap);
    one.layout = Layout::pairs;
    one.gap = gap;
  }
  for (const double length : {0.07, 1.0, 1e6}) {
    Case& one = matrix.add(kUsualNoise, "offset 1e6 m length {}", length);
    one.offset = 1e6;
    one.length = length;
  }
}

void add_data(Matrix& matrix) {
  for (const auto& [name, data] :
       {std::pair("constant", Data::constant), std::pair("zero", Data::zero), std::pair("labels", Data::labels)}) {
    for (const double noise : {0.0, 1e-8}) {
      Case& one = matrix.add(noise, "{} data noise {}", name, noise);
      one.data = data;
      one.mean = data == Data::labels ? 0.5 : 0.0;
    }
  }
  Case& equal = matrix.add(kUsualNoise, "all labels equal to the prior mean");
  equal.data = Data::constant;
  equal.mean = 1.0;
}

void add_unknown_mean(Matrix& matrix) {
  for (const double ratio : {1e-3, 10.0, 1e4}) {
    for (const double length : {0.01, 0.1, 10.0}) {
      Case& one = matrix.add(kUsualNoise, "unknown mean {} length {}", ratio, length);
      one.mean_ratio = ratio;
      one.length = length;
    }
  }
  Case& one = matrix.add(0.0, "unknown mean duplicates noise 0");
  one.mean_ratio = 10.0;
  one.layout = Layout::duplicates;
}

void add_refits(Matrix& matrix) {
  for (const double length : {0.01, 0.1, 1.0, 1e3}) {
    Case& one = matrix.add(kUsualNoise, "after a fit length {}", length);
    one.refit = true;
    one.length = length;
  }
  Case& one = matrix.add(0.0, "after a fit duplicates noise 0");
  one.refit = true;
  one.layout = Layout::duplicates;
}

void add_sizes(Matrix& matrix) {
  for (const int points : {1, 2, 3, 5, 10, 17, 100, 200}) {
    for (const double noise : {0.0, 1e-8}) {
      matrix.add(noise, "{} points noise {}", points, noise).points = points;
    }
  }
  for (const int points : {1, 2, 3, 17}) {
    Case& one = matrix.add(kUsualNoise, "{} points length 1e6", points);
    one.points = points;
    one.length = 1e6;
  }
  for (const int points : {500, 1000, 2000}) {
    matrix.add(1e-4, "{} points noise 0.0001", points).points = points;
    Case& jittered = matrix.add(0.0, "{} points duplicates noise 0", points);
    jittered.points = points;
    jittered.layout = Layout::duplicates;
  }
  Case& alike = matrix.add(0.0, "1000 points length 1 noise 0");
  alike.points = 1000;
  alike.length = 1.0;
}

void spread(Points& out, Random& random) {
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    out(i, 0) = kSide * random.uniform();
    out(i, 1) = kSide * random.uniform();
  }
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    Matrix matrix;
    add_length_scales(matrix);
    add_units(matrix);
    add_layouts(matrix);
    add_data(matrix);
    add_unknown_mean(matrix);
    add_refits(matrix);
    add_sizes(matrix);
    return matrix.rows;
  }();
  return all;
}

Points places(const Case& one) {
  Random random(7, "stability");
  Points out(one.points, 2);
  const Eigen::Index half = one.points / 2;
  switch (one.layout) {
    case Layout::scattered:
      spread(out, random);
      break;
    case Layout::one_place:
      out.setConstant(0.3 * kSide);
      break;
    case Layout::duplicates:
      spread(out, random);
      out.bottomRows(half) = out.topRows(half).eval();
      break;
    case Layout::pairs:
      spread(out, random);
      for (Eigen::Index i = 0; i + 1 < out.rows(); i += 2) out.row(i + 1) = out.row(i).array() + one.gap;
      break;
    case Layout::collinear:
      for (Eigen::Index i = 0; i < out.rows(); ++i) {
        const double along = kSide * random.uniform();
        out.row(i) << 0.6 * along, 0.8 * along;
      }
      break;
    case Layout::grid: {
      const auto columns = static_cast<Eigen::Index>(std::ceil(std::sqrt(one.points)));
      for (Eigen::Index i = 0; i < out.rows(); ++i) {
        const Eigen::Index row = i / columns;
        const Eigen::Index column = i - row * columns;
        out(i, 0) = kSide * (static_cast<double>(column) + 0.5) / static_cast<double>(columns);
        out(i, 1) = kSide * (static_cast<double>(row) + 0.5) / static_cast<double>(columns);
      }
      break;
    }
  }
  out.array() += one.offset;
  return out;
}

Eigen::VectorXd values(const Case& one, const Points& places) {
  Random random(8, "stability");
  Eigen::VectorXd out(places.rows());
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const double x = (places(i, 0) - one.offset) / kSide;
    const double y = (places(i, 1) - one.offset) / kSide;
    switch (one.data) {
      case Data::smooth:
        out(i) = std::sin(3.0 * x) * std::cos(2.0 * y);
        break;
      case Data::rough:
        out(i) = 2.0 * random.uniform() - 1.0;
        break;
      case Data::constant:
        out(i) = 1.0;
        break;
      case Data::zero:
        out(i) = 0.0;
        break;
      case Data::labels:
        out(i) = x > 0.5 ? 1.0 : 0.0;
        break;
    }
  }
  return one.height * out;
}

Points probes(const Case& one, const Points& places) {
  constexpr int kGrid = 4;
  Points out(kGrid * kGrid + 9, 2);
  Eigen::Index row = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) out.row(row++) << one.offset + kSide * i / 3.0, one.offset + kSide * j / 3.0;
  }
  const Eigen::Index last = places.rows() - 1;
  for (const Eigen::Index tap : {Eigen::Index{0}, last / 2, last}) {
    out.row(row++) = places.row(tap);
    out.row(row++) = places.row(tap).array() + 1e-3 * one.length_scale();
  }
  for (const double away : {2.0, 10.0, 1e6}) out.row(row++).setConstant(one.offset + away * kSide);
  return out;
}

}  // namespace palpate::stability
