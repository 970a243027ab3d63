#!/bin/sh
# SPDX-License-Identifier: MIT
# An acquisition in sh: the uncertainty is the score. framework/docs/strategies.md has the protocol.
# reads=["uncertainty"]
while read -r ask; do
  bytes=${ask##*\"bytes\":}
  head -c "${bytes%\}}"
done
