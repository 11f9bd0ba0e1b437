"""Ellipsoid fits, sample by sample: eq. (10) as written, and its noise-bias-corrected form.

Parameters here are T = M^-1 / |h| (symmetric) and b, as the paper has them.

Algebraic: minimise sum (|T (h_m - b)|^2 - 1)^2, by Gauss-Newton with Levenberg's damping over the samples, in
extended precision, until a step changes nothing.

Corrected: minimise p^T S p / p^T N p over the quadrics d.p = 0, d = [x^2, y^2, z^2, 2xy, 2xz, 2yz, x, y, z, 1],
S = sum d d^T, N = sum (grad d)(grad d)^T + d c^T + c d^T, c = [1, 1, 1, 0, ...] (half the Laplacian of d; Kanatani's
hyper least squares): the generalised eigenproblem S p = lambda N p with the smallest positive lambda, by LAPACK and then
Rayleigh quotient iteration in extended precision.

Covariance of what both minimise, all samples weighing alike: H^-1 (s^2 sum |grad r|^2 j j^T) H^-1, H = sum j j^T, j by
central differences of every sample's residual r = |T (h_m - b)|^2 - 1 at the sample's foot point; s from the rms distance
with N - 9 degrees of freedom.
"""

import numpy as np
import scipy.linalg
from common import LD, PAIRS, REF_B, REF_M6, directions, six, solve, symmetric, write

SEED = 20240601


def gauss_newton(u, t, beta):
    """Algebraic fit of u (n x 3, extended precision) from (t, beta)."""

    def residuals(t, beta):
        v = u - beta
        q = v @ t
        return v, q, (q * q).sum(axis=1) - 1

    damping = LD(0)
    v, q, r = residuals(t, beta)
    for _ in range(200):
        jacobian = np.empty((len(u), 9), dtype=LD)
        for k, (i, j) in enumerate(PAIRS):
            jacobian[:, k] = 2 * q[:, i] * v[:, j] if i == j else 2 * (q[:, i] * v[:, j] + q[:, j] * v[:, i])
        jacobian[:, 6:] = -2 * q @ t
        normal = jacobian.T @ jacobian
        step = solve(normal + damping * np.diag(np.diag(normal)), -jacobian.T @ r)
        new = t + symmetric(step[:6]), beta + step[6:]
        trial = residuals(*new)
        size = np.abs(step).max()
        if (trial[2] ** 2).sum() <= (r**2).sum() * (1 + LD(1e-15)):
            (t, beta), (v, q, r), damping = new, trial, damping / 10 if damping > 1e-6 else LD(0)
            if size < 1e-17:
                return t, beta
        elif size < 1e-15:
            return t, beta
        else:
            damping = max(damping * 10, LD(1e-4))
    if size < 1e-14:
        return t, beta
    raise RuntimeError(f"no convergence: {size}")


def scatter(u):
    x, y, z = u.T
    one, zero = np.ones_like(x), np.zeros_like(x)
    d = np.stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z, x, y, z, one], axis=1)
    gradient = [
        np.stack([2 * x, zero, zero, 2 * y, 2 * z, zero, one, zero, zero, zero], axis=1),
        np.stack([zero, 2 * y, zero, 2 * x, zero, 2 * z, zero, one, zero, zero], axis=1),
        np.stack([zero, zero, 2 * z, zero, 2 * x, 2 * y, zero, zero, one, zero], axis=1),
    ]
    c = np.array([1, 1, 1, 0, 0, 0, 0, 0, 0, 0], dtype=LD)
    dc = np.outer(d.sum(axis=0), c)
    return d.T @ d, sum(g.T @ g for g in gradient) + dc + dc.T


def hyper(u):
    """Corrected fit of u: (t, beta)."""
    s, n = scatter(u)
    values, vectors = scipy.linalg.eig(n.astype(float), s.astype(float))
    p = vectors[:, int(np.argmax(np.where(np.isfinite(values), values.real, -np.inf)))].real.astype(LD)
    for _ in range(12):
        quotient = (p @ s @ p) / (p @ n @ p)
        shifted = s - quotient * n
        # a shift that is the eigenvalue to the last bit leaves nothing to eliminate
        shifted = shifted + np.diag(np.diag(s)) * LD(1e-18)
        new = solve(shifted, n @ p)
        new /= np.abs(new).max() * np.sign(new[np.argmax(np.abs(new))])
        p /= np.abs(p).max() * np.sign(p[np.argmax(np.abs(p))])
        done = np.abs(new - p).max() < 1e-17
        p = new
        if done:
            break
    p = p * np.sign(p[:3].sum())
    a, g = symmetric(p[:6]), -p[6:9] / 2
    beta = solve(a, g)
    a = a / (g @ beta - p[9])
    assert np.all(np.linalg.eigvalsh(a.astype(float)) > 0)
    return square_root(a), beta


def square_root(a):
    """Symmetric root of a 3 x 3 matrix: Newton's iteration (Denman and Beavers) in extended precision."""
    y, z = a, np.eye(3, dtype=LD)
    for _ in range(60):
        y, z = (y + inverse(z)) / 2, (z + inverse(y)) / 2
    return (y + y.T) / 2


def inverse(m):
    return np.stack([solve(m, e) for e in np.eye(3, dtype=LD)], axis=1)


def determinant(m):
    return m[0] @ np.cross(m[1], m[2])


def distances(parameters, field, points):
    """(|W (h - b)| - |h|) / |W^T e|: to first order the distance to the ellipsoid, raw units."""
    b, m = parameters[:3], symmetric(parameters[3:])
    w = np.linalg.inv(m)
    q = (points - b) @ w.T
    length = np.linalg.norm(q, axis=1)
    return (length - field) / np.linalg.norm((q / length[:, None]) @ w, axis=1)


