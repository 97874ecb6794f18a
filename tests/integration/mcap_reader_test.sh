#!/usr/bin/env bash
# The reference MCAP library (npm @mcap/core) opens what the programs write. mcap_reader_test.sh BIN RECORDINGS SCRATCH
# Skips loudly (77) where node 20 or the package is not to be had.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/mcap-reader" && pwd)
bin=$1 recordings=$2 scratch=$3

skip() { echo "SKIPPED: $*" >&2; exit 77; }
command -v node >/dev/null || skip "no node; the independent MCAP reader was not run"
[ "$(node -p 'process.versions.node.split(".")[0]')" -ge 20 ] || skip "node $(node --version) is older than 20; the independent MCAP reader was not run"
command -v npm >/dev/null || skip "no npm; the independent MCAP reader was not run"

mkdir -p "$scratch"
cp "$here"/{package.json,package-lock.json,check.mjs} "$scratch"
if [ ! -d "$scratch/node_modules/@mcap/core" ]; then
  (cd "$scratch" && npm ci --silent --no-audit --no-fund >/dev/null 2>&1) || skip "npm could not install @mcap/core; the independent MCAP reader was not run"
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
checked=0
check() { node "$scratch/check.mjs" "$1" >"$work/report.json" || { cat "$work/report.json"; echo "FAILED: $1"; exit 1; }; checked=$((checked + 1)); }
for scan in "$recordings"/*.xyz; do
  "$bin/scansion" compress "$scan" -o "$work/r.mcap" --force 2>/dev/null
  check "$work/r.mcap"
done
"$bin/scansion" export "$work/r.mcap" --level 1 -o "$work/cut.mcap" 2>/dev/null
check "$work/cut.mcap"
"$bin/scansim" scene part --lines 300 --points 200 -o "$work/part.xyz" 2>/dev/null
"$bin/scansion" compress "$work/part.xyz" -o "$work/part.mcap" 2>/dev/null
check "$work/part.mcap"
# Damage one group in the middle: the recovered recording has a gap message.
size=$(stat -c %s "$work/part.mcap")
printf '\377\377\377\377' | dd of="$work/part.mcap" bs=1 seek=$((size / 2)) conv=notrunc status=none
"$bin/scansion" recover "$work/part.mcap" -o "$work/recovered.mcap" >/dev/null && { echo "recover missed the damage"; exit 1; }
check "$work/recovered.mcap"
echo "$checked recordings opened by @mcap/core"
