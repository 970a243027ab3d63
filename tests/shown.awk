# SPDX-License-Identifier: MIT
# Ends with status 1 and the first line that is missing, unless each line of the first file stands in the second, in the
# same order. Lines "..." of the first file stand for any lines.
#   awk -f tests/shown.awk shown printed
FNR == NR { if ($0 != "...") shown[++count] = $0; next }
found < count && $0 == shown[found + 1] { ++found }
END {
  if (!count) shown[1] = "no line is shown"
  if (count && found == count) exit 0
  print "not printed, or not in this order: " shown[found + 1]
  exit 1
}
