// SPDX-License-Identifier: MIT
// The assets of pages and figures, embedded in the program (page.hpp, gnuplot.hpp). The build sets their folders.
        .globl palpate_asset_plotly, palpate_asset_plotly_end
        .globl palpate_asset_figures, palpate_asset_style, palpate_asset_common, palpate_asset_run, palpate_asset_runs, palpate_asset_sweep

        .section .rodata
palpate_asset_plotly:
        .incbin "vendor/plotly/plotly.min.js.gz"
palpate_asset_plotly_end:
        # Zero-terminated texts.
palpate_asset_figures:
        .incbin "figure_templates.gnuplot"
        .byte 0
palpate_asset_style:
        .incbin "web/style.css"
        .byte 0
palpate_asset_common:
        .incbin "web/theme.js"
        .incbin "web/common.js"
        .incbin "web/live.js"
        .byte 0
palpate_asset_run:
        .incbin "web/run_maps.js"
        .incbin "web/run_space.js"
        .incbin "web/play.js"
        .incbin "web/run.js"
        .byte 0
palpate_asset_runs:
        .incbin "web/run_maps.js"
        .incbin "web/runs.js"
        .byte 0
palpate_asset_sweep:
        .incbin "web/sweep_numbers.js"
        .incbin "web/sweep_panels.js"
        .incbin "web/sweep_curves.js"
        .incbin "web/sweep_race.js"
        .incbin "web/sweep.js"
        .byte 0

        .section .note.GNU-stack, "", %progbits
