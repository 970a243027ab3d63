// SPDX-License-Identifier: MIT
#include "watch/sweep_follower.hpp"

#include "config/catch_error.hpp"
#include "record/run_directory.hpp"
#include "report/page/page.hpp"
#include "report/page/sweep_page.hpp"

#include <algorithm>

namespace palpate {

bool SweepFollower::look(double /*seconds*/) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kLeast(2);
  constexpr int kShare = 20;
  const Clock::time_point begin = Clock::now();
  if (begin < next_) return false;
  Json data;
  const auto trouble = catch_error([&] { data = sweep_data(sweep_, [](int, int) {}); });
  if (trouble) data = {{"trouble", trouble->what()}};
  if (data != data_) ++revision_;
  data_ = std::move(data);
  const Clock::time_point end = Clock::now();
  next_ = end + std::max<Clock::duration>(kLeast, kShare * (end - begin));
  return false;
}

std::string SweepFollower::page() {
  Json data = data_;
  if (data.contains("trouble"))
    data = {{"name", "sweep"}, {"id", sweep_.directory.filename().string()}, {"waiting", data["trouble"]}};
  data["live"] = std::to_string(revision_);
  return make_page(palpate_asset_sweep, data, "", PageOrigin::server);
}

std::optional<std::string> SweepFollower::news(const std::string& at) {
  const std::string now = std::to_string(revision_);
  if (at == now) return std::nullopt;
  // The JSON text is concatenated, because copying the data of a sweep into a JSON object may need megabytes.
  return "{\"at\": \"" + now + "\", \"sweep\": " + line_of(data_) + "}";
}

bool SweepFollower::goes_on() const {
  return std::any_of(sweep_.jobs.begin(), sweep_.jobs.end(),
                     [&](const Job& job) { return is_running(job_directory(sweep_, job)); });
}

}  // namespace palpate
