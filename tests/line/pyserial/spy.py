"""pyserial's spy on a pseudo-terminal. usage: spy.py URL-OPTIONS HEX...; each is written, comes back and is read."""
import os
import pty
import sys
import tty

import serial

ours, theirs = pty.openpty()
tty.setraw(theirs)
port = serial.serial_for_url("spy://" + os.ttyname(theirs) + sys.argv[1], timeout=0.2)
for text in sys.argv[2:]:
    data = bytes.fromhex(text)
    port.write(data)
    back = b""
    while len(back) < len(data):
        back += os.read(ours, 4096)
    os.write(ours, back)
    assert port.read(len(data)) == data
if "all" in sys.argv[1]:
    port.read(1)
