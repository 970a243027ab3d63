// SPDX-License-Identifier: MIT
// The files that a page is made of, byte for byte within the program: see assets.hpp. The build passes their folder.
        .macro asset name, file
        .globl palpate_asset_\name
        .globl palpate_asset_\name\()_end
palpate_asset_\name:
        .incbin "\file"
palpate_asset_\name\()_end:
        .endm

        # Three files, one behind the other.
        .macro asset_of_three name, first, second, third
        .globl palpate_asset_\name
        .globl palpate_asset_\name\()_end
palpate_asset_\name:
        .incbin "\first"
        .incbin "\second"
        .incbin "\third"
palpate_asset_\name\()_end:
        .endm

        .section .rodata
        asset plotly, "vendor/plotly/plotly.min.js.gz"
        asset style, "web/style.css"
        asset common, "web/common.js"
        asset_of_three run, "web/run_maps.js", "web/run_curves.js", "web/run.js"
        asset_of_three sweep, "web/sweep_numbers.js", "web/sweep_panels.js", "web/sweep.js"

        .section .note.GNU-stack, "", %progbits
