"""Parameter files of the package, read by ROS."""

import fathom
import pytest
import rclpy
from camera_driver import Camera
from fathom.ros.parameters import Parameters
from harness import FILES


@pytest.mark.parametrize("name", [*fathom.names()["sites"], "live"])
def test_ros_reads_every_parameter_file(camera: Camera, name: str) -> None:
    node = rclpy.create_node(
        "reader",
        cli_args=["--ros-args", "--params-file", str(FILES / f"{name}.yaml")],
        allow_undeclared_parameters=True,
        automatically_declare_parameters_from_overrides=True,
    )
    try:
        parameters = Parameters(node)
        lines = (FILES / f"{name}.yaml").read_text().splitlines()
        written = {line.split(":")[0].strip() for line in lines if line.startswith("    ")}
        assert written <= set(node.get_parameters_by_prefix(""))
        assert parameters.description["water"]["optics"]["preset"]
    finally:
        node.destroy_node()
