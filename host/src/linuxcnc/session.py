"""Conversation with a running LinuxCNC: opens an NC program, runs it and reports, for `arcfeed stream --port linuxcnc:`.

Arguments: the NC program, and `component` if the HAL component arcfeed has its feed. Commands are lines on standard
input: open, arm, run, pause. The file of the program need not be there before `open`. Reports are lines on standard output: a JSON object, or a row of halsampler (sampler.hal of arcfeed
has its columns). The end of standard input ends the conversation, not the program on the machine.
"""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import hal
import linuxcnc

PERIOD_S = 0.05
LOAD_S = 30.0
AT_REST_UNITS_PER_S = 1e-6
DRAIN_S = 5.0
FEW_ROWS = 1000
SAMPLES = ["sample-x", "sample-y", "sample-z", "arcfeed-current", "arcfeed-feed", "arcfeed-dial", "spindle-speed",
           "arcfeed-line", "arcfeed-type", "arcfeed-state", "arcfeed-reason", "arcfeed-chip", "arcfeed-offset-x",
           "arcfeed-offset-y", "arcfeed-offset-z"]
LOCK = threading.Lock()


def put(line):
    with LOCK:
        sys.stdout.write(line)
        sys.stdout.flush()


def report(**what):
    put(json.dumps(what) + "\n")


def fail(message):
    report(fault=message)
    sys.exit(1)


def poll(stat):
    """State of LinuxCNC; the conversation ends with it."""
    try:
        stat.poll()
    except linuxcnc.error:
        fail("LinuxCNC does not run; start it with the machine's configuration, and home the machine")
    except SystemError:
        fail("LinuxCNC runs for another user, or with another HOME; run arcfeed as the user who started it")


def check_machine(stat):
    if stat.task_state == linuxcnc.STATE_ESTOP:
        fail("LinuxCNC is in emergency stop; release it there and switch the machine on")
    if stat.task_state != linuxcnc.STATE_ON:
        fail("the machine is off; switch it on in LinuxCNC")
    not_homed = [joint for joint in range(stat.joints) if not stat.homed[joint]]
    if not_homed:
        fail("joint %s is not homed; home all joints in LinuxCNC" % ", ".join(map(str, not_homed)))
    if stat.interp_state != linuxcnc.INTERP_IDLE:
        fail("LinuxCNC is executing %s; let it end, or stop it there" % (stat.file or "a command"))


def value(name):
    """Value of a HAL pin, or None where there is no such pin."""
    try:
        return hal.get_value(name)
    except RuntimeError:
        return None


def sampler_fault():
    """Reason why the sampler does not have the columns of arcfeed; empty if it has them."""
    shown = subprocess.run(["halcmd", "-s", "show", "pin", "sampler.0.pin"], capture_output=True, text=True)
    rows = [line.split() for line in shown.stdout.splitlines()]
    signals = {row[4]: row[-1] for row in rows if len(row) >= 7}
    if [signals.get("sampler.0.pin.%d" % at) for at in range(len(SAMPLES))] != SAMPLES:
        return "its configuration does not source examples/linuxcnc/sampler.hal"
    return ""


def servo_period_s(stat):
    period = linuxcnc.ini(stat.ini_filename).find("EMCMOT", "SERVO_PERIOD")
    return int(period or 1000000) * 1e-9


def open_program(stat, command, program, has_component):
    if has_component:
        if value("arcfeed.moves") is None or value("arcfeed-program.valid") is None:
            fail("LinuxCNC does not have the component arcfeed; source firmware/linuxcnc/arcfeed.hal, or set the mode rewrite-only")
        if value("arcfeed.armed"):
            fail("the component arcfeed is armed; press Disarm")
    command.mode(linuxcnc.MODE_AUTO)
    command.wait_complete()
    command.program_open(program)
    command.wait_complete()
    deadline = time.time() + LOAD_S
    while True:
        time.sleep(PERIOD_S)
        poll(stat)
        is_open = stat.file == program and stat.task_mode == linuxcnc.MODE_AUTO
        if is_open and (not has_component or (value("arcfeed-program.valid") and value("arcfeed.moves"))):
            return
        if time.time() > deadline and not is_open:
            fail("LinuxCNC has not opened %s: its screen has the reason" % program)
        if time.time() > deadline:
            fail("the component arcfeed has not taken the moves of %s.arcfeed (arcfeed.load-status is %s)"
                 % (program, value("arcfeed.load-status")))


