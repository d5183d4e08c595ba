"""Starts the node: `ros2 launch $(fathom-ros --files)/fathom.launch.py parameters:=tank image:=/camera/image …`.

`parameters` is the name of a file next to this one, such as `tank`, or the path of a parameter file.
"""

import sys
from pathlib import Path
from typing import Any

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

_TOPICS = ("image", "depth", "camera_info")
_ARGUMENTS = {
    "parameters": ("live", "name of a parameter file next to the launch file, or a path"),
    "name": ("fathom", "name of the node, the first part of its topics"),
    "image": ("image", "topic of the pictures"),
    "depth": ("depth", "topic of the depths"),
    "camera_info": ("camera_info", "topic of the camera_info"),
    "use_sim_time": ("false", "true for the clock of a simulator"),
}


def start_node(context: Any) -> list[Any]:
    """Return the process of the node with the arguments of the launch."""
    given = {name: LaunchConfiguration(name).perform(context) for name in _ARGUMENTS}
    shipped = Path(__file__).with_name(f"{given['parameters']}.yaml")
    path = shipped if shipped.exists() else Path(given["parameters"]).expanduser()
    if not path.exists():
        known = ", ".join(sorted(file.stem for file in Path(__file__).parent.glob("*.yaml")))
        raise FileNotFoundError(f"`parameters` is {given['parameters']}; must be {known}, or the path of a file")
    command = [sys.executable, "-m", "fathom.ros", "--ros-args", "--params-file", str(path)]
    command += ["-r", f"__node:={given['name']}", "-p", f"use_sim_time:={given['use_sim_time']}"]
    for topic in _TOPICS:
        command += ["-r", f"{topic}:={given[topic]}"]
    return [ExecuteProcess(cmd=command, output="screen")]


def generate_launch_description() -> Any:
    """Return the arguments and the node."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=meaning)
        for name, (default, meaning) in _ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start_node)])
