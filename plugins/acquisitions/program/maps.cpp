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

/// Returns an NPY file with the shape `shape`, such as "2209,", and `bytes` bytes of data.
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

/// Returns one row per outline, with one truth value per candidate.
std::string hypotheses(const BeliefView& belief) {
  const HypothesisSample& sample = belief.hypotheses();
  const Eigen::Index places = belief.candidates().size();
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

/// Returns one row per contact, with x, y, height, and a label: 1 on an object, 0 on the desk.
std::string contacts(const BeliefView& belief, double desk) {
  std::vector<TapReading> all;
  for (const TapReading& one : belief.taps().readings) {
    if (one.is_contact) all.push_back(one);
  }
  RowMajor out(static_cast<Eigen::Index>(all.size()), 4);
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const TapReading& one = all[static_cast<std::size_t>(i)];
    out.row(i) << one.position.x(), one.position.y(), one.position.z() - desk, one.on_object ? 1.0 : 0.0;
  }
  return npy(out);
}

template <const char* const& kName>
std::string values(const BeliefView& belief, double) {
  return npy(belief.values(kName));
}

std::string discovery_area(const BeliefView& belief, double) {
  const HypothesisSample& sample = belief.hypotheses();
  return npy(sample.count > 0 ? sample.expected_discovery_area : Eigen::VectorXd::Zero(belief.candidates().size()));
}

/// Returns the array of a quantity that has one value per candidate.
template <const char* const& kName>
ProgramMap map_of() {
  return {kName, {kName}, values<kName>};
}

}  // namespace

const std::vector<ProgramMap>& maps() {
  using B = const BeliefView&;
  static const std::vector<ProgramMap> all{
      map_of<quantity::kUncertainty>(),
      map_of<quantity::kLabelMean>(),
      map_of<quantity::kObjectProbability>(),
      map_of<quantity::kHeightMean>(),
      map_of<quantity::kHeightStd>(),
      map_of<quantity::kMeasurementStd>(),
      {quantity::kHypotheses, {quantity::kHypotheses}, [](B b, double) { return hypotheses(b); }},
      {"expected_discovery_area", {quantity::kHypotheses}, discovery_area},
      {quantity::kDeskPosition,
       {quantity::kDeskPosition},
       [](B b, double) { return npy(RowMajor(b.candidates().starts.leftCols<2>())); }},
      {"contacts", {}, contacts},
      map_of<quantity::kSurfaceStd>(),
      map_of<quantity::kIncidenceCosine>(),
      map_of<quantity::kExpectedDiscovery>(),
      map_of<quantity::kStdReduction>(),
      map_of<quantity::kExpectedDistance>(),
      {"start", {}, [](B b, double) { return npy(RowMajor(b.candidates().starts)); }},
      {"direction", {}, [](B b, double) {
         const Candidates& lines = b.candidates();
         return npy(RowMajor(lines.directions.rows() == 1 ? Points3(lines.directions.replicate(lines.size(), 1))
                                                          : lines.directions));
       }}};
  return all;
}

const ProgramMap* find_map(const std::string& name) {
  const auto at = std::find_if(maps().begin(), maps().end(), [&](const ProgramMap& one) { return name == one.name; });
  return at != maps().end() ? &*at : nullptr;
}

std::size_t header_length(const std::string& start) {
  const std::optional<NpyHeaderSpan> place = npy_header_place(start);
  if (!place || place->begin != kNpyStart) throw std::runtime_error("data that is not an array in the format NPY 1.0");
  return place->length;
}

void check_header(const std::string& text, Eigen::Index count) {
  const NpyHeader header = read_npy_header(text);
  if (header.type != "<f8")
    throw std::runtime_error(
        fmt::format("numbers of the type {}, not '<f8', which is float64", programs::shown(header.type)));
  if (header.shape != fmt::format("({},)", count))
    throw std::runtime_error(fmt::format("an array of the shape {}, not ({},)", programs::shown(header.shape), count));
}

}  // namespace palpate::program
