// SPDX-License-Identifier: MIT
#include "config/utf8.hpp"

#include <boost/locale/utf.hpp>

namespace palpate {

std::size_t utf8_length(std::string_view text) {
  using boost::locale::utf::code_point;
  const char* end = text.data();
  const code_point read = boost::locale::utf::utf_traits<char>::decode(end, text.data() + text.size());
  const bool refused = read == boost::locale::utf::illegal || read == boost::locale::utf::incomplete;
  return refused ? 0 : static_cast<std::size_t>(end - text.data());
}

std::size_t utf8_prefix(std::string_view text) {
  std::size_t valid = 0;
  while (valid < text.size()) {
    const std::size_t length = utf8_length(text.substr(valid));
    if (length == 0) break;
    valid += length;
  }
  return valid;
}

}  // namespace palpate
