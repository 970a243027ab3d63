// SPDX-License-Identifier: MIT
#include "report/page/assets.hpp"

#include <cstddef>

// Of assets.S.
extern "C" {
extern const char palpate_asset_plotly[], palpate_asset_plotly_end[];
extern const char palpate_asset_style[], palpate_asset_style_end[];
extern const char palpate_asset_common[], palpate_asset_common_end[];
extern const char palpate_asset_run[], palpate_asset_run_end[];
extern const char palpate_asset_sweep[], palpate_asset_sweep_end[];
}

namespace palpate {
namespace {

std::string_view between(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

}  // namespace

std::string_view plotly_asset() { return between(palpate_asset_plotly, palpate_asset_plotly_end); }
std::string_view style_asset() { return between(palpate_asset_style, palpate_asset_style_end); }
std::string_view common_script() { return between(palpate_asset_common, palpate_asset_common_end); }
std::string_view run_script() { return between(palpate_asset_run, palpate_asset_run_end); }
std::string_view sweep_script() { return between(palpate_asset_sweep, palpate_asset_sweep_end); }

}  // namespace palpate
