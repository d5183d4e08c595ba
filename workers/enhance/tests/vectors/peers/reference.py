"""The compared methods, written a second time in NumPy from their formulas alone: the source of the pictures beside.

Usage: reference.py INPUT.png... (needs numpy and opencv-python-headless, the latter for reading and writing files).
Everything is double precision, every window is summed anew, every quantile comes from a full sort.
"""

import os
import sys

import cv2
import numpy as np

FLAT = 1e-6


def luma(c):
    return (299 * c[..., 0] + 587 * c[..., 1] + 114 * c[..., 2]) / 1000


def windows(z, radius, pad):
    """All shifts of a plane; `pad` fills what lies outside."""
    height, width = z.shape
    padded = np.pad(z, radius, constant_values=pad)
    for dy in range(2 * radius + 1):
        for dx in range(2 * radius + 1):
            yield padded[dy : dy + height, dx : dx + width]


def lmax(z, side):
    return np.maximum.reduce(list(windows(z.astype(float), side // 2, -np.inf)))


def lmin(z, side):
    return np.minimum.reduce(list(windows(z.astype(float), side // 2, np.inf)))


def box(z, radius):
    height, width = z.shape
    out = np.empty_like(z, dtype=float)
    for y in range(height):
        rows = z[max(0, y - radius) : y + radius + 1].sum(axis=0)
        count = min(height, y + radius + 1) - max(0, y - radius)
        for x in range(width):
            columns = slice(max(0, x - radius), x + radius + 1)
            out[y, x] = rows[columns].sum() / (count * len(rows[columns]))
    return out


def guided(guide, p, radius=50, e=1e-3):
    mean_i = np.stack([box(guide[..., i], radius) for i in range(3)], -1)
    mean_p = box(p, radius)
    sigma, cov = np.empty(p.shape + (3, 3)), np.empty(p.shape + (3,))
    for i in range(3):
        cov[..., i] = box(guide[..., i] * p, radius) - mean_i[..., i] * mean_p
        for j in range(3):
            sigma[..., i, j] = box(guide[..., i] * guide[..., j], radius) - mean_i[..., i] * mean_i[..., j]
    a = np.linalg.solve(sigma + e * np.eye(3), cov[..., None])[..., 0]
    b = mean_p - (a * mean_i).sum(-1)
    return sum(box(a[..., i], radius) * guide[..., i] for i in range(3)) + box(b, radius)


def norm(z):
    low, high = z.min(), z.max()
    return (z - low) / (high - low) if high - low > FLAT else np.zeros_like(z)


def sig(a, d):
    return 1 / (1 + np.exp(-32 * (a - d)))


def codes(unit):
    return np.clip(np.floor(255 * unit + 0.5), 0, 255).astype(np.uint8)


def offset(c, light):
    return 1 - max((np.abs(light[i] - c[..., i]) / max(light[i], 1 - light[i])).max() for i in range(3))


def top(d, count):
    # Differences below 1e-9 are rounding: windows with the same content tie.
    rank = np.round((d.max() - d.ravel()) * 2**30)
    return np.lexsort((np.arange(d.size), rank))[:count]


def ulap(rgb):
    c = rgb / 255
    d = 0.53214829 + 0.51309827 * np.maximum(c[..., 1], c[..., 2]) - 0.91066194 * c[..., 0]
    d = guided(c, d)
    far = top(d, int(np.ceil(0.001 * d.size)))
    pixels = rgb.reshape(-1, 3).astype(int)[far]
    light = pixels[np.argmax((pixels**2).sum(1))] / 255
    distance = 10 * (norm(d) + offset(c, light))
    t = np.stack([np.clip(n**distance, 0.1, 0.9) for n in (0.83, 0.95, 0.97)], -1)
    return codes((c - light) / t + light)


def gaussian(g, radius):
    sigma = 2 * radius + 1
    weights = np.exp(-np.arange(-radius, radius + 1) ** 2 / (2 * sigma**2))
    weights = np.outer(weights, weights) / weights.sum() ** 2
    height, width = g.shape
    padded = np.pad(g, radius, mode="edge")
    out = np.zeros_like(g)
    for dy in range(2 * radius + 1):
        for dx in range(2 * radius + 1):
            out += weights[dy, dx] * padded[dy : dy + height, dx : dx + width]
    return out


def fill(z):
    inside = np.zeros(z.shape, bool)
    inside[1:-1, 1:-1] = True
    u = np.where(inside, z.max(), z)
    while True:
        least = np.minimum.reduce(list(windows(u, 1, np.inf)))
        lower = np.where(inside, np.maximum(z, least), z)
        if (lower == u).all():
            return u
        u = lower


def quadtree(shape, score):
    y, x, h, w = 0, 0, *shape
    while (h - 1) * (w - 1) > shape[0] * shape[1] // 1024:
        top_h, left_w = min(h // 2 + 1, h), min(w // 2 + 1, w)
        quarters = [
            (y, x, top_h, left_w),
            (y, x + left_w, top_h, w - left_w),
            (y + top_h, x, h - top_h, left_w),
            (y + top_h, x + left_w, h - top_h, w - left_w),
        ]
        quarters = [quarter for quarter in quarters if quarter[2] * quarter[3] > 0]
        if len(quarters) == 1:
            break
        best = None
        for quarter in quarters:
            a, b, c, d = quarter
            value = score(slice(a, a + c), slice(b, b + d))
            if best is None or value < best[0] - 1e-9:
                best = (value, quarter)
        y, x, h, w = best[1]
    return slice(y, y + h), slice(x, x + w)


def ibla_guided(rgb):
    c = rgb / 255
    g = luma(c)
    blur = sum(np.abs(g - gaussian(g, 2**i * 2)) for i in range(1, 5)) / 4
    p_r = fill(lmax(blur, 7))
    p_b = guided(c, p_r)
    flat = c.reshape(-1, 3)
    thousandths = 299 * rgb[..., 0].astype(int) + 587 * rgb[..., 1].astype(int) + 114 * rgb[..., 2].astype(int)
    candidates = np.stack(
        [
            flat[top(-p_b, max(1, g.size // 1000))].mean(0),
            c[quadtree(g.shape, lambda r, s: thousandths[r, s].astype(float).var())].reshape(-1, 3).mean(0),
            c[quadtree(g.shape, lambda r, s: p_b[r, s].mean())].reshape(-1, 3).mean(0),
        ]
    )
    s = np.array([sig((c[..., i] > 0.5).mean(), 0.2) for i in range(3)])
    light = s * candidates.max(0) + (1 - s) * candidates.min(0)
    red = lmax(c[..., 0], 7)
    e_r = norm(red)
    e_d = norm(red - lmax(np.maximum(c[..., 1], c[..., 2]), 7))
    tb, ta = sig(c[..., 0].mean(), 0.1), sig(light.mean(), 0.5)
    e = guided(c, tb * (ta * e_d + (1 - ta) * e_r) + (1 - tb) * norm(p_r))
    away = np.abs(c - light)
    k = int(np.argmax(away.reshape(-1, 3).max(0)))
    near = 1 - away[..., k].max() / max(light[k], 1 - light[k])
    distance = 8 * (1 - e + near)
    m = [-0.00113 * wave + 1.62517 for wave in (620, 540, 450)]
    f = np.maximum(light, 0.1)
    b = [1 / 7] + [f[0] * m[i] / (7 * f[i] * m[0]) for i in (1, 2)]
    t = np.maximum(np.stack([np.exp(-b_k * distance) for b_k in b], -1), 0.1)
    return codes((c - light) / t + light)


def brightness(c):
    y = luma(c)
    red = np.clip(0.713 * (c[..., 0] - y) + 0.5, 0, 1)
    blue = np.clip(0.564 * (c[..., 2] - y) + 0.5, 0, 1)
    low, high = min(y.min(), red.min(), blue.min()), max(y.max(), red.max(), blue.max())
    return np.clip((y - low) / (high - low) if high - low > FLAT else y, 0.01, 1)


def suir(rgb):
    low, high = int(rgb.min()), int(rgb.max())
    c = (rgb.astype(float) - low) / (high - low) if high > low else rgb / 255
    difference = lmax(rgb[..., 0], 9) - lmax(np.maximum(rgb[..., 1], rgb[..., 2]), 9)
    light = np.maximum(c.reshape(-1, 3)[np.argmin(difference.ravel())], 1 / 255)
    restored = []
    for k in (1, 2):
        least = np.minimum.reduce(list(windows(c[..., k] / light[k], 4, 0)))
        t = np.clip(guided(c, 1 - least), 0.1, 0.9)
        restored.append((c[..., k] - light[k]) / t + light[k])
    joint = np.stack([c[..., 0], *restored])
    if joint.max() - joint.min() > FLAT:
        joint = (joint - joint.min()) / (joint.max() - joint.min())
    red = c[..., 0]
    if red.max() - red.min() > FLAT:
        red = (red - red.min()) / (red.max() - red.min())
    result = np.stack([red, joint[1], joint[2]], -1)
    y_i, y_j = brightness(c), brightness(result)
    s = guided(c, (y_j * y_i + 0.3 * y_i**2) / (y_j**2 + 0.3 * y_i**2))
    return codes(np.clip(result * s[..., None], 0, 1))


def rayleigh(share):
    if share >= 1:
        return 255.0
    a2 = 0.4**2
    rest = 1 - (1 - np.exp(-1 / (2 * a2))) * share
    return float(np.trunc(min(255, 255 * np.sqrt(-2 * a2 * np.log(rest)))))


def tails(z, p):
    ordered = np.sort(z.ravel())
    k = len(ordered)
    return ordered[int(p * k)], ordered[k - 1 - int(p * k)]


def rd(rgb):
    v = rgb.astype(float)
    means = v.reshape(-1, 3).mean(0)
    low, mid, high = np.sort(means)
    first, last = int(np.argmin(means)), int(np.argmax(means))
    if low > 0:
        v[..., first] *= mid / low
    if mid > 0 and high > 0:
        v[..., last] *= mid / high
    v = np.clip(v, 0, 255)
    for i in range(3):
        z = v[..., i]
        if z.max() <= z.min():
            continue
        z = (z - z.min()) / (z.max() - z.min()) * 255
        lower = z <= z.mean() + 1e-9
        merged = np.empty_like(z)
        for chosen, other in ((lower, 0.0), (~lower, 255.0)):
            whole = np.trunc(z[chosen] + 1e-9)
            for value in np.unique(whole):
                share = (whole <= value).sum() / len(whole)
                merged[chosen & (np.trunc(z + 1e-9) == value)] = (rayleigh(share) + other) / 2
        v[..., i] = merged
    v /= 255
    value, least = v.max(-1), v.min(-1)
    saturation = np.where(value > 0, (value - least) / np.where(value > 0, value, 1), 0)

    def stretch(z):
        a, b = tails(z, 0.01)
        inside = (z >= a) & (z <= b)
        return np.where(inside, (z - a) / (b - a), z) if b > a else z

    new_s, new_v = stretch(saturation), stretch(value)
    spread = (value - least)[..., None]
    share = np.where(spread > 0, (value[..., None] - v) / np.where(spread > 0, spread, 1), 0)
    return codes(new_v[..., None] * (1 - new_s[..., None] * share))


XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = np.array([0.95047, 1, 1.08883])


def rghs(rgb):
    v = rgb.astype(float)
    if any(np.ptp(v[..., i]) > 0 for i in range(3)):
        for i, (k, n) in enumerate(((1.1, 0.83), (0.9, 0.95), (0.9, 0.97))):
            z = v[..., i]
            if i > 0 and z.mean() > 0:
                z = np.clip(z * (0.5 * 255 / z.mean()), 0, 255)
            z = np.floor(z + 0.5)
            ordered = np.sort(z.ravel())
            values, counts = np.unique(ordered, return_counts=True)
            mode = values[np.argmax(counts)]
            left, right = ordered[ordered < mode], ordered[ordered >= mode]
            low = left[int(0.005 * len(left))] if len(left) else mode
            high = right[len(right) - 1 - int(0.005 * len(right))]
            o_min, o_max = 0.0, 255.0
            if mode > 0:
                o_min = mode - 0.655 * mode
                kt = k * n**3
                steps = np.floor((255 - high) * kt / mode)
                if steps >= 1:
                    o_max = (1.526 + (steps + 1) / 2) * mode / kt
                o_max = min(max(o_max, high), 255)
            v[..., i] = np.clip(o_min + (z - low) * (o_max - o_min) / (high - low), 0, 255) if high > low else z
    v /= 255
    l, a, b = np.moveaxis(to_lab(v), -1, 0)
    low, high = tails(l, 0.01)
    if high > low + FLAT:
        l = 100 * np.clip((l - low) / (high - low), 0, 1)
    a, b = (p * 1.3 ** (1 - np.abs(p) / 128) for p in (a, b))
    return codes(from_lab(l, a, b))


def dark(rgb, scales, omega_set, radius=7):
    return np.minimum.reduce([lmin(rgb[..., i] / scales[i], 2 * radius + 1) for i in omega_set])


def haze_removal(rgb, omega_set):
    c = rgb / 255
    depth = dark(rgb, (1, 1, 1), omega_set)
    far = top(depth, int(np.ceil(0.001 * depth.size)))
    pixels = rgb.reshape(-1, 3).astype(int)[far]
    light = np.maximum(pixels[np.argmax((pixels**2).sum(1))], 1) / 255
    t = np.clip(guided(c, 1 - 0.95 * dark(c, light, omega_set)), 0.1, 1)[..., None]
    return codes((c - light) / t + light)


def dcp(rgb):
    return haze_removal(rgb, (0, 1, 2))


def udcp(rgb):
    return haze_removal(rgb, (1, 2))


BINOMIAL = np.outer((1, 4, 6, 4, 1), (1, 4, 6, 4, 1)) / 256


def binomial(z):
    height, width = z.shape
    padded = np.pad(z, 2, mode="edge")
    return sum(BINOMIAL[i, j] * padded[i : i + height, j : j + width] for i in range(5) for j in range(5))


def each(function, c):
    return np.stack([function(c[..., i]) for i in range(3)], -1)


def to_lab(v):
    linear = np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)
    t = linear @ XYZ.T / WHITE
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], -1)


def from_lab(l, a, b):
    y = (l + 16) / 116
    f = np.stack([y + a / 500, y, y - b / 200], -1)
    t = np.where(f > 6 / 29, f**3, 3 * (6 / 29) ** 2 * (f - 4 / 29)) * WHITE
    linear = np.clip(t @ np.linalg.inv(XYZ).T, 0, 1)
    return np.where(linear <= 0.04045 / 12.92, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def fusion_weight(c):
    y = luma(c)
    padded = np.pad(y, 1, mode="edge")
    neighbors = padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]
    color = to_lab(c)
    saliency = np.linalg.norm(each(binomial, color) - color.reshape(-1, 3).mean(0), axis=-1)
    saturation = np.sqrt(((c - y[..., None]) ** 2).mean(-1))
    return np.abs(4 * y - neighbors) + saliency / 100 + saturation


def halve(z):
    return binomial(z)[::2, ::2]


def double(z, shape):
    """Zeros between the samples of the padded plane, blurred with four times the weights."""
    padded = np.pad(z, 1, mode="edge")
    sparse = np.zeros((2 * padded.shape[0], 2 * padded.shape[1]))
    sparse[::2, ::2] = 4 * padded
    return binomial(sparse)[2 : 2 + shape[0], 2 : 2 + shape[1]]


def fusion(rgb, red_gain=1.0, gamma=1.2, most=5):
    c = rgb / 255
    means = c.reshape(-1, 3).mean(0)
    c[..., 0] += red_gain * max(means[1] - means[0], 0) * (1 - c[..., 0]) * c[..., 1]
    c = np.minimum(c, 1)
    means = c.reshape(-1, 3).mean(0)
    c = np.minimum(c * np.where(means > 0, means.mean() / np.where(means > 0, means, 1), 1), 1)
    detail = c - each(binomial, c)
    span = np.ptp(detail)
    inputs = [c**gamma, (c + (detail - detail.min()) / span) / 2 if span > FLAT else c]
    weights = [fusion_weight(one) + 0.1 for one in inputs]
    levels = min(most, 1 + int(np.log2(min(rgb.shape[:2]))))
    result = np.zeros_like(c)
    for one, weight in zip(inputs, weights):
        share = [weight / sum(weights)]
        planes = [[one[..., i]] for i in range(3)]
        for pyramid in (share, *planes):
            while len(pyramid) < levels:
                pyramid.append(halve(pyramid[-1]))
        for i, pyramid in enumerate(planes):
            total = share[-1] * pyramid[-1]
            for level in range(levels - 2, -1, -1):
                shape = pyramid[level].shape
                layer = pyramid[level] - double(pyramid[level + 1], shape)
                total = double(total, shape) + share[level] * layer
            result[..., i] += total
    return codes(result)


def mlle(rgb, gamma=1.2, radius=12, most=2.0, e=1e-4):
    c = rgb / 255
    sums = rgb.reshape(-1, 3).astype(int).sum(0)
    means = c.reshape(-1, 3).mean(0)
    largest = int(np.argmax(sums))

    def stretch(z):
        return (z - z.min()) / np.ptp(z) if np.ptp(z) > 0 else z

    moved = c.copy()
    others = [i for i in range(3) if sums[i] < sums[largest]]
    for i in set(range(3)) - set(others):
        moved[..., i] = stretch(c[..., i])
    reached = moved[..., largest].mean()
    while sum(abs(reached - means[i]) for i in others) > 0.01 and reached > 0:
        for i in others:
            moved[..., i] += (reached - means[i]) * moved[..., largest]
            means[i] += (reached - means[i]) * reached
    attenuation = (1 - c**gamma).max(-1)[..., None]
    c = np.clip(c - each(binomial, c) + attenuation * moved + (1 - attenuation) * c, 0, 1)
    color = to_lab(c)
    l = color[..., 0] / 100
    mean = box(l, radius)
    variance = np.maximum(box(l * l, radius) - mean**2, 0)
    whole = ((l - l.mean()) ** 2).mean()
    gain = np.where(variance * most > whole, whole / np.where(variance > 0, variance, 1), most)
    expanded = mean + gain * (l - mean)
    slope = (box(l * expanded, radius) - mean * box(expanded, radius)) / (variance + e)
    offset = box(expanded, radius) - slope * mean
    l = 100 * np.clip(box(slope, radius) * l + box(offset, radius), 0, 1)
    a, b = color[..., 1] + 128, color[..., 2] + 128
    ratio = abs(a.mean() - b.mean()) / (a.mean() + b.mean())
    if a.mean() < b.mean():
        a = a * (1 + ratio)
    else:
        b = b * (1 + ratio)
    return codes(from_lab(l, a - 128, b - 128))


def main():
    folder = os.path.dirname(os.path.abspath(__file__))
    for path in sys.argv[1:]:
        name = os.path.basename(path).split(".")[0]
        rgb = cv2.cvtColor(cv2.imread(path), cv2.COLOR_BGR2RGB)
        for method in (ulap, ibla_guided, suir, rd, rghs, dcp, udcp, fusion, mlle):
            result = cv2.cvtColor(method(rgb), cv2.COLOR_RGB2BGR)
            cv2.imwrite(os.path.join(folder, f"{name}.{method.__name__}.png"), result)


if __name__ == "__main__":
    main()
