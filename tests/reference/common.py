"""What the reference scripts share: parameter sets, directions, extended-precision algebra, writing vectors.

Independent of the Rust code: written from the paper's equations, numpy alone.
"""

import json
from pathlib import Path

import numpy as np

LD = np.longdouble
VECTORS = Path(__file__).resolve().parent.parent / "vectors"
ORDER = ["b_x", "b_y", "b_z", "m_xx", "m_yy", "m_zz", "m_xy", "m_xz", "m_yz"]
PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]

# [Mxx, Myy, Mzz, Mxy, Mxz, Myz], [bx, by, bz] in field strengths: the reference set REF
REF_M6 = [1.05, 0.95, 1.00, 0.06, -0.05, 0.08]
REF_B = [0.30, -0.20, 1.32]


def symmetric(m6):
    m = np.zeros((3, 3), dtype=np.asarray(m6).dtype)
    for value, (i, j) in zip(m6, PAIRS):
        m[i, j] = m[j, i] = value
    return m


def six(m):
    return np.array([m[i, j] for i, j in PAIRS])


def directions(rng, count):
    """Even on the sphere, at random."""
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def fibonacci(count):
    """Even on the sphere, by rule: z_k = 1 - (2 k + 1) / n, phi_k = k pi (3 - sqrt 5)."""
    k = np.arange(count)
    z = 1 - (2 * k + 1) / count
    phi = k * np.pi * (3 - np.sqrt(5.0))
    flat = np.sqrt(1 - z * z)
    return np.stack([flat * np.cos(phi), flat * np.sin(phi), z], axis=1)


def solve(a, y):
    """a x = y by elimination with row pivots in extended precision (LAPACK has none)."""
    a, y = np.array(a, dtype=LD), np.array(y, dtype=LD)
    n = len(y)
    for i in range(n):
        pivot = i + int(np.argmax(np.abs(a[i:, i])))
        a[[i, pivot]], y[[i, pivot]] = a[[pivot, i]], y[[pivot, i]]
        for k in range(i + 1, n):
            factor = a[k, i] / a[i, i]
            a[k, i:] -= factor * a[i, i:]
            y[k] -= factor * y[i]
    x = np.zeros(n, dtype=LD)
    for i in reversed(range(n)):
        x[i] = (y[i] - a[i, i + 1 :] @ x[i + 1 :]) / a[i, i]
    return x


def plain(value):
    """Numbers as JSON writes them: doubles, shortest form that reads back exactly."""
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(list(value))
    if isinstance(value, (np.integer,)):
        return int(value)
    if isinstance(value, (np.floating,)):
        return float(value)
    return value


def write(name, script, seed, about, body):
    VECTORS.mkdir(exist_ok=True)
    head = {"script": f"tests/reference/{script}", "seed": seed, "about": about}
    text = json.dumps(plain({**head, **body}), allow_nan=False, separators=(",", ":"))
    # one case a line, so that a changed vector shows in a diff
    text = text.replace("},{", "},\n{")
    (VECTORS / name).write_text(text + "\n")
    print(f"{name}: {len(text)} bytes")
