"""Writes allantools_reference.csv: every estimator on the NBS data by allantools, to all digits.

    pip install allantools==2024.6 && python allantools_reference.py > allantools_reference.csv

No bias correction (allantools applies none). At m = 1 allantools takes the Hadamard total for the overlapping Hadamard.
Degrees of freedom are given for white readings (alpha = 0) and, without a deviation, for every noise and estimator.
"""

import contextlib
import io

import allantools as at
import numpy as np

NINE = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0]
ESTIMATORS = {
    "Allan": at.adev, "OverlappingAllan": at.oadev, "ModifiedAllan": at.mdev, "Time": at.tdev, "Hadamard": at.hdev,
    "OverlappingHadamard": at.ohdev, "Total": at.totdev, "ModifiedTotal": at.mtotdev, "TimeTotal": at.ttotdev,
    "HadamardTotal": at.htotdev,
}
GREENHALL = {
    "Allan": (2, False, False), "OverlappingAllan": (2, True, False), "ModifiedAllan": (2, True, True),
    "Hadamard": (3, False, False), "OverlappingHadamard": (3, True, False),
}


def thousand():
    n = [1234567890]
    while len(n) < 1000:
        n.append(16807 * n[-1] % 2147483647)
    return np.array(n) / 2147483647.0


def deviations():
    for name, y, factors in ("nine", np.array(NINE), [1, 2]), ("thousand", thousand(), [1, 2, 3, 5, 10, 32, 100, 200]):
        x = np.concatenate(([0.0], np.cumsum(y - y.mean())))
        for estimator, function in ESTIMATORS.items():
            for m in factors:
                try:
                    with contextlib.redirect_stdout(io.StringIO()):
                        taus, dev, _, _ = function(x, rate=1.0, data_type="phase", taus=[m])
                except UserWarning:  # too few terms
                    continue
                if len(taus) == 1 and taus[0] == m:
                    print(f"deviation,{name},{estimator},{m},{dev[0]:.15e}")


def freedoms():
    for estimator, (d, overlapping, modified) in GREENHALL.items():
        for alpha in range(2, 1 - 2 * d, -1):
            for points in (101, 1001, 100001):
                for m in (1, 2, 7, 20, 32, 64, 250, 1024, 20000):
                    if (d + 1) * m < points:
                        try:
                            edf = at.edf_greenhall(alpha, d, m, points, overlapping, modified)
                        except (NotImplementedError, AssertionError):  # cases it lacks
                            continue
                        print(f"freedom,{points},{estimator},{m},{alpha},{edf:.12e}")


if __name__ == "__main__":
    print("# By allantools_reference.py with allantools 2024.6: deviation,data,estimator,m,value;")
    print("# freedom,phase points,estimator,m,alpha,equivalent degrees of freedom")
    deviations()
    freedoms()
