"""pyserial's socket://. usage: socket_client.py HOST:PORT; sends back what it reads, each bit inverted."""
import sys

import serial

port = serial.serial_for_url("socket://" + sys.argv[1], timeout=0.05)
print("open", flush=True)
try:
    while True:
        data = port.read(256)
        if data:
            port.write(bytes(byte ^ 0xFF for byte in data))
except serial.SerialException:
    pass
