#!/usr/bin/env bash
# Fetches ONNX Runtime's shared library from its Python package, through pip, for this machine's architecture, and puts it
# with its licence into .onnxruntime (or into the folder that is given). A second run finds it and returns at once.
set -euo pipefail

version=1.31.1
root=$(cd "$(dirname "$0")/.." && pwd)
target=${1:-$root/.onnxruntime}
library=$target/libonnxruntime.so

case "$(uname -m)" in
  x86_64)
    platforms=(manylinux_2_28_x86_64 manylinux_2_27_x86_64)
    digest=fc44112fbe06d7d689c57e11d3862031f64711007e4ee020f8eed5185fd2c1d3
    ;;
  aarch64)
    platforms=(manylinux_2_28_aarch64 manylinux_2_27_aarch64)
    digest=8aa3b76b28c778a2b1dd660d34161adb1d508c9ccd04ff9dc80e26eca5df8467
    ;;
  *)
    echo "ONNX Runtime has no package for $(uname -m); give your own library with --onnxruntime" >&2
    exit 1
    ;;
esac

matches() { [ -f "$library" ] && echo "$digest  $library" | sha256sum --check --status; }
if matches; then
  exit 0
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "fetching ONNX Runtime $version" >&2
if ! python3 -m pip download --quiet --no-deps --only-binary=:all: "${platforms[@]/#/--platform=}" \
  --implementation cp --python-version 3.12 --abi cp312 --dest "$work" "onnxruntime==$version"; then
  echo "pip could not download onnxruntime $version; is python3 with pip installed and a package index in reach?" >&2
  exit 1
fi
# The same file for every Python, so one fixed wheel will do; no Python package is installed.
python3 - "$work" "$version" <<'PY'
import pathlib, sys, zipfile
work, version = pathlib.Path(sys.argv[1]), sys.argv[2]
wheel = next(work.glob("*.whl"))
wanted = {f"onnxruntime/capi/libonnxruntime.so.{version}": "libonnxruntime.so",
          "onnxruntime/LICENSE": "LICENSE", "onnxruntime/ThirdPartyNotices.txt": "ThirdPartyNotices.txt"}
(work / "out").mkdir()
with zipfile.ZipFile(wheel) as archive:
    for inside, outside in wanted.items():
        (work / "out" / outside).write_bytes(archive.read(inside))
PY
if ! echo "$digest  $work/out/libonnxruntime.so" | sha256sum --check --status; then
  echo "the library in the package is not the expected one: $(sha256sum "$work/out/libonnxruntime.so")" >&2
  exit 1
fi
mkdir -p "$target"
cp "$work/out/LICENSE" "$work/out/ThirdPartyNotices.txt" "$target/"
mv "$work/out/libonnxruntime.so" "$library.part"
mv "$library.part" "$library"
echo "$library" >&2
