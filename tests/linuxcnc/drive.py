"""Run of an NC program on the LinuxCNC of `display.py`: arms the component, takes a sample each servo period.

Arguments as JSON in the file named by ARCFEED_DRIVE: program, samples, report, arm, mdi (a block before the run), line (to
begin with; 0 for the whole program), steps (single block up to this line; 0 for none), events, seconds. Reports one JSON
object a line. Events come in their order: [WHEN, command, arguments], WHEN being {"line": the line in execution}, {"after":
seconds since the event before} or {"idle": true}. The machine is not in step with the clock of the wall, so that only a
line gives its place.
"""

import json
import os
import subprocess
import time

import linuxcnc


# Longest wait for an order to be carried out, on a loaded computer.
ORDER_SECONDS = 30
# Longest wait for a program to be in force, on a loaded computer.
LOAD_SECONDS = 10
# Most presses of the button that arms.
PRESSES_MAX = 5
# State of the component before it is armed.
IDLE = "0"
# Between two readings of the times that the functions took.
READING_SECONDS = 0.1

with open(os.environ["ARCFEED_DRIVE"]) as arguments:
    WANTED = json.load(arguments)
REPORT = open(WANTED["report"], "w")
FUNCTIONS = ["arcfeed", "motion-command-handler", "motion-controller"]


def say(**what):
    print(json.dumps(what), file=REPORT, flush=True)


def pin(name):
    return subprocess.run(["halcmd", "getp", name], capture_output=True, text=True).stdout.strip()


def halcmd(*words):
    subprocess.run(["halcmd", *words], check=True, capture_output=True)


def set_pin(name, value):
    halcmd("setp", name, str(value))


def press(name):
    set_pin(name, 1)
    time.sleep(0.1)
    set_pin(name, 0)


def is_due(when, stat, waited):
    if "idle" in when:
        return waited > 0.5 and stat.interp_state == linuxcnc.INTERP_IDLE
    return stat.motion_line >= when["line"] if "line" in when else waited >= when["after"]


def begin(command, stat, line):
    """Begins the program. On a loaded computer LinuxCNC has been seen not to do so at the first order."""
    until = time.time() + ORDER_SECONDS
    while time.time() < until:
        command.auto(linuxcnc.AUTO_RUN, line)
        for _ in range(20):
            stat.poll()
            if stat.interp_state != linuxcnc.INTERP_IDLE:
                return
            time.sleep(0.05)
    say(error="LinuxCNC does not begin the program")


def arm():
    """Presses until the component is armed: once, if program and machine are ready. Returns the number of presses."""
    for presses in range(1, PRESSES_MAX + 1):
        press("arcfeed.arm")
        time.sleep(0.3)
        if pin("arcfeed.state") != IDLE:
            break
    return presses


def stop(signal, name):
    subprocess.run(["pkill", signal, "-u", str(os.getuid()), "-f", name], check=True)


def main():
    wanted = WANTED
    command, stat, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()

    def report_errors():
        while message := errors.poll():
            say(error=message[1])

    def run_mode():
        command.mode(linuxcnc.MODE_AUTO)
        command.wait_complete(ORDER_SECONDS)

    def power():
        for state in (linuxcnc.STATE_OFF, linuxcnc.STATE_ON):
            command.state(state)
            command.wait_complete(ORDER_SECONDS)

    actions = {
        "power": power,
        "pin": lambda name, value: set_pin(name, value),
        "press": press,
        "pause": lambda: command.auto(linuxcnc.AUTO_PAUSE),
        "resume": lambda: command.auto(linuxcnc.AUTO_RESUME),
        "step": lambda: command.auto(linuxcnc.AUTO_STEP),
        "abort": lambda: command.abort(),
        "dial": lambda ratio: command.feedrate(ratio),
        "arm": lambda: press("arcfeed.arm"),
        "run": lambda line: (run_mode(), command.auto(linuxcnc.AUTO_RUN, line)),
        "halcmd": halcmd,
        "freeze": lambda name: stop("-STOP", name),
        "thaw": lambda name: stop("-CONT", name),
    }
    if wanted["mdi"]:
        command.mode(linuxcnc.MODE_MDI)
        command.wait_complete(ORDER_SECONDS)
        command.mdi(wanted["mdi"])
        command.wait_complete(ORDER_SECONDS)
    run_mode()
    command.program_open(wanted["program"])
    command.wait_complete(ORDER_SECONDS)
    until = time.time() + LOAD_SECONDS
    while time.time() < until:
        stat.poll()
        is_loaded = not wanted["arm"] or pin("arcfeed.moves") != "0" and pin("arcfeed-program.valid") == "TRUE"
        if stat.file == wanted["program"] and is_loaded:
            break
        time.sleep(0.05)
    presses = arm() if wanted["arm"] else 0
    say(moves=pin("arcfeed.moves"), load=pin("arcfeed.load-status"), presses=presses, state=pin("arcfeed.state"),
        refusal=pin("arcfeed.refusal"), inhibit=pin("motion.feed-inhibit"))
    times = {name: [] for name in FUNCTIONS}
    most = {name: pin(name + ".tmax") for name in FUNCTIONS}
    with open(wanted["samples"], "w") as file:
        say(old_rows=int(pin("sampler.0.curr-depth")))
        sampler = subprocess.Popen(["halsampler", "-c", "0", "-t"], stdout=file, stderr=subprocess.DEVNULL)
        while int(pin("sampler.0.curr-depth")) > 1000:
            time.sleep(0.05)
        overruns = int(pin("sampler.0.overruns"))
        steps = wanted["steps"]
        if steps:
            command.auto(linuxcnc.AUTO_STEP)
        else:
            begin(command, stat, wanted["line"])
        started = last = next_reading = time.time()
        events = list(wanted["events"])
        time.sleep(0.5)
        while time.time() - started < wanted["seconds"]:
            stat.poll()
            report_errors()
            while events and is_due(events[0][0], stat, time.time() - last):
                _, name, *arguments = events.pop(0)
                actions[name](*arguments)
                last = time.time()
                say(event=name, state=pin("arcfeed.state"), feed=pin("arcfeed.adaptive-feed"))
            if stat.interp_state == linuxcnc.INTERP_IDLE and not events:
                break
            if steps and stat.paused and stat.inpos:
                # A step over the end would begin the program again.
                steps = steps if stat.motion_line < wanted["steps"] else 0
                command.auto(linuxcnc.AUTO_STEP if steps else linuxcnc.AUTO_RESUME)
                time.sleep(0.2)
            # The loop leaves the processor to the other programs: it comes before them.
            if time.time() > next_reading:
                next_reading += READING_SECONDS
                for name in FUNCTIONS:
                    times[name].append(pin(name + ".time"))
            time.sleep(0.005)
        time.sleep(0.3)
        overruns = int(pin("sampler.0.overruns")) - overruns
        sampler.terminate()
        sampler.wait()
    report_errors()
    say(ended=stat.interp_state == linuxcnc.INTERP_IDLE, seconds=time.time() - started, state=pin("arcfeed.state"),
        reason=pin("arcfeed.reason"), missing=overruns, times=times, most=most)
    command.abort()
    command.wait_complete(ORDER_SECONDS)


main()
