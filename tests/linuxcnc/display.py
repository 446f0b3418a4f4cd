"""Screen of a LinuxCNC without one: switches the machine on, homes it, writes the file `ready`, and waits for the file `stop`."""

import os
import time

import linuxcnc


def main():
    command, stat = linuxcnc.command(), linuxcnc.stat()
    command.state(linuxcnc.STATE_ESTOP_RESET)
    command.wait_complete()
    command.state(linuxcnc.STATE_ON)
    command.wait_complete()
    command.mode(linuxcnc.MODE_MANUAL)
    command.wait_complete()
    stat.poll()
    for joint in range(stat.joints):
        command.home(joint)
    while not all(stat.homed[: stat.joints]):
        time.sleep(0.05)
        stat.poll()
    open("ready", "w").close()
    # A folder that is gone ends it too.
    while os.path.exists("ready") and not os.path.exists("stop"):
        time.sleep(0.05)
    command.abort()
    command.state(linuxcnc.STATE_OFF)


main()
