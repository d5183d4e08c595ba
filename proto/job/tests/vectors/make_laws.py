#!/usr/bin/env python3
"""Writes laws.json, the known answers for the laws of a job: python3 make_laws.py > laws.json

Independent of the Rust code: Philox4x32-10 from its paper (Salmon et al. 2011), the normal quantile from AS 241
(Wichura 1988), hashing from the standard library. `bits` and `u` are exact, and so are values of uniform, int and
choice; log_uniform and normal go through this machine's log and exp, which may differ by units in the last place.
"""
import hashlib
import json
import math
import statistics
import struct

MASK = 0xFFFFFFFF


def philox4x32_10(counter, key):
    counter, key = list(counter), list(key)
    for _ in range(10):
        a = 0xD2511F53 * counter[0]
        b = 0xCD9E8D57 * counter[2]
        counter = [(b >> 32) ^ counter[1] ^ key[0], b & MASK, (a >> 32) ^ counter[3] ^ key[1], a & MASK]
        key = [(key[0] + 0x9E3779B9) & MASK, (key[1] + 0xBB67AE85) & MASK]
    return counter


def law_bits(seed, pointer, index):
    digest = hashlib.sha256(b"fathom-law-v1" + struct.pack("<Q", seed) + pointer.encode("utf-8")).digest()
    key = struct.unpack("<2I", digest[:8])
    words = philox4x32_10([index & MASK, index >> 32, 0, 0], key)
    return words[0] | words[1] << 32


CENTRE = (
    [2.5090809287301226727e3, 3.3430575583588128105e4, 6.7265770927008700853e4, 4.5921953931549871457e4,
     1.3731693765509461125e4, 1.9715909503065514427e3, 1.3314166789178437745e2, 3.3871328727963666080e0],
    [5.2264952788528545610e3, 2.8729085735721942674e4, 3.9307895800092710610e4, 2.1213794301586595867e4,
     5.3941960214247511077e3, 6.8718700749205790830e2, 4.2313330701600911252e1, 1.0])
SHOULDER = (
    [7.74545014278341407640e-4, 2.27238449892691845833e-2, 2.41780725177450611770e-1, 1.27045825245236838258e0,
     3.64784832476320460504e0, 5.76949722146069140550e0, 4.63033784615654529590e0, 1.42343711074968357734e0],
    [1.05075007164441684324e-9, 5.47593808499534494600e-4, 1.51986665636164571966e-2, 1.48103976427480074590e-1,
     6.89767334985100004550e-1, 1.67638483018380384940e0, 2.05319162663775882187e0, 1.0])
TAIL = (
    [2.01033439929228813265e-7, 2.71155556874348757815e-5, 1.24266094738807843860e-3, 2.65321895265761230930e-2,
     2.96560571828504891230e-1, 1.78482653991729133580e0, 5.46378491116411436990e0, 6.65790464350110377720e0],
    [2.04426310338993978564e-15, 1.42151175831644588870e-7, 1.84631831751005468180e-5, 7.86869131145613259100e-4,
     1.48753612908506148525e-2, 1.36929880922735805310e-1, 5.99832206555887937690e-1, 1.0])


def horner(coefficients, r):
    total = 0.0
    for coefficient in coefficients:
        total = total * r + coefficient
    return total


def normal_quantile(p):
    q = p - 0.5
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        return horner(CENTRE[0], r) * q / horner(CENTRE[1], r)
    r = math.sqrt(-math.log(p if q < 0 else 1.0 - p))
    table, r = (SHOULDER, r - 1.6) if r <= 5.0 else (TAIL, r - 5.0)
    z = horner(table[0], r) / horner(table[1], r)
    return -z if q < 0 else z


def uniform(u, a, b):
    return min(a + (b - a) * u, b)


def log_uniform(u, a, b):
    la, lb = math.log(a), math.log(b)
    return min(max(math.exp(la + (lb - la) * u), a), b)


def integer(u, a, b):
    return min(a + math.floor(u * (float(b - a) + 1.0)), b)


def normal(u, mean, sd, low, high):
    z = normal_quantile(min(u + 2.0**-54, 1.0 - 2.0**-53))
    return min(max(mean + sd * z, low), high)


def choice(u, weights):
    target, total = u * sum(weights), 0.0
    for position, weight in enumerate(weights):
        total += weight
        if total > target:
            return position
    return 0


def value(law, u):
    if "uniform" in law:
        return uniform(u, *law["uniform"])
    if "log_uniform" in law:
        return log_uniform(u, *law["log_uniform"])
    if "int" in law:
        return integer(u, *law["int"])
    if "normal" in law:
        return normal(u, *law["normal"], *law["clip"])
    return law["choice"][choice(u, law.get("weights", [1.0] * len(law["choice"])))]


def self_check():
    assert philox4x32_10([0] * 4, [0] * 2) == [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]
    assert philox4x32_10([MASK] * 4, [MASK] * 2) == [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD]
    standard = statistics.NormalDist()
    for k in range(1, 1000):
        assert math.isclose(normal_quantile(k / 1000), standard.inv_cdf(k / 1000), rel_tol=1e-14, abs_tol=1e-16)


SEEDS = [0, 42, 2**53 + 1, 2**64 - 1]
INDICES = [0, 1, 2, 63, 99_999_999]
PLACES = [
    ("/alpha", {"uniform": [0.0, 1.0]}),
    ("/water/range_scale", {"uniform": [0.5, 2.0]}),
    ("/labels/offset", {"uniform": [-0.1, 0.3]}),
    ("/fidelity/tolerance", {"log_uniform": [1e-5, 1e-2]}),
    ("/water/optics/beam_attenuation_per_m/0", {"log_uniform": [0.03, 3.0]}),
    ("/scene/seed", {"int": [0, 1_000_000]}),
    ("/labels/shift", {"int": [-3, 3]}),
    ("/labels/wide", {"int": [0, 2**53 - 1]}),
    ("/lights/0/intensity", {"normal": [0.8, 0.1], "clip": [0.0, 1.0]}),
    ("/labels/tail", {"normal": [0.0, 1.0], "clip": [-10.0, 10.0]}),
    ("/labels/narrow", {"normal": [5.0, 2.0], "clip": [4.0, 4.5]}),
    ("/water/style", {"choice": ["atlantic", "mediterranean", "muddy"], "weights": [1.0, 1.0, 2.0]}),
    ("/water/optics", {"choice": ["jerlov-1C", "jerlov-5C", "jerlov-9C"]}),
    ("/labels/rare", {"choice": ["never", "often", "seldom"], "weights": [0.0, 0.9, 0.1]}),
    ("/water/choice/1/range_scale", {"uniform": [0.5, 2.0]}),
    ("/labels/name~1with~0signs", {"uniform": [0.0, 1.0]}),
    ("/labels/größe", {"uniform": [0.0, 1.0]}),
]


def main():
    self_check()
    vectors = []
    for pointer, law in PLACES:
        for seed in SEEDS:
            for index in INDICES:
                bits = law_bits(seed, pointer, index)
                u = (bits >> 11) * 2.0**-53
                vectors.append({"seed": seed, "pointer": pointer, "law": law, "index": index,
                                "bits": f"{bits:016x}", "u": u, "value": value(law, u)})
    print("[\n" + ",\n".join(json.dumps(vector, ensure_ascii=False) for vector in vectors) + "\n]")


main()
