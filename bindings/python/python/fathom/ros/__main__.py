"""`python -m fathom.ros`: the ROS 2 node."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from fathom.errors import FathomError

_HELP = """usage: fathom-ros [--files] [--ros-args …]

Puts the pictures of a camera into water: `image`, `depth` and `camera_info` in, `~/image` out.

  fathom-ros --ros-args -p site:=tank -r image:=/camera/image -r depth:=/camera/depth -r camera_info:=/camera/info

  --files   print the folder with the launch file and a parameter file for each site
  --help    print this help
"""
_NEEDED = {
    "rclpy": "it is part of ROS 2 and not of this package; source the setup file of your ROS installation, such as "
    "`source /opt/ros/jazzy/setup.bash`, and start again with a Python of the same version",
    "PIL": "install it with `pip install 'fathom-datasets[ros]'`",
}


def main() -> int:
    """Run the node with the arguments of the process and return its exit status."""
    given = sys.argv[1:]
    if "--help" in given or "-h" in given:
        print(_HELP, end="")
        return 0
    if given == ["--files"]:
        print(Path(__file__).parent / "files")
        return 0
    if given and given[0] != "--ros-args":
        print(f"fathom-ros: `{given[0]}` is unknown; must be --files, --help or --ros-args", file=sys.stderr)
        return 2
    for module, remedy in _NEEDED.items():
        if importlib.util.find_spec(module) is None:
            print(f"fathom-ros: `{module}` is not installed: {remedy}", file=sys.stderr)
            return 1
    from fathom.ros.node import run

    try:
        run(sys.argv)
    except FathomError as error:
        print(f"fathom-ros: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
