"""What an attacker, a full disk, a second process and a clumsy copy can do: `.ci/run hostile`.

Every group prints how many cases it had, how many were judged badly, the longest and the largest run. Judged badly: a panic, a
hang above 10 s, more than 1 GB, a wrong exit code, an output in part, a silent wrong result, a message without found and expected.
"""

import sys
import tempfile
import time

import damage
import forms
import growth
import names
import results
import values
import watching
import writing
from judge import Place

GROUPS = {"values": values, "writing": writing, "names": names, "damage": damage, "watching": watching, "results": results, "growth": growth,
          "forms": forms}


def main():
    begun = time.monotonic()
    bad = count = 0
    with tempfile.TemporaryDirectory() as folder:
        place = Place(folder)
        for name in sys.argv[1:] or GROUPS:
            for group in GROUPS[name].check(place):
                group.report()
                bad, count = bad + len(group.bad), count + group.count
    print(f"hostile: {count} cases, {bad} judged badly, {time.monotonic() - begun:.0f} s")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
