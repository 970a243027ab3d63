// SPDX-License-Identifier: MIT
#include "baxter/available.hpp"

namespace palpate::baxter {

bool available() { return true; }

}  // namespace palpate::baxter
