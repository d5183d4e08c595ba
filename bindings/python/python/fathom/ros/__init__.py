"""The ROS 2 node: pictures and depths of camera topics in, pictures in water out.

`python -m fathom.ros` and `fathom-ros` start it. Only `node`, `endpoints` and `__main__` need `rclpy`, which comes with
the ROS installation of the user.
"""
