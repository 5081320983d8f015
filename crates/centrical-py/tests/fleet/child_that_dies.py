"""The process of a fleet that calibrates, and that some sessions end by their name: as a fault of the program would."""

import os
import time

from centrical.fleet import child

calibrate = child.calibrate


def dying(request):
    if "aborts" in request["session"]:
        os.abort()
    if "eats" in request["session"]:
        bytearray(64 << 30)
    if "sleeps" in request["session"]:
        time.sleep(60)
    calibrate(request)


child.calibrate = dying
child.main()
