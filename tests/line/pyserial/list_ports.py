"""pyserial's list_ports, its own code, on another root. usage: list_ports.py ROOT [links]"""
import sys

import serial.tools.list_ports_common as common
import serial.tools.list_ports_linux as linux

root, links = sys.argv[1], len(sys.argv) > 2
for module in (common, linux):
    with open(module.__file__) as file:
        text = file.read()
    text = text.replace("'/dev/", "'" + root + "/dev/").replace("'/sys/", "'" + root + "/sys/")
    exec(compile(text, module.__file__, "exec"), module.__dict__)
linux.list_ports_common = common
FIELDS = ["vid", "pid", "serial_number", "location", "manufacturer", "product", "interface"]
for info in sorted(linux.comports(links)):
    values = [info.device, info.name, info.description, info.hwid] + [getattr(info, field) for field in FIELDS]
    print("\t".join(str(value) for value in values).replace(root, ""))
