"""Screen of a LinuxCNC without one: runs an NC program, arms the component, takes a sample each servo period.

Arguments as JSON in the file named by ARCFEED_DRIVE: program, samples, report, arm, events, seconds. Reports one JSON
object a line. Events come in their order: [{"line": the line in execution}, command, arguments], or with {"after":
seconds since the event before}. The machine is not in step with the clock of the wall, so that only a line gives its place.
"""

import json
import os
import subprocess
import time

import linuxcnc


with open(os.environ["ARCFEED_DRIVE"]) as arguments:
    WANTED = json.load(arguments)
REPORT = open(WANTED["report"], "w")


def say(**what):
    print(json.dumps(what), file=REPORT, flush=True)


def pin(name):
    return subprocess.run(["halcmd", "getp", name], capture_output=True, text=True).stdout.strip()


def set_pin(name, value):
    subprocess.run(["halcmd", "setp", name, str(value)], check=True, capture_output=True)


def press(name):
    set_pin(name, 1)
    time.sleep(0.1)
    set_pin(name, 0)


def is_due(when, line, waited):
    return line >= when["line"] if "line" in when else waited >= when["after"]


def main():
    wanted = WANTED
    command, stat, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()

    def report_errors():
        while message := errors.poll():
            say(error=message[1])

    def run_mode():
        command.mode(linuxcnc.MODE_AUTO)
        command.wait_complete()

    actions = {
        "pin": lambda name, value: set_pin(name, value),
        "press": press,
        "pause": lambda: command.auto(linuxcnc.AUTO_PAUSE),
        "resume": lambda: command.auto(linuxcnc.AUTO_RESUME),
        "step": lambda: command.auto(linuxcnc.AUTO_STEP),
        "abort": lambda: command.abort(),
        "run": lambda line: (run_mode(), command.auto(linuxcnc.AUTO_RUN, line)),
        "halcmd": lambda *words: subprocess.run(["halcmd", *words], check=True, capture_output=True),
        "kill": lambda name: subprocess.run(["pkill", "-STOP", "-u", str(os.getuid()), "-f", name], check=True),
    }
    command.state(linuxcnc.STATE_ESTOP_RESET)
    command.wait_complete()
    command.state(linuxcnc.STATE_ON)
    command.wait_complete()
    command.mode(linuxcnc.MODE_MANUAL)
    command.wait_complete()
    stat.poll()
    for joint in range(stat.joints):
        command.home(joint)
    for _ in range(100):
        time.sleep(0.05)
        stat.poll()
        if all(stat.homed[: stat.joints]):
            break
    run_mode()
    command.program_open(wanted["program"])
    command.wait_complete()
    time.sleep(1.0)
    if wanted["arm"]:
        press("arcfeed.arm")
        time.sleep(0.3)
    say(moves=pin("arcfeed.moves"), load=pin("arcfeed.load-status"), state=pin("arcfeed.state"),
        refusal=pin("arcfeed.refusal"), inhibit=pin("motion.feed-inhibit"))
    with open(wanted["samples"], "w") as file:
        sampler = subprocess.Popen(["halsampler", "-c", "0", "-t"], stdout=file)
        time.sleep(0.2)
        command.auto(linuxcnc.AUTO_RUN, 0)
        started = last = time.time()
        events = list(wanted["events"])
        time.sleep(0.5)
        while time.time() - started < wanted["seconds"]:
            stat.poll()
            report_errors()
            while events and is_due(events[0][0], stat.motion_line, time.time() - last):
                _, name, *arguments = events.pop(0)
                actions[name](*arguments)
                last = time.time()
                say(event=name, state=pin("arcfeed.state"), feed=pin("arcfeed.adaptive-feed"))
            if stat.interp_state == linuxcnc.INTERP_IDLE and not events:
                break
            time.sleep(0.02)
        time.sleep(0.3)
        sampler.terminate()
        sampler.wait()
    report_errors()
    say(ended=stat.interp_state == linuxcnc.INTERP_IDLE, seconds=time.time() - started, state=pin("arcfeed.state"),
        reason=pin("arcfeed.reason"), time=pin("arcfeed.time"), most=pin("arcfeed.tmax"),
        motion=pin("motion-controller.time"), motion_most=pin("motion-controller.tmax"))
    command.abort()
    command.state(linuxcnc.STATE_OFF)


main()
