#!/bin/sh
# SPDX-License-Identifier: MIT
# Turns a table of `palpate compare --by ROW,COLUMN --format markdown` with one metric and one number of taps, on stdin, into one
# with a row per value of ROW and a column per value of COLUMN.
#   ./palpate compare SWEEP --by acquisition,scene --at 40 --metric surface_distance_m --format markdown | sh tests/benchmark/pivot.sh
awk -F' *[|] *' '
  NF != 6 { next }  # not of the table
  $2 ~ /^-/ { next }
  !head { head = $2; metric = $5; next }
  {
    if (!($2 in seen_row)) rows[++n] = $2
    if (!($3 in seen_column)) columns[++m] = $3
    seen_row[$2]; seen_column[$3]
    cell[$2, $3] = $5
  }
  END {
    if (!n) exit 1
    printf "| %s, %s |", head, metric
    for (j = 1; j <= m; ++j) printf " %s |", columns[j]
    printf "\n|---|"
    for (j = 1; j <= m; ++j) printf "---:|"
    for (i = 1; i <= n; ++i) {
      printf "\n| %s |", rows[i]
      for (j = 1; j <= m; ++j) printf " %s |", cell[rows[i], columns[j]]
    }
    print ""
  }'
