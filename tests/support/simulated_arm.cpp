// SPDX-License-Identifier: MIT
// A program for version 2 of the protocol of the backend `process`: the simulator over the scene of a config makes the
// taps. Words: those of the config's overrides.
//   simulated_arm scene=any_mug seed=2
#include "support/runs.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <iostream>
#include <string>
#include <vector>

namespace palpate {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d vector_of(const Json& numbers) { return Eigen::Vector3d(numbers.get<std::array<double, 3>>().data()); }

TapLine line_of(const Json& line, bool from_above) {
  return {vector_of(line.at("start")), vector_of(line.at("direction")), line.at("length"), from_above};
}

Json answer_tap(const Json& ask, Backend& arm) {
  TapRequest request;
  request.number = ask.at("tap");
  request.line = line_of(ask.at("line"), ask.contains("x"));
  if (!ask.at("previous").is_null()) request.previous = line_of(ask["previous"], ask["previous"].contains("x"));
  const TapResult result = arm.tap(request);
  Json out{{"tap", ask["tap"]}, {"outcome", outcome_name(result.outcome)}, {"seconds", result.seconds}};
  if (result.distance) out["distance"] = *result.distance;
  if (result.is_contact()) {
    const Eigen::Vector3d& at = *result.contact;
    out["contacts"] = {{{"position", std::array<double, 3>{at.x(), at.y(), at.z()}}}};
    out["force"] = result.force;
  }
  if (!result.reason.empty()) out["reason"] = result.reason;
  return out;
}

Json answer_reaches(const Json& lines, const Backend& arm) {
  const auto count = static_cast<Eigen::Index>(lines.size());
  Candidates asked;
  asked.starts.resize(count, 3);
  asked.directions.resize(count, 3);
  asked.lengths.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto numbers = lines.at(static_cast<std::size_t>(i)).get<std::array<double, 7>>();
    asked.starts.row(i) << numbers[0], numbers[1], numbers[2];
    asked.directions.row(i) << numbers[3], numbers[4], numbers[5];
    asked.lengths(i) = numbers[6];
  }
  Eigen::Array<bool, Eigen::Dynamic, 1> reached(count);
  arm.reaches(asked, reached);
  std::string out;
  for (const bool one : reached) out += one ? '1' : '0';
  return {{"reaches", out}};
}

void serve(const std::vector<std::string>& overrides) {
  const ResolvedConfig config = test::shipped_config("any_side.yaml", overrides);
  const auto seed = static_cast<std::uint64_t>(config.options.seed);
  const std::unique_ptr<const Scene> scene = build_scene(config.options.scene, seed, test::shared_host());
  const Context context{test::shared_host(), *scene, seed, nullptr};
  const std::shared_ptr<Backend> arm = context.create<Backend>(config.options.backend);
  for (std::string line; std::getline(std::cin, line);) {
    const Json ask = Json::parse(line);
    if (ask.at("palpate") != 2) throw std::runtime_error("asked by another version of the protocol");
    const Json answer = ask.contains("reaches") ? answer_reaches(ask["reaches"], *arm) : answer_tap(ask, *arm);
    std::cout << answer.dump() << std::endl;
  }
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  try {
    palpate::serve({words + 1, words + count});
    return 0;
  } catch (const std::exception& trouble) {
    std::cerr << trouble.what() << '\n';
    return 1;
  }
}
