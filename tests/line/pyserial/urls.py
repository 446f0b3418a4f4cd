"""What pyserial makes of URLs: one a line on stdin, `ok` or `no`, a tab and the reason on stdout.

Nothing is connected to: it is the reading of the URL that counts. There are three ports to find.
"""
import sys

import serial
import serial.tools.list_ports
from serial.tools.list_ports_common import ListPortInfo


def port(device, description, hwid):
    info = ListPortInfo(device)
    info.description, info.hwid = description, hwid
    return info


PORTS = [
    port("/dev/ttyUSB10", "FT232R USB UART", "USB VID:PID=0403:6001 SER=A1 LOCATION=1-2"),
    port("/dev/ttyUSB2", "CP2102", "USB VID:PID=10C4:EA60 SER=B2 LOCATION=1-1"),
    port("/dev/ttyS0", "ttyS0", "PNP0501"),
]
serial.tools.list_ports.comports = lambda include_links=False: PORTS


def read(url):
    instance = serial.serial_for_url(url, do_not_open=True)
    scheme = url.split("://")[0].lower() if "://" in url else ""
    if scheme in ("loop", "socket", "rfc2217"):
        found = instance.from_url(url)
        return "%s:%s" % found if found else ""
    return instance.port


for line in sys.stdin:
    try:
        print("ok\t%s" % read(line.rstrip("\n")))
    except Exception as error:
        print("no\t%s: %s" % (type(error).__name__, str(error).replace("\n", " ")))