def residuals_of_10(parameters, field, points):
    q = (points - parameters[:3]) @ np.linalg.inv(symmetric(parameters[3:])).T
    return (q * q).sum(axis=1) / field**2 - 1


def numerical(function, at, steps):
    columns = []
    for k, step in enumerate(steps):
        e = np.zeros(len(at))
        e[k] = step
        columns.append((function(at + e) - function(at - e)) / (2 * step))
    return np.stack(columns, axis=1)


def covariance(points, m, b, field, known):
    m, b = m.astype(float), b.astype(float)
    parameters = np.concatenate([b, six(m)])
    noise = np.sqrt((distances(parameters, field, points) ** 2).sum() / (len(points) - 9))
    q = (points - b) @ np.linalg.inv(m).T
    feet = b + (q / np.linalg.norm(q, axis=1, keepdims=True) * field) @ m.T
    steps = np.array([1e-4] * 3 + [1e-6] * 6)
    jacobian = numerical(lambda x: residuals_of_10(x, field, feet), parameters, steps)
    w = np.linalg.inv(m)
    slope = 2 * np.linalg.norm(((feet - b) @ w.T) @ w, axis=1) / field**2
    normal = np.linalg.inv(jacobian.T @ jacobian)
    weighted = jacobian * slope[:, None]
    found = noise**2 * normal @ (weighted.T @ weighted) @ normal
    if not known:

        def gauge(x):
            return np.concatenate([x[:3], x[3:] / np.cbrt(np.linalg.det(symmetric(x[3:])))])

        turn = numerical(gauge, parameters, steps)
        found = turn @ found @ turn.T
    return noise, found


def solution(points, t, beta, centre, scale, known_field):
    """M, b and the field strength in both gauges, with the covariance."""
    t_inverse = inverse(t) * scale  # half axes, uT
    b = centre + scale * beta
    answer = {}
    free = np.cbrt(determinant(t_inverse))
    for name, field in [("known_field", LD(known_field)), ("unit_determinant", free)]:
        m = t_inverse / field
        answer[name] = {"field_strength_ut": field, "soft_iron": m, "hard_iron_ut": b}
        if len(points) > 9:
            noise, found = covariance(points, m, b, float(field), name == "known_field")
            answer[name]["noise_ut"] = noise
            answer[name]["covariance"] = found
    return answer


def case(rng, name, count, field, m6, b_ut, snr_db, cap_deg=None, digits=4):
    m, b = symmetric(m6), np.array(b_ut)
    u = directions(rng, count)
    if cap_deg is not None:
        # even on the cap about an oblique axis
        z = 1 - rng.random(count) * (1 - np.cos(np.radians(cap_deg)))
        phi = rng.random(count) * 2 * np.pi
        flat = np.sqrt(1 - z * z)
        axis = np.array([0.6, -0.48, 0.64])
        e1 = np.cross(axis, [0, 0, 1]) / np.linalg.norm(np.cross(axis, [0, 0, 1]))
        u = z[:, None] * axis + (flat * np.cos(phi))[:, None] * e1 + (flat * np.sin(phi))[:, None] * np.cross(axis, e1)
    noise = 0 if snr_db is None else field * 10 ** (-snr_db / 20)
    points = np.round(field * u @ m.T + b + noise * rng.normal(size=(count, 3)), digits)
    extended = points.astype(LD)
    centre, scale = np.array(b, dtype=LD), LD(field)
    v = (extended - centre) / scale
    start = inverse(np.array(m, dtype=LD))
    fits = {
        "algebraic": gauss_newton(v, start, np.zeros(3, dtype=LD)),
        "corrected": hyper(v) if snr_db is not None else gauss_newton(v, start, np.zeros(3, dtype=LD)),
    }
    body = {
        "name": name,
        "known_field_ut": field,
        "true_soft_iron": m,
        "true_hard_iron_ut": b,
        "noise_ut": noise,
        "points_ut": points,
    }
    for residual, (t, beta) in fits.items():
        body[residual] = solution(points, t, beta, centre, scale, field)
    return body


def main():
    rng = np.random.default_rng(SEED)
    ref = np.array(REF_B) * 50
    far = [600.0, -550.0, 420.0]
    cases = [
        case(rng, "nine noise-free points", 9, 50.0, REF_M6, ref, None, digits=9),
        case(rng, "even, 100 samples, 30 dB", 100, 50.0, REF_M6, ref, 30),
        case(rng, "even, 100 samples, 40 dB, offsets of 600 uT", 100, 50.0, REF_M6, far, 40),
        case(rng, "even, 626 samples, 35 dB", 626, 40.0, REF_M6, np.array(REF_B) * 40, 35),
        case(rng, "even, 2000 samples, 30 dB, offsets of 600 uT", 2000, 50.0, REF_M6, far, 30),
        case(rng, "cap of 75 deg, 400 samples, 40 dB", 400, 50.0, REF_M6, ref, 40, cap_deg=75),
        case(rng, "cap of 60 deg, 400 samples, 50 dB, offsets of 600 uT", 400, 50.0, REF_M6, far, 50, cap_deg=60),
        case(rng, "strong soft iron, 200 samples, 35 dB", 200, 45.0, [1.4, 0.8, 1.0, 0.2, -0.15, 0.1], far, 35),
        case(rng, "no disturbance, 200 samples, 35 dB", 200, 48.0, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], [0.0] * 3, 35),
    ]
    about = "ellipsoid fits; order of the covariance: b_x b_y b_z (uT) m_xx m_yy m_zz m_xy m_xz m_yz"
    write("ellipsoid.json", "ellipsoid.py", SEED, about, {"cases": cases})


if __name__ == "__main__":
    main()
