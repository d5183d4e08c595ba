#!/usr/bin/env bash
# Fetches the ONNX Runtime library that the style models run on, and puts it with its licenses into a folder:
# `.onnxruntime` of this checkout, or the folder given as the first argument. A second run returns at once.
set -euo pipefail

version=1.31.1
case "$(uname -m)" in
    x86_64) machine=x86_64 digest=fc44112fbe06d7d689c57e11d3862031f64711007e4ee020f8eed5185fd2c1d3 ;;
    aarch64 | arm64) machine=aarch64 digest=8aa3b76b28c778a2b1dd660d34161adb1d508c9ccd04ff9dc80e26eca5df8467 ;;
    *)
        echo "get-onnxruntime: no wheel of ONNX Runtime is known for $(uname -m); set ORT_DYLIB_PATH to a library of your own" >&2
        exit 1
        ;;
esac
if [ "$(uname -s)" != Linux ]; then
    echo "get-onnxruntime: only Linux is served; set ORT_DYLIB_PATH to a library of your own" >&2
    exit 1
fi

target=${1:-"$(cd "$(dirname "$0")/.." && pwd)/.onnxruntime"}
library=libonnxruntime.so

# True if the file has the digest of the library.
genuine() {
    echo "$digest  $1" | sha256sum --check --status 2>/dev/null
}

if [ -f "$target/$library" ] && genuine "$target/$library"; then
    exit 0
fi

mkdir -p "$target"
# Beside its final place, so that the last step is a rename within one file system.
work=$(mktemp -d "$target/.fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT

# The library is the same file for every Python, so one tag serves whichever Python runs pip.
if ! python3 -m pip download --quiet --disable-pip-version-check --no-deps --only-binary=:all: \
    --platform "manylinux_2_28_$machine" --platform "manylinux_2_27_$machine" \
    --implementation cp --python-version 3.12 --abi cp312 \
    --dest "$work" "onnxruntime==$version" >"$work/pip.log" 2>&1; then
    cat "$work/pip.log" >&2
    echo "get-onnxruntime: pip could not fetch onnxruntime $version (see above)." >&2
    echo "Python 3 with pip and a package index are needed; or set ORT_DYLIB_PATH to a library of ONNX Runtime 1.24 or newer." >&2
    exit 1
fi

python3 - "$work" "$version" <<'PYTHON'
import pathlib, sys, zipfile

folder, version = pathlib.Path(sys.argv[1]), sys.argv[2]
[wheel] = folder.glob("*.whl")
members = {
    f"onnxruntime/capi/libonnxruntime.so.{version}": "libonnxruntime.so",
    "onnxruntime/LICENSE": "LICENSE",
    "onnxruntime/ThirdPartyNotices.txt": "ThirdPartyNotices.txt",
}
with zipfile.ZipFile(wheel) as archive:
    for member, name in members.items():
        (folder / name).write_bytes(archive.read(member))
PYTHON

if ! genuine "$work/$library"; then
    echo "get-onnxruntime: the library in the wheel has another SHA-256 than $digest; nothing is installed" >&2
    exit 1
fi
# The library comes last: where it is, its licenses are.
for file in LICENSE ThirdPartyNotices.txt "$library"; do
    mv -f "$work/$file" "$target/$file"
done
echo "ONNX Runtime $version is in $target"
