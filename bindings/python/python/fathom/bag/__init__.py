"""Recordings of robots: `fathom bag` puts their images into water, and `fathom upload` makes scenes of them.

Needs `rosbags` (`pip install 'fathom-datasets[bag]'`), not ROS.
"""
