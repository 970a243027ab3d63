// SPDX-License-Identifier: MIT
#include "fuzz/harness.hpp"

namespace palpate::fuzz {

const std::vector<Door>& doors() {
  static const std::vector<Door> all{
      {"config", config}, {"words", words}, {"record", record},   {"plan", plan},     {"bundle", bundle},
      {"answer", answer}, {"table", table}, {"heights", heights}, {"scores", scores},
#ifdef PALPATE_FUZZ_MESH
      {"mesh", mesh},
#endif
#ifdef PALPATE_FUZZ_ROS
      {"xmlrpc", xmlrpc},
#endif
  };
  return all;
}

}  // namespace palpate::fuzz
