// SPDX-License-Identifier: MIT
#include "program/maps.hpp"

#include "programs/command.hpp"
#include "reading/npy.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate::program {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr char kMagic[] = "\x93NUMPY\x01\x00";
constexpr std::size_t kMagicLength = 8;

/// Returns an NPY file with this shape ("2209,") and `bytes` of data.
std::string npy(const char* type, const std::string& shape, const void* data, std::size_t bytes) {
  constexpr std::size_t kAlign = 64;
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, shape);
  header.append(kAlign - 1 - (kNpyStart + header.size()) % kAlign, ' ').append("\n");
  std::string out(kMagic, kMagicLength);
  out += static_cast<char>(header.size() & 0xffU);
  out += static_cast<char>(header.size() >> 8U);
  return out.append(header).append(static_cast<const char*>(data), bytes);
}

std::string npy(const Eigen::VectorXd& values) {
  return npy("<f8", fmt::format("{},", values.size()), values.data(),
             static_cast<std::size_t>(values.size()) * sizeof(double));
}

std::string npy(const RowMajor& rows) {
  return npy("<f8", fmt::format("{}, {}", rows.rows(), rows.cols()), rows.data(),
             static_cast<std::size_t>(rows.size()) * sizeof(double));
}

/// Returns one row per outline and one truth value per candidate.
std::string hypotheses(const Belief& belief) {
  const OutlineSample& sample = belief.outlines();
  const Eigen::Index places = belief.candidates().rows();
  constexpr Eigen::Index kBits = 64;
  std::string out(static_cast<std::size_t>(sample.count * places), '\0');
  for (Eigen::Index k = 0; k < sample.count; ++k) {
    for (Eigen::Index i = 0; i < places; ++i) {
      const bool holds = (sample.holds(k / kBits, i) >> static_cast<unsigned>(k % kBits) & 1U) != 0;
      out[static_cast<std::size_t>(k * places + i)] = holds ? '\1' : '\0';
    }
  }
  return npy("|b1", fmt::format("{}, {}", sample.count, places), out.data(), out.size());
}

/// Returns one row per contact: x, y, height, and 1 on an object or 0 on the desk.
std::string contacts(const Belief& belief) {
  const std::vector<Touch>& touches = belief.touches();
  RowMajor out(static_cast<Eigen::Index>(touches.size()), 4);
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const Touch& one = touches[static_cast<std::size_t>(i)];
    out.row(i) << one.place.x, one.place.y, one.height, one.on ? 1.0 : 0.0;
  }
  return npy(out);
}

template <class Part>
std::string lines(const SurfaceBelief& belief, const Part& part) {
  RowMajor out(static_cast<Eigen::Index>(belief.approaches().size()), 3);
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    out.row(i) = part(belief.approaches()[static_cast<std::size_t>(i)].line).transpose();
  return npy(out);
}

/// Returns the score of the acquisition `uncertainty`: variance relative to the largest, along normals.
std::string relative_variance(const SurfaceBelief& belief) {
  constexpr double kAlong = 0.999;
  const double most = belief.deviation().maxCoeff();
  const double scale = most > 0.0 ? 1.0 / most : 0.0;
  const Eigen::ArrayXd share = (scale * belief.deviation().array()).square();
  return npy(Eigen::VectorXd((belief.incidence_cosine().array() > kAlong).select(share, 0.0)));
}

}  // namespace

const std::vector<Map>& maps() {
  using B = const Belief&;
  using S = const SurfaceBelief&;
  static const std::vector<Map> all{
      {"uncertainty", Quantity::uncertainty, [](B b) { return npy(b.uncertainty()); }, Quantity::deviation,
       relative_variance},
      {"label_mean", Quantity::weight, [](B b) { return npy(b.weight()); }, {}, nullptr},
      {"object_probability", Quantity::probability, [](B b) { return npy(b.probability()); }, {}, nullptr},
      {"height_mean", Quantity::height, [](B b) { return npy(b.height_mean()); }, {}, nullptr},
      {"height_std",
       Quantity::height,
       [](B b) { return npy(Eigen::VectorXd(b.height_variance().cwiseMax(0.0).cwiseSqrt())); },
       {},
       nullptr},
      {"hypotheses", Quantity::outlines, hypotheses, {}, nullptr},
      {"expected_discovery_area",
       Quantity::outlines,
       [](B b) {
         const OutlineSample& sample = b.outlines();
         return npy(sample.count > 0 ? sample.to_find : Eigen::VectorXd::Zero(b.candidates().rows()));
       },
       {},
       nullptr},
      {"desk_position", {}, [](B b) { return npy(RowMajor(b.candidates())); }, {}, nullptr},
      {"contacts", {}, contacts, {}, nullptr},
      {"surface_std", {}, nullptr, Quantity::deviation, [](S s) { return npy(s.deviation()); }},
      {"incidence_cosine", {}, nullptr, Quantity::deviation, [](S s) { return npy(s.incidence_cosine()); }},
      {"expected_discovery",
       {},
       nullptr,
       Quantity::expected_discovery,
       [](S s) { return npy(s.expected_discovery()); }},
      {"std_reduction", {}, nullptr, Quantity::std_reduction, [](S s) { return npy(s.std_reduction()); }},
      {"expected_distance", {}, nullptr, {}, [](S s) { return npy(s.way()); }},
      {"start", {}, nullptr, {}, [](S s) { return lines(s, [](const Line& one) { return one.origin; }); }},
      {"direction", {}, nullptr, {}, [](S s) { return lines(s, [](const Line& one) { return one.direction; }); }}};
  return all;
}

const Map* find_map(const std::string& name) {
  const auto at = std::find_if(maps().begin(), maps().end(), [&](const Map& one) { return name == one.name; });
  return at != maps().end() ? &*at : nullptr;
}

std::size_t header_length(const std::string& start) {
  const std::optional<NpyPlace> place = npy_header_place(start);
  if (!place || place->begin != kNpyStart) throw std::runtime_error("data that is not an array in the format NPY 1.0");
  return place->length;
}

void check_header(const std::string& text, Eigen::Index count) {
  const NpyHeader header = read_npy_header(text);
  if (header.type != "<f8") {
    throw std::runtime_error(
        fmt::format("numbers of the type {}, not '<f8', which is float64", programs::shown(header.type)));
  }
  if (header.shape != fmt::format("({},)", count))
    throw std::runtime_error(fmt::format("an array of the shape {}, not ({},)", programs::shown(header.shape), count));
}

}  // namespace palpate::program
