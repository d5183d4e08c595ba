"""Puts a video into water: a video file in, a video file out.

A style or haze needs no distances. Optical water needs them: a folder of depths by the number of the frame
(000000.npy in meters, or 16-bit PNG in millimeters), or one distance for all pixels. The camera is `camera.hfov_deg` of
the job. Sound is not copied.

    pip install fathom-datasets av
    python examples/video.py dive.mp4 wet.mp4 --job job.json
    python examples/video.py dive.mp4 wet.mp4 --job job.json --depth-folder depths
"""

import argparse
import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import av
import fathom
import numpy as np
from fathom._native import decode
from numpy.typing import NDArray

DEFAULT_RATE = 30


def read_options() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("video", type=Path, help="video to read")
    parser.add_argument("out", type=Path, help="video to write, .mp4 or .mkv")
    parser.add_argument("--job", type=Path, required=True, help="job as JSON; it needs no scene")
    depths = parser.add_mutually_exclusive_group()
    depths.add_argument("--depth-folder", type=Path, help="depths along the optical axis: 000000.npy or 000000.png")
    depths.add_argument("--distance-m", type=float, help="distance of every pixel along the ray, in meters")
    parser.add_argument("--show", help="write this result of `enhance` in place of the picture")
    parser.add_argument("--codec", default="libx264", help="codec of the result [default: %(default)s]")
    options = parser.parse_args()
    if options.distance_m is not None and not 0 < options.distance_m < float("inf"):
        parser.error(f"--distance-m is {options.distance_m}; must be above 0")
    if options.out.exists():
        parser.error(f"{options.out} exists; choose another name, or remove it")
    return options


def read_depth(folder: Path, number: int) -> NDArray[np.generic]:
    """Return the depth of a frame: float32 meters or uint16 millimeters."""
    paths = [folder / f"{number:06}{end}" for end in (".npy", ".png")]
    found = [path for path in paths if path.exists()]
    if not found:
        raise SystemExit(f"frame {number} has no depth: {paths[0]} and {paths[1].name} do not exist")
    return decode(found[0].read_bytes())


def open_stream(job: Path) -> fathom.Stream:
    """Return the stream of a job."""
    try:
        return fathom.Stream(job)
    except fathom.FathomError as error:
        raise SystemExit(f"{job}: {error}") from None


def render(video: av.container.InputContainer, options: argparse.Namespace) -> Iterator[av.VideoFrame]:
    """Yield the frames of the result, with the times of those of the video."""
    stream = open_stream(options.job)
    for number, frame in enumerate(video.decode(video=0)):
        rgb = frame.to_ndarray(format="rgb24")
        distances: dict[str, NDArray[np.generic]] = {}
        if options.depth_folder is not None:
            distances["z_depth"] = read_depth(options.depth_folder, number)
        elif options.distance_m is not None:
            distances["range_m"] = np.full(rgb.shape[:2], options.distance_m, np.float32)
        # The time is the seed of the frame: the same video gives the same result.
        if frame.pts is None or frame.time_base is None:
            raise SystemExit(f"frame {number} of {options.video} has no time; write the video again with times")
        stamp_ns = round(Fraction(frame.pts) * frame.time_base * 1_000_000_000)
        out = stream(rgb, stamp_ns=stamp_ns, **distances)
        if number == 0:
            for warning in out.warnings:
                print(f"warning: {warning}", file=sys.stderr)
        wet = av.VideoFrame.from_ndarray(select_picture(out, options.show), format="rgb24")
        wet.pts, wet.time_base = frame.pts, frame.time_base
        yield wet


def select_picture(out: fathom.StreamFrame, name: str | None) -> NDArray[np.uint8]:
    """Return the picture, or a result of `enhance`."""
    if name is not None and name not in out.enhanced:
        raise SystemExit(f"--show is {name!r}; `enhance` of the job has {', '.join(out.enhanced) or 'nothing'}")
    return out.rgb if name is None else out.enhanced[name]


def write_video(options: argparse.Namespace, path: Path) -> int:
    """Write the result to a path and return the number of frames."""
    count = 0
    with av.open(str(options.video)) as video, av.open(str(path), "w") as result:
        given = video.streams.video[0]
        stream = result.add_stream(options.codec, rate=given.average_rate or DEFAULT_RATE)
        stream.width, stream.height, stream.pix_fmt = given.width, given.height, "yuv420p"
        stream.time_base = given.time_base
        for frame in render(video, options):
            result.mux(stream.encode(frame))
            count += 1
        result.mux(stream.encode())
    return count


def main() -> None:
    """Convert the video that the command line names."""
    options = read_options()
    # A name that is complete only at the end: no half of a video is left under the name of the result.
    partial = options.out.with_name(f".{options.out.name}.part{options.out.suffix}")
    try:
        count = write_video(options, partial)
        partial.rename(options.out)
    except (fathom.FathomError, av.FFmpegError, OSError) as error:
        raise SystemExit(f"{options.video}: {error}") from None
    finally:
        partial.unlink(missing_ok=True)
    print(f"{options.out}: {count} frames")


if __name__ == "__main__":
    main()
