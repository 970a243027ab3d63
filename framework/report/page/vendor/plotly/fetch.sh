#!/bin/sh
# SPDX-License-Identifier: MIT
# Recreates plotly.min.js.gz and LICENSE from the npm package plotly.js-dist-min, which has the MIT license like this
# project. Fails if the bytes do not have the checksums below. For a new version, change the three values below, run
# this script, and look at a report:
#   sh framework/report/page/vendor/plotly/fetch.sh
set -eu
version=4.1.2
package_sha512=552992f4a54dba7d7a4bca85618a7d2e52ff5c16f2e2e79e1aa07e2bd02a44256cba9f1d4a91942daa785324757f69b3e29577aa35a9d6c479721c0b80828fa1
script_sha256=2f645d1bade8182fce161b7f10f89402f8b315805250ff4a94672a28d23c390a
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm pack --silent "plotly.js-dist-min@$version" >/dev/null
echo "$package_sha512  plotly.js-dist-min-$version.tgz" | sha512sum --check --quiet
tar -xzf "plotly.js-dist-min-$version.tgz"
echo "$script_sha256  package/plotly.min.js" | sha256sum --check --quiet
gzip -9n <package/plotly.min.js >"$here/plotly.min.js.gz"
cp package/LICENSE "$here/LICENSE"
