"""Messages of robots as arrays, and the pairing of images with depths.

Everything here reads attributes alone, so that messages of `rclpy` and of `rosbags`, of ROS 1 and ROS 2, serve alike.
"""
