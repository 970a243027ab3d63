// SPDX-License-Identifier: MIT
#include "experiment/check_quantities.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <iterator>

namespace palpate {

namespace {

QuantitySet offered_by(const Belief& belief) {
  QuantitySet out;
  for (const Quantity& one : belief.offers()) out.insert(one.name);
  return out;
}

}  // namespace

void leave_out_unoffered(ReadPlan::Reader& reader, const Belief& belief) {
  const QuantitySet offered = offered_by(belief);
  for (auto one = reader.reads.begin(); one != reader.reads.end();)
    one = offered.count(*one) != 0 ? std::next(one) : reader.reads.erase(one);
}

void require_offered(const ReadPlan& plan, const Belief& belief, const std::string& name) {
  const QuantitySet offered = offered_by(belief);
  for (const ReadPlan::Reader& reader : plan.readers) {
    for (const std::string& quantity : reader.reads) {
      if (offered.count(quantity) != 0) continue;
      const std::size_t blank = reader.name.find(' ');
      const std::string kind = reader.name.substr(0, blank);
      const bool has_choice = blank != std::string::npos;
      throw Error(kind,
                  fmt::format("{} reads {}, which the belief {} does not offer",
                              has_choice ? reader.name.substr(blank + 1) : kind, quantity, name),
                  fmt::format("{}; {} offers {}", has_choice ? "choose another " + kind : "remove it", name,
                              fmt::join(offered, ", ")));
    }
  }
}

}  // namespace palpate
