#!/usr/bin/env bash
# The page in a real browser. Needs web/dist (cargo xtask web), the command (cargo build), and Chromium: $CHROMIUM, or one in the path. It is installed where
# that is possible; where it can't be had, a line says so, and nothing has failed.
set -euo pipefail
cd "$(dirname "$0")/.."

find_chromium() { command -v chromium || command -v chromium-browser || command -v google-chrome || true; }
CHROMIUM=${CHROMIUM:-$(find_chromium)}
if [ -z "$CHROMIUM" ] && command -v apt-get >/dev/null; then
  { apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium; } >/dev/null 2>&1 || true
  CHROMIUM=$(find_chromium)
fi
if [ -z "$CHROMIUM" ]; then
  echo "skipped: Chromium can't be had here (set CHROMIUM to one): the page was not tested in a browser"
  echo "0 passed, 0 failed, $(grep -hE '^ *test\(' tests/*.spec.ts | wc -l) skipped"
  exit 0
fi
export CHROMIUM
exec npx playwright test --config tests/playwright.config.ts "$@"
