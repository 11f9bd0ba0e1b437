"""Error model, gauge, sigma_T and window: eq. (1) to (8), (11) to (16)."""

import numpy as np
from common import REF_B, REF_M6, directions, symmetric, write

SEED = 20240602


def composed(rng):
    """(7), (8): M = S C A, b = S C b_m + b_0, C the inverse of the columns' matrix."""
    scale = rng.uniform(0.8, 1.2, 3)
    axes = np.eye(3) + rng.uniform(-0.08, 0.08, (3, 3))
    axes /= np.linalg.norm(axes, axis=0)
    a = symmetric(np.concatenate([rng.uniform(0.85, 1.15, 3), rng.uniform(-0.1, 0.1, 3)]))
    offset, hard = rng.uniform(-300, 300, 3), rng.uniform(-300, 300, 3)
    h = rng.uniform(-40, 40, 3)
    # the chain of (1) to (6) applied to one field, each step by itself
    disturbed = a @ h + hard
    raw = scale * np.linalg.solve(axes, disturbed) + offset
    columns = [scale * np.linalg.solve(axes, a[:, k]) for k in range(3)]
    return {
        "scale": scale,
        "axes": axes,
        "offset_ut": offset,
        "disturbance_soft_iron": a,
        "disturbance_hard_iron_ut": hard,
        "m": np.stack(columns, axis=1),
        "b_ut": scale * np.linalg.solve(axes, hard) + offset,
        "field_ut": h,
        "raw_ut": raw,
    }


def polar(rng, spread):
    """M = P R by the singular value decomposition: P = U s U^T, R = U V^T."""
    while True:
        m = np.eye(3) + rng.uniform(-spread, spread, (3, 3))
        if np.linalg.det(m) > 0.05:
            break
    u, s, vt = np.linalg.svd(m)
    return {"m": m, "p": u @ np.diag(s) @ u.T, "r": u @ vt}


def corrected(rng):
    m = symmetric(np.array(REF_M6) + rng.uniform(-0.03, 0.03, 6))
    b = np.array(REF_B) * 50 + rng.uniform(-500, 500, 3)
    h = rng.uniform(-40, 40, 3)
    return {"m": m, "b_ut": b, "field_ut": h, "raw_ut": m @ h + b}


def sigma_t(name, vectors):
    """(12) to (15), angles in degrees."""
    h = np.asarray(vectors)
    u = h / np.linalg.norm(h, axis=1, keepdims=True)
    theta = np.degrees(np.arccos(np.clip(u[:, 2], -1, 1)))
    phi = np.degrees(np.arctan2(u[:, 1], u[:, 0]))
    even_phi, even_theta = 180 / np.sqrt(3), np.degrees(np.sqrt(np.pi**2 / 4 - 2))
    half = np.hypot(phi.std() / 180, theta.std() / 90)
    even = np.hypot(phi.std() / even_phi, theta.std() / even_theta) / np.sqrt(2)
    window = {}
    for key, value in [("half_range", half), ("even_sphere", even)]:
        n = 2000 - (2000 - 100) * value
        window[key] = int(min(max(np.floor(n + 0.5), 100), 2000))
    return {"name": name, "field_ut": np.round(h, 6), "half_range": half, "even_sphere": even, "window": window}


def main():
    rng = np.random.default_rng(SEED)
    around = rng.uniform(-np.pi, np.pi, 60)
    sets = [
        ("even, random", 50 * directions(rng, 100)),
        ("about z, flat", np.stack([30 * np.cos(around), 30 * np.sin(around), -40 + 0 * around], axis=1)),
        ("narrow", np.array([20.0, 5.0, -40.0]) + rng.normal(size=(100, 3))),
        ("across the cut of the azimuth", np.array([-40.0, 0.0, 10.0]) + 3 * rng.normal(size=(50, 3))),
        ("pitching", np.stack([50 * np.cos(around / 3), 0 * around + 0.001, 50 * np.sin(around / 3)], axis=1)),
    ]
    body = {
        "compose": [composed(rng) for _ in range(8)],
        "polar": [polar(rng, s) for s in (0.05, 0.2, 0.5, 0.9, 0.9, 0.9)],
        "correct": [corrected(rng) for _ in range(8)],
        "sigma_t": [sigma_t(name, np.round(h, 6)) for name, h in sets],
    }
    write("model.json", "model.py", SEED, "error model, gauge, sigma_T; n_min 100, n_max 2000", body)


if __name__ == "__main__":
    main()
