// SPDX-License-Identifier: MIT
#include "baxter/unavailable.hpp"

namespace palpate::baxter {

void require_available(Fields&) {}

}  // namespace palpate::baxter
