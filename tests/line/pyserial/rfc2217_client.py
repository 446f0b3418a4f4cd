"""pyserial's rfc2217:// as a sender. usage: rfc2217_client.py URL BAUDRATE FRAME PROGRAM (server | own)

With `server` the port at the other end does XON/XOFF; with `own` this script does. Prints the reported state of the port.
"""
import sys
import time

import serial

url, baudrate, frame, program, who = sys.argv[1:6]
port = serial.serial_for_url(
    url, baudrate=int(baudrate), bytesize=int(frame[0]), parity=frame[1], stopbits=int(frame[2]),
    xonxoff=who == "server", timeout=0, write_timeout=None)
print("open: cts=%d dsr=%d cd=%d ri=%d" % (port.cts, port.dsr, port.cd, port.ri), flush=True)
data = open(program, "rb").read()
if who == "server":
    port.write(data)
else:
    may_send, ends = False, time.time() + 30
    while data and time.time() < ends:
        for byte in port.read(64):
            may_send = {0x11: True, 0x13: False}.get(byte & 0x7F, may_send)
        if may_send:
            port.write(data[:4])
            data = data[4:]
        time.sleep(0.004)
port.close()
print("sent", flush=True)
