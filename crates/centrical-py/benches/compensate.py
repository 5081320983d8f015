"""How long compensation of arrays takes, beside NumPy: python crates/centrical-py/benches/compensate.py [SESSION]."""

import subprocess
import sys
import timeit
from pathlib import Path

import centrical as ct
import numpy as np

MANY = 4_000_000


def best(call, number=1, repeat=15):
    """Seconds of one call: the best of many, as others use the machine too."""
    return min(timeit.repeat(call, number=number, repeat=repeat)) / number


def with_numpy(result):
    """The same model in NumPy: fixed-point steps from the linear inverse, terms of one newtonometer at a time."""
    terms = [(t.axis - 1, t.powers, result[t.name].value) for t in result.document.model.error_model]
    bias, gain, others = np.zeros(3), np.eye(3), []
    for axis, powers, value in terms:
        if sum(powers) == 0:
            bias[axis] += value
        elif sum(powers) == 1:
            gain[axis, powers.index(1)] += value
        else:
            others.append((axis, powers, value))
    inverse = np.linalg.inv(gain)

    def compensate(readings, steps=5):
        start = (readings - bias) @ inverse.T
        f = start
        for _ in range(steps):
            error = np.zeros_like(f)
            columns = f.T
            for axis, powers, value in others:
                monomial = value
                for column, power in zip(columns, powers):
                    for _ in range(power):
                        monomial = monomial * column
                error[:, axis] += monomial
            f = start - error @ inverse.T
        return f

    return compensate


def import_time():
    """Milliseconds of `import centrical` after NumPy, the best of ten processes."""
    text = "import numpy, time; t = time.perf_counter(); import centrical; print(time.perf_counter() - t)"
    times = [float(subprocess.run([sys.executable, "-c", text], capture_output=True, check=True).stdout) for _ in range(10)]
    return 1e3 * min(times)


def main():
    default = Path(__file__).resolve().parents[3] / "examples" / "ta-200"
    result = ct.calibrate(sys.argv[1] if len(sys.argv) > 1 else default)
    readings = np.random.default_rng(1).uniform(-150.0, 150.0, size=(MANY, 3))
    out, some = np.empty_like(readings), readings[:100_000]
    fortran, one, empty = np.asfortranarray(readings), readings[:1].copy(), np.empty((0, 3))
    one_out, empty_out = np.empty((1, 3)), np.empty((0, 3))
    numpy_model = with_numpy(result)
    print(f"largest difference from NumPy      {np.abs(numpy_model(some) - result.compensate(some)).max():8.1e} m/s^2")
    print(f"(n, 3) C order into out            {MANY / best(lambda: result.compensate(readings, out)) / 1e6:8.1f} M/s")
    print(f"the same in place                  {MANY / best(lambda: result.compensate(out, out)) / 1e6:8.1f} M/s")
    print(f"the same into a new array          {MANY / best(lambda: result.compensate(readings)) / 1e6:8.1f} M/s")
    print(f"Fortran order, copied first        {MANY / best(lambda: result.compensate(fortran, out), repeat=5) / 1e6:8.1f} M/s")
    print(f"NumPy                              {len(some) / best(lambda: numpy_model(some), repeat=5) / 1e6:8.1f} M/s")
    print(f"with uncertainties                 {len(some) / best(lambda: result.compensate(some, uncertainty=True), repeat=5) / 1e6:8.1f} M/s")
    print(f"memory copied by NumPy             {MANY / best(lambda: np.copyto(out, readings)) / 1e6:8.1f} M/s")
    print(f"one row                            {1e9 * best(lambda: result.compensate(one), 20_000):8.0f} ns")
    print(f"one row into out                   {1e9 * best(lambda: result.compensate(one, one_out), 20_000):8.0f} ns")
    print(f"no row                             {1e9 * best(lambda: result.compensate(empty), 20_000):8.0f} ns")
    print(f"no row into out                    {1e9 * best(lambda: result.compensate(empty, empty_out), 20_000):8.0f} ns")
    print(f"empty call of the core             {1e9 * best(lambda: result.native.range, 20_000):8.0f} ns")
    print(f"import after NumPy                 {import_time():8.1f} ms")


if __name__ == "__main__":
    main()
