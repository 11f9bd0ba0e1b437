"""Cramer-Rao bound of h_m = M h + b + w, |h| = 1 known, the orientation of every sample unknown (Kay, ch. 3).

Fisher information by finite differences of the mean, with two explicit nuisance angles per sample (turns of h about two
axes across it), which are then eliminated by the Schur complement. The reference set REF, field strength 1,
noise s = 10^(-SNR / 20) per axis. Directions: the Fibonacci rule in common.py, written out for the small set.
"""

import numpy as np
from common import ORDER, REF_B, REF_M6, fibonacci, symmetric, write


def turned(u, angles):
    """u turned by small angles about two axes across it."""
    e1 = np.cross(u, np.eye(3)[np.argmin(np.abs(u))])
    e1 /= np.linalg.norm(e1)
    e2 = np.cross(u, e1)
    size = np.hypot(*angles)
    return u * np.cos(size) + (e1 * angles[0] + e2 * angles[1]) * (np.sinc(size / np.pi))


def mean(parameters, u):
    return symmetric(parameters[3:]) @ u + parameters[:3]


def bound(us, parameters, noise):
    information = np.zeros((9, 9))
    step = 1e-5
    for u in us:
        columns = []
        for k in range(9):
            e = np.zeros(9)
            e[k] = step
            columns.append((mean(parameters + e, u) - mean(parameters - e, u)) / (2 * step))
        for k in range(2):
            a = np.zeros(2)
            a[k] = step
            columns.append((mean(parameters, turned(u, a)) - mean(parameters, turned(u, -a))) / (2 * step))
        g = np.stack(columns, axis=1) / noise
        f = g.T @ g
        information += f[:9, :9] - f[:9, 9:] @ np.linalg.solve(f[9:, 9:], f[9:, :9])
    return np.linalg.inv(information)


def main():
    parameters = np.array(REF_B + REF_M6)
    cases = []
    for count in (20, 100, 1000):
        for snr in (30, 35, 40):
            us = fibonacci(count)
            covariance = bound(us, parameters, 10 ** (-snr / 20))
            sigma = np.sqrt(np.diag(covariance))
            group = {"b": sigma[:3], "m_diagonal": sigma[3:6], "m_off_diagonal": sigma[6:]}
            found = {"samples": count, "snr_db": snr, "sigma": sigma}
            found["group_rms"] = {k: np.sqrt((v**2).mean()) for k, v in group.items()}
            if count == 20 and snr == 30:
                found["directions"] = us
                found["covariance"] = covariance
            cases.append(found)
    about = "Cramer-Rao bound, field strength 1, directions of fibonacci(samples) in common.py"
    body = {"order": ORDER, "parameters": parameters, "cases": cases}
    write("crb.json", "crb.py", None, about, body)


if __name__ == "__main__":
    main()
