#!/usr/bin/env bash
# ./dev demo: the main job from a synthetic part to a recording and its exports. demo.sh BIN OUTPUT_FOLDER
set -euo pipefail
bin=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)
export PATH="$bin:$PATH"

step() { printf '\n\033[1m%s\033[0m\n' "$*"; }
run() { printf '  $ %s\n' "$*"; "$@"; }

cd "$out"
daemon=
stop() { [ -z "$daemon" ] || kill "$daemon" 2>/dev/null || true; }
trap stop EXIT

step "1. The simulator scans a part: 1,214 lines, 1,328,531 points, 5 um noise"
run scansim scene paper -o part.xyz --force

step "2. The daemon replays the scan as a device and records it, ranked and compressed"
rm -rf recordings
cat >scansiond.toml <<TOML
[recording]
directory = "$out/recordings"
min_free_mb = 0

[control]
socket = "$out/control.sock"

[[device]]
name   = "table-1"
driver = "replay"
file   = "$out/part.xyz"
TOML
printf '  $ scansiond --config scansiond.toml &\n'
scansiond --config scansiond.toml 2>scansiond.log &
daemon=$!
for _ in $(seq 300); do
  if scansion status --json --socket control.sock 2>/dev/null | grep -q '"state": *"finished"'; then break; fi
  kill -0 "$daemon" 2>/dev/null || { cat scansiond.log; echo "scansiond ended early" >&2; exit 1; }
  sleep 0.1
done
run scansion status --socket control.sock
kill -TERM "$daemon"
wait "$daemon"
daemon=
recording=$(ls recordings/*.mcap)
cp "$recording" part.mcap

step "3. What is in the recording, and is every byte of it right?"
run scansion info part.mcap
run scansion verify part.mcap

step "4. Any level of detail back"
run scansion export part.mcap -o part-95.ply --reduction 95 --scope scan --force
run scansion export part.mcap -o part-0.05.xyz --tolerance 0.05 --force
run scansion export part.mcap -o part-level0.xyz --level 0 --force
run scansion export part.mcap -o part-rearrangement.txt --what rearrangement --force
run scansion export part.mcap -o part-all.xyz --force

step "5. The recording gives back exactly what went in"
if [ "$(grep -v '^#' part.xyz | sed -E 's/(\.[0-9]*[1-9])0+( |$)/\1\2/g; s/\.0+( |$)/\1/g' | sha256sum)" = \
     "$(grep -v '^#' part-all.xyz | sha256sum)" ]; then
  echo "  part.xyz and part-all.xyz hold the same points"
else
  echo "  part.xyz and part-all.xyz DIFFER" >&2
  exit 1
fi

step "Look at these in $out"
ls -l --time-style=+ part.mcap part-95.ply part-rearrangement.txt part-0.05.xyz | awk '{printf "  %10s  %s\n", $5, $6}'
