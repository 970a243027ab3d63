// SPDX-License-Identifier: MIT
// JSON put together from pieces that are JSON already, for the data of a page. Single values come from record/row.hpp.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// An object of names and values, in that order.
std::string json_object(const std::vector<std::pair<std::string, std::string>>& fields);

std::string json_list(const std::vector<std::string>& items);

/// A list of what `to_json` makes of each item.
template <class Item, class ToJson>
std::string json_list_of(const std::vector<Item>& items, const ToJson& to_json) {
  std::vector<std::string> out;
  out.reserve(items.size());
  std::transform(items.begin(), items.end(), std::back_inserter(out), to_json);
  return json_list(out);
}

std::string json_texts(const std::vector<std::string>& texts);
std::string json_numbers(const Eigen::VectorXd& numbers);

}  // namespace palpate
