// SPDX-License-Identifier: MIT
#include "baxter/ros/graph.hpp"
#include "fuzz/harness.hpp"

namespace palpate::fuzz {

void xmlrpc(const std::string& bytes) {
  try {
    baxter::read_graph(bytes);
  } catch (const baxter::NetworkError&) {
  }
}

}  // namespace palpate::fuzz
