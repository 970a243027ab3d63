// SPDX-License-Identifier: MIT
#include "belief/metrics.hpp"

#include <palpate/math.hpp>

#include <cmath>
#include <cstdint>

namespace palpate {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;
/// 97.5 % quantile of the standard normal distribution.
constexpr double kNormal975 = 1.95996398454005423552;

/// Sums of squared errors of a map, over all cells and over the cells on an object, from one pass.
struct SquaredErrors {
  struct Sum {
    double squares = 0.0;
    Eigen::Index cells = 0;

    void add(double square) {
      squares += square;
      ++cells;
    }
    std::optional<double> rms() const {
      return cells == 0 ? std::nullopt : std::optional(std::sqrt(squares / static_cast<double>(cells)));
    }
  };

  SquaredErrors(const Eigen::VectorXd& map, const Truth& truth) {
    for (Eigen::Index i = 0; i < map.size(); ++i) {
      const double error = map(i) - truth.height(i);
      all.add(error * error);
      if (truth.on(i)) on_object.add(error * error);
    }
  }

  Sum all, on_object;
};

}  // namespace

Truth truth_at(const CandidateGrid& candidates, const Scene& scene) {
  Truth truth{Eigen::VectorXd(candidates.size()), Eigen::Array<bool, Eigen::Dynamic, 1>(candidates.size()),
              Eigen::ArrayXi(candidates.size()), scene.objects()};
  for (int i = 0; i < candidates.size(); ++i) {
    const Target at = candidates.target(i);
    truth.height(i) = scene.height(at.x, at.y);
    truth.on(i) = scene.on_object(truth.height(i));
    truth.object(i) = truth.on(i) ? scene.object(at.x, at.y) : Scene::kNoObject;
  }
  return truth;
}

std::optional<double> rmse(const Eigen::VectorXd& map, const Truth& truth, bool only_on_object) {
  const SquaredErrors misses(map, truth);
  return only_on_object ? misses.on_object.rms() : misses.all.rms();
}

double footprint_iou(const Eigen::VectorXd& probability, const Truth& truth) {
  std::int64_t predicted = 0;
  std::int64_t on = 0;
  std::int64_t both = 0;
  for (Eigen::Index i = 0; i < probability.size(); ++i) {
    const int here = probability(i) >= 0.5 ? 1 : 0;
    predicted += here;
    if (!truth.on(i)) continue;
    ++on;
    both += here;
  }
  const std::int64_t either = predicted + on - both;
  return either == 0 ? 1.0 : static_cast<double>(both) / static_cast<double>(either);
}

Eigen::VectorXd reconstruction(const SurfaceMaps& maps) {
  if (!maps.two_part) return *maps.height;
  const Eigen::VectorXd desk = Eigen::VectorXd::Constant(maps.height->size(), maps.desk);
  return (maps.probability->array() >= 0.5).select(*maps.height, desk);
}

Errors errors_of(const SurfaceMaps& maps, const Truth& truth) {
  Errors out;
  if (maps.height != nullptr) {
    const SquaredErrors of_height(*maps.height, truth);
    out.rmse_height = of_height.on_object.rms();
    if (!maps.two_part) {  // the mean height is the reconstruction
      out.rmse = of_height.all.rms();
      out.rmse_object = out.rmse_height;
    } else if (maps.probability != nullptr) {
      const SquaredErrors of_surface(reconstruction(maps), truth);
      out.rmse = of_surface.all.rms();
      out.rmse_object = of_surface.on_object.rms();
    }
  }
  if (maps.probability != nullptr) out.footprint_iou = footprint_iou(*maps.probability, truth);
  return out;
}

Calibration calibration(const Eigen::VectorXd& mean, const Eigen::VectorXd& variance, double noise, const Truth& truth,
                        const std::vector<bool>& tapped) {
  double log_density = 0.0;
  int inside = 0;
  int cells = 0;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    const double spread = variance(i) + noise * noise;
    if (!truth.on(i) || tapped[static_cast<std::size_t>(i)]) continue;
    const double error = truth.height(i) - mean(i);
    log_density += -0.5 * (kLogTwoPi + math::log(spread) + error * error / spread);  // not finite if spread is 0
    inside += std::abs(error) <= kNormal975 * std::sqrt(spread) ? 1 : 0;
    ++cells;
  }
  if (cells == 0) return {};
  const double coverage = static_cast<double>(inside) / cells;
  if (!std::isfinite(log_density)) return {std::nullopt, coverage};
  return {-log_density / cells, coverage};
}

}  // namespace palpate
