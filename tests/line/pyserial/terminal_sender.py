"""pyserial as a sender at a serial port. usage: terminal_sender.py DEVICE PROGRAM

Opens it as a shop's script would, with the system doing XON/XOFF, and writes the program in one call. The port stays open
until somebody ends this script.
"""
import signal
import sys

import serial

device, program = sys.argv[1:3]
with open(program, "rb") as file:
    data = file.read()
port = serial.Serial(device, baudrate=9600, bytesize=8, parity="N", stopbits=1, xonxoff=True, write_timeout=None)
print("open", flush=True)
port.write(data)
print("sent", flush=True)
signal.pause()