def arm(say):
    try:
        hal.set_p("arcfeed.arm", "1")
        time.sleep(2 * PERIOD_S)
        hal.set_p("arcfeed.arm", "0")
    except RuntimeError:
        say("the pin arcfeed.arm has another writer: press Arm on the panel")
        return
    if not value("arcfeed.armed"):
        say("the component arcfeed is not armed: refusal %s, state %s" % (value("arcfeed.refusal"), value("arcfeed.state")))


class Sampler:
    """Rows of every servo period from its begin on."""

    def __init__(self):
        # Rows from before that were not read.
        self.old = value("sampler.0.curr-depth")
        # A process group of its own: Ctrl-C is not for it.
        self.process = subprocess.Popen(["halsampler", "-c", "0", "-t"], stdout=subprocess.PIPE, text=True,
                                        start_new_session=True)
        self.thread = threading.Thread(target=self.pass_on, daemon=True)
        self.thread.start()
        deadline = time.time() + DRAIN_S
        while value("sampler.0.curr-depth") > FEW_ROWS and time.time() < deadline:
            time.sleep(PERIOD_S)
        self.overruns = value("sampler.0.overruns")

    def pass_on(self):
        for line in self.process.stdout:
            if self.old > 0:
                self.old -= 1
            elif line.endswith("\n") and line[0].isdigit():
                put(line)

    def end(self):
        """Number of rows that found no room."""
        # Longer than halsampler takes to fill its buffer.
        time.sleep(0.5)
        overruns = value("sampler.0.overruns") - self.overruns
        self.process.terminate()
        self.process.wait()
        self.thread.join()
        return overruns


def read_commands(commands):
    for line in sys.stdin:
        commands.append(line.strip())
    commands.append("end")


def status(stat, has_component):
    return {
        "line": stat.motion_line,
        "paused": bool(stat.paused),
        "at_rest": stat.current_vel < AT_REST_UNITS_PER_S,
        "armed": bool(has_component and value("arcfeed.armed")),
    }


def main(program, has_component):
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    stat, command = linuxcnc.stat(), linuxcnc.command()
    poll(stat)
    check_machine(stat)
    component = hal.component("arcfeed-stream-%d" % os.getpid())
    component.ready()
    try:
        converse(stat, command, program, has_component)
    finally:
        component.exit()


def converse(stat, command, program, has_component):
    report(idle={})
    if sys.stdin.readline().strip() != "open":
        return
    open_program(stat, command, program, has_component)
    fault = sampler_fault()
    report(ready={"moves": value("arcfeed.moves") or 0, "period_s": servo_period_s(stat), "no_samples": fault,
                  "mm_per_unit": 1.0 / stat.linear_units})
    commands, sampler, begun, ran = [], None, None, False
    threading.Thread(target=read_commands, args=(commands,), daemon=True).start()
    while True:
        time.sleep(PERIOD_S)
        poll(stat)
        while commands:
            word = commands.pop(0)
            if word == "arm":
                arm(lambda text: report(note=text))
            elif word == "run" and not begun:
                sampler = None if fault else Sampler()
                command.auto(linuxcnc.AUTO_RUN, 0)
                command.wait_complete()
                begun = time.time()
            elif word == "pause":
                command.auto(linuxcnc.AUTO_PAUSE)
            elif word == "end":
                return
        report(status=status(stat, has_component))
        if not begun:
            continue
        ran = ran or stat.interp_state != linuxcnc.INTERP_IDLE
        if stat.interp_state == linuxcnc.INTERP_IDLE and (ran or time.time() - begun > 1.0):
            break
    missing = sampler.end() if sampler else 0
    report(ended={"is_on": stat.task_state == linuxcnc.STATE_ON, "missing": missing})


main(sys.argv[1], sys.argv[2:] == ["component"])
