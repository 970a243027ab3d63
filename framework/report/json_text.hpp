// SPDX-License-Identifier: MIT
// JSON put together from pieces that are JSON already, for the data of a page. Single values come from record/row.hpp.
#pragma once

#include <Eigen/Core>

#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// An object of names and values, in that order.
std::string json_object(const std::vector<std::pair<std::string, std::string>>& fields);

std::string json_list(const std::vector<std::string>& items);

std::string json_texts(const std::vector<std::string>& texts);
std::string json_numbers(const Eigen::VectorXd& numbers);

}  // namespace palpate
