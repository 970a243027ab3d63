// SPDX-License-Identifier: MIT
#include "report/page/json_text.hpp"

#include "record/row.hpp"

namespace palpate {

std::string json_object(const std::vector<std::pair<std::string, std::string>>& fields) {
  std::string out = "{";
  for (const auto& [name, value] : fields) out += (out.size() > 1 ? "," : "") + json_quoted(name) + ":" + value;
  return out + "}";
}

std::string json_list(const std::vector<std::string>& items) {
  std::string out = "[";
  for (const std::string& item : items) out += (out.size() > 1 ? "," : "") + item;
  return out + "]";
}

std::string json_texts(const std::vector<std::string>& texts) {
  std::vector<std::string> items;
  for (const std::string& text : texts) items.push_back(json_quoted(text));
  return json_list(items);
}

std::string json_numbers(const Eigen::VectorXd& numbers) {
  std::vector<std::string> items;
  for (const double number : numbers) items.push_back(json_value(number));
  return json_list(items);
}

}  // namespace palpate
