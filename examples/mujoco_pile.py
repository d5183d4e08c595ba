"""Inspects a pile in MuJoCo and puts the pictures into water: a contact sheet of air, distances and water.

Needs the package `fathom`, mujoco, pillow and OSMesa (`apt-get install libosmesa6`), which renders on the CPU. With
a GPU, set MUJOCO_GL=egl.

    python examples/mujoco_pile.py --out pile.webp
"""

import argparse
import math
import os

os.environ.setdefault("MUJOCO_GL", "osmesa")

import fathom
import mujoco
import numpy as np
from PIL import Image

JOB = {
    "water": {
        "optics": {
            "preset": "jerlov-3C",
            "veiling_light": [0.02, 0.1, 0.07],
            "forward_scatter": {"model": "jaffe"},
        },
        "range_scale": 0.4,
        "turbidity": {"contrast": 0.4},
    },
    "lights": [{"kind": "haze", "x": 0.5, "y": 1.05, "size": 0.3, "intensity": 0.2, "color": [0.7, 1, 0.8]}],
}
VFOV_DEG = 52
SITE = """
<mujoco>
  <visual>
    <global offwidth="{width}" offheight="{height}"/>
    <headlight ambient="0.35 0.35 0.35" diffuse="0.5 0.5 0.5" specular="0 0 0"/>
    <map znear="0.02" zfar="40"/>
    <quality shadowsize="2048"/>
  </visual>
  <statistic extent="1"/>
  <asset>
    <texture name="sand" type="2d" builtin="flat" mark="random" random="0.4" rgb1="0.55 0.5 0.4" markrgb="0.75 0.7 0.6"
        width="512" height="512"/>
    <texture name="steel" type="2d" builtin="gradient" mark="random" random="0.3" rgb1="0.5 0.36 0.25" rgb2="0.35 0.27 0.2"
        markrgb="0.25 0.18 0.12" width="256" height="256"/>
    <material name="sand" texture="sand" texrepeat="8 8"/>
    <material name="steel" texture="steel" texrepeat="3 6"/>
    <material name="zinc" rgba="0.85 0.85 0.82 1"/>
    <material name="shell" rgba="0.2 0.2 0.24 1"/>
  </asset>
  <worldbody>
    <light pos="-2 -4 6" dir="0.3 0.6 -0.9" diffuse="0.6 0.6 0.6"/>
    <geom type="plane" size="15 15 0.1" material="sand"/>
    <geom type="cylinder" size="0.4 2.5" pos="0 0 2.5" material="steel"/>
    <geom type="cylinder" size="0.4 2.5" pos="2.6 2.2 2.5" material="steel"/>
    <geom type="cylinder" size="0.44 0.06" pos="0 0 1.55" material="zinc"/>
    <geom type="box" size="0.06 0.06 0.28" pos="0.1 -0.47 0.95" material="zinc"/>
    {growth}
  </worldbody>
</mujoco>
"""


def describe_growth() -> str:
    """Return mussels on the pile and stones on the bottom."""
    rng = np.random.default_rng(5)
    geoms = []
    for _ in range(90):
        angle, height = rng.uniform(0, math.tau), 2.6 - rng.exponential(0.35)
        geoms.append((0.41 * math.cos(angle), 0.41 * math.sin(angle), height, rng.uniform(0.03, 0.08)))
    for _ in range(40):
        geoms.append((rng.uniform(-3, 3), rng.uniform(-1.2, 3), 0, rng.uniform(0.04, 0.16)))
    return "\n".join(
        f'<geom type="sphere" material="shell" pos="{x:.3f} {y:.3f} {z:.3f}" size="{radius:.3f}"/>'
        for x, y, z, radius in geoms
    )


def aim_camera(camera: mujoco.MjvCamera, share: float) -> np.ndarray:
    """Move the camera to a share, 0 to 1, of the way past the pile; returns its pose for Fathom."""
    eye = np.array([-1.3 + 2.6 * share, -2.0 - 0.3 * math.sin(math.pi * share), 1.9 - 0.7 * share])
    target = np.array([0.25 * (share - 0.5), 0, eye[2] - 0.25])
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, (0, 0, 1))
    right /= np.linalg.norm(right)
    camera.lookat[:] = target
    camera.distance = np.linalg.norm(target - eye)
    camera.azimuth = math.degrees(math.atan2(ahead[1], ahead[0]))
    camera.elevation = math.degrees(math.asin(ahead[2]))
    pose = np.eye(4)
    pose[:3] = np.column_stack([right, np.cross(ahead, right), ahead, eye])
    return pose


def take_shot(renderer: mujoco.Renderer, data: mujoco.MjData, camera: mujoco.MjvCamera) -> tuple:
    """Return the picture and the distances along the optical axis in meters, infinite for the sky."""
    renderer.update_scene(data, camera)
    rgb = renderer.render().copy()
    renderer.enable_depth_rendering()
    z_depth = renderer.render().astype(np.float32)
    renderer.disable_depth_rendering()
    return rgb, np.where(z_depth > 39, np.float32(np.inf), z_depth)


def main() -> None:
    """Drive past the pile and write the contact sheet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default="mujoco_pile.webp")
    parser.add_argument("--frames", type=int, default=4, help="pictures on the way past the pile")
    parser.add_argument("--width", type=int, default=768)
    parser.add_argument("--height", type=int, default=492)
    given = parser.parse_args()
    width, height = given.width, given.height
    model = mujoco.MjModel.from_xml_string(SITE.format(width=width, height=height, growth=describe_growth()))
    model.vis.global_.fovy = VFOV_DEG
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    focal = height / 2 / math.tan(math.radians(VFOV_DEG) / 2)
    matrix = [[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]]
    stream, camera, columns = fathom.Stream(JOB), mujoco.MjvCamera(), []
    with mujoco.Renderer(model, height, width) as renderer:
        for number in range(given.frames):
            pose = aim_camera(camera, number / max(given.frames - 1, 1))
            rgb, z_depth = take_shot(renderer, data, camera)
            out = stream(rgb, z_depth=z_depth, camera=matrix, pose=pose, stamp_ns=number * 100_000_000)
            print(f"frame {number}: {out.elapsed_ms:.0f} ms")
            near = np.uint8(255 * np.clip(1 - (z_depth - 0.5) / 6, 0, 1))
            columns.append(np.concatenate([rgb, np.repeat(near[..., None], 3, axis=2), out.rgb]))
    sheet = Image.fromarray(np.concatenate(columns, axis=1))
    sheet.thumbnail((1600, 1600))
    sheet.save(given.out, quality=80)


if __name__ == "__main__":
    main()
