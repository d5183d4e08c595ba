#!/usr/bin/env bash
# Tests the ROS 2 node with two versions of ROS: PyBullet drives past a pile, its pictures go through topics of Jazzy to the node, and
# a subscriber of Kilted receives the results. ROS comes from PyPI, for Python 3.11; these are wheels of third parties, for tests only.
# Usage: scripts/test-ros.sh [--short] [ARGUMENTS OF pytest]
# Without --short, tests/ros/test_long.py also runs four times FATHOM_ROS_MINUTES (10) at 10 Hz and prints loss, latency, memory and CPU.
# --short skips everything, with a message, where the wheels do not install.
# FATHOM_WHEEL names the wheel to test; without it, it is built.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
mode=()
if [ "${1:-}" = --short ]; then
    shift
    mode=(-m 'not long')
fi

give_up() {
    echo "test-ros: $1" >&2
    if [ ${#mode[@]} -gt 0 ]; then
        echo 'test-ros: SKIPPED: the ROS 2 node is not tested' >&2
        exit 0
    fi
    exit 1
}

find_python() {
    for python in "$HOME"/.pyenv/versions/3.11.*/bin/python python3.11; do
        if "$python" -c '' 2>/dev/null; then
            echo "$python"
            return
        fi
    done
}
python=$(find_python)
[ -n "$python" ] || give_up 'no Python 3.11, for which the wheels of ROS are made, is there'

# A virtual environment with these packages, made once.
environment() {
    local place=$1
    shift
    [ "$(cat "$place/packages" 2>/dev/null)" != "$*" ] || return 0
    rm -rf "$place"
    "$python" -m venv "$place" &&
        "$place/bin/pip" install --quiet --disable-pip-version-check "$@" &&
        "$place/bin/python" -c 'import rclpy, sensor_msgs.msg; rclpy.init(); rclpy.create_node("probe"); rclpy.shutdown()' &&
        echo "$*" >"$place/packages"
}
jazzy=$target/tools/ros-jazzy
kilted=$target/tools/ros-kilted
environment "$jazzy" 'ros-jazzy-rclpy[fastrtps]==7.1.6' ros-jazzy-sensor-msgs==5.3.6 ros-jazzy-diagnostic-msgs==5.3.6 numpy pybullet==3.2.7 \
    pillow psutil pytest==9.2.0 rosbags==0.11.9 || give_up 'ROS 2 Jazzy and PyBullet do not install from PyPI'
environment "$kilted" 'ros-kilted-rclpy[fastrtps]==9.1.2' ros-kilted-sensor-msgs==5.5.1 numpy || give_up 'ROS 2 Kilted does not install from PyPI'
"$jazzy/bin/pip" install --quiet --disable-pip-version-check mujoco==4.0.0 ||
    echo 'test-ros: SKIPPED: MuJoCo does not install from PyPI; its example is not tested' >&2

wheel=${FATHOM_WHEEL:-$(scripts/build-wheel.sh)}
"$jazzy/bin/pip" install --quiet --disable-pip-version-check --no-deps --force-reinstall "$wheel"

export FATHOM_ROS_SUBSCRIBER=$kilted/bin/python PYTHONDONTWRITEBYTECODE=1
cd tests/ros
exec "$jazzy/bin/python" -m pytest -s "${mode[@]}" "$@"
