// SPDX-License-Identifier: MIT
// The options of the backend can be read here whatever the plugin says of itself: nothing is required.
#include "baxter/unavailable.hpp"

namespace palpate::baxter {

// Weak: where the plugin's own is linked, too, that counts.
__attribute__((weak)) void require_available(Fields&) {}

}  // namespace palpate::baxter
