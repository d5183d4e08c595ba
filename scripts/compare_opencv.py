"""HSCM written for OpenCV and for plain NumPy, timed in turns with Fathom's.

Every round runs each program five times and keeps the median, so that whatever else the machine does meets all of them
and none is measured with the caches of another. The median of the ratios of a round says more than the ratio of the
medians when the machine is busy.
"""

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time

import cv2
import numpy as np

SIZES = [(869, 565), (1280, 720), (1920, 1080)]
RUNS = 5  # of each program in a round
R_HIGH, R_LOW, CUTOFF, EPS = 2.5, 0.5, 32, 0.01


def picture(width, height):
    """Soft light, edges and grain, as in the benches."""
    y, x = np.mgrid[0:height, 0:width]
    u, v = x / width, y / height
    light = 0.25 + 0.6 * np.exp(-4 * ((u - 0.4) ** 2 + (v - 0.3) ** 2))
    plate = np.where((x // 97 + y // 61) % 3 == 0, 0.75, 1.0)
    grain = np.random.default_rng(1).random((height, width)) - 0.5
    channels = [255 * (light * plate * tint + 0.04 * grain) for tint in (0.5, 0.8, 0.9)]
    return np.clip(np.dstack(channels), 0, 255).astype(np.uint8)


def transfer(height, width, delta):
    """The filter's transfer function over signed bins."""
    rows, columns = np.fft.fftfreq(height) * height, np.fft.fftfreq(width) * width
    distance = rows[:, None] ** 2 + columns[None, :] ** 2
    return (R_HIGH - R_LOW) * (1 - np.exp(-distance / (2 * delta**2))) + R_LOW


def packed(real):
    """A real, even spectrum in the layout of OpenCV's transform of a real picture."""
    response = np.fft.ifft2(real).real.astype(np.float32)
    return cv2.dft(response)


class Tuned:
    """Real transform of a planned size, everything that does not change made once."""

    name = "OpenCV, tuned"

    def __init__(self, height, width):
        self.size = height, width
        self.padding = cv2.getOptimalDFTSize(height) - height, cv2.getOptimalDFTSize(width) - width
        whole = height + self.padding[0], width + self.padding[1]
        self.spectrum = packed(transfer(*whole, max(width / CUTOFF, 1)))
        self.clahe = cv2.createCLAHE(2.0, (8, 8))

    def __call__(self, rgb):
        height, width = self.size
        gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        log = cv2.log(gray.astype(np.float32) * np.float32(1 / 255) + np.float32(EPS))
        bottom, right = self.padding
        log = cv2.copyMakeBorder(log, 0, bottom, 0, right, cv2.BORDER_REFLECT_101)
        filtered = cv2.mulSpectrums(cv2.dft(log, nonzeroRows=log.shape[0]), self.spectrum, 0)
        filtered = cv2.idft(filtered, flags=cv2.DFT_SCALE | cv2.DFT_REAL_OUTPUT)[:height, :width]
        filtered = cv2.convertScaleAbs(cv2.exp(filtered), alpha=255)
        luma = self.clahe.apply(cv2.medianBlur(filtered, 5))
        shift = cv2.subtract(luma, gray, dtype=cv2.CV_16S)
        return cv2.add(rgb, cv2.merge([shift, shift, shift]), dtype=cv2.CV_8U)


class Plain:
    """As it is usually written: complex transform of the picture's own size, filter made on the way."""

    name = "NumPy and OpenCV, plain"

    def __init__(self, height, width):
        self.size = height, width

    def __call__(self, rgb):
        height, width = self.size
        yuv = cv2.cvtColor(rgb, cv2.COLOR_RGB2YUV)
        log = np.log(yuv[:, :, 0] / 255.0 + EPS)
        spectrum = np.fft.fft2(log) * transfer(height, width, max(width / CUTOFF, 1))
        filtered = np.exp(np.minimum(np.real(np.fft.ifft2(spectrum)), 0))
        filtered = np.uint8(255 * filtered + 0.5)
        clahe = cv2.createCLAHE(2.0, (8, 8))
        yuv[:, :, 0] = clahe.apply(cv2.medianBlur(filtered, 5))
        return cv2.cvtColor(yuv, cv2.COLOR_YUV2RGB)


class Fathom:
    """The program beside, asked for some runs at a time."""

    name = "Fathom"

    def __init__(self, program, source, result):
        pipe = subprocess.PIPE
        self.process = subprocess.Popen([program, source, result], stdin=pipe, stdout=pipe, text=True)

    def run(self):
        self.process.stdin.write(f"{RUNS}\n")
        self.process.stdin.flush()
        return statistics.median(float(time) for time in self.process.stdout.readline().split())

    def stop(self):
        self.process.stdin.close()
        self.process.wait()


def timed(function, rgb):
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        function(rgb)
        times.append(1e3 * (time.perf_counter() - start))
    return statistics.median(times)


def machine():
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
        model = named[0] if named else model
    except OSError:
        pass
    load = os.getloadavg()[0]
    return f"{model}, {os.cpu_count()} cores, load {load:.1f}; OpenCV {cv2.__version__}, NumPy {np.__version__}"


def compare(program, rounds, width, height):
    rgb = picture(width, height)
    with tempfile.TemporaryDirectory() as folder:
        source, result = os.path.join(folder, "source.png"), os.path.join(folder, "result.png")
        cv2.imwrite(source, cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
        fathom, others = Fathom(program, source, result), [Tuned(height, width), Plain(height, width)]
        times = {one.name: [] for one in [fathom, *others]}
        for turn in range(rounds + 1):
            row = {fathom.name: fathom.run(), **{other.name: timed(other, rgb) for other in others}}
            if turn >= 1:  # the first round only warms up
                for name, value in row.items():
                    times[name].append(value)
        fathom.stop()
        ours = cv2.cvtColor(cv2.imread(result), cv2.COLOR_BGR2RGB).astype(int)
        differences = {other.name: np.abs(other(rgb).astype(int) - ours).mean() for other in others}

    print(f"\nHSCM at {width}x{height}, one thread, {rounds} rounds of {RUNS} in turns")
    print(f"{'':26}{'median ms':>10}{'least ms':>10}{'ours / it':>11}{'mean difference, codes':>24}")
    for name, values in times.items():
        ratio = statistics.median(mine / it for mine, it in zip(times[fathom.name], values))
        apart = f"{differences[name]:.2f}" if name in differences else ""
        print(f"{name:26}{statistics.median(values):10.2f}{min(values):10.2f}{ratio:11.3f}{apart:>24}")


def main():
    program, rounds = sys.argv[1], int(sys.argv[2])
    cv2.setNumThreads(1)
    print(machine())
    for width, height in SIZES:
        compare(program, rounds, width, height)


if __name__ == "__main__":
    main()
