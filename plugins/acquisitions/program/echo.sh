#!/bin/sh
# SPDX-License-Identifier: MIT
# Acquisition as a shell script whose score is the uncertainty. The protocol is in framework/docs/strategies.md.
# reads=["uncertainty"]
while read -r ask; do
  bytes=${ask##*\"bytes\":}
  head -c "${bytes%\}}"
done
