"""Runs with another version of ROS: writes a line of JSON for each message of an Image topic."""

import importlib.metadata
import json
import sys
import time
import zlib

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Image


def main() -> None:
    """Subscribe the topic of the first argument with the quality of the second until the process is terminated."""
    quality = QoSProfile(depth=10) if sys.argv[2] == "reliable" else qos_profile_sensor_data
    rclpy.init()
    node = rclpy.create_node("subscriber")

    def write_line(message: Image) -> None:
        now = time.time_ns()
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        shape = message.width, message.height, message.encoding
        print(json.dumps([stamp, now, *shape, zlib.crc32(message.data)]), flush=True)

    node.create_subscription(Image, sys.argv[1], write_line, quality)
    print("ready", importlib.metadata.version("ros-rclpy"), flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
