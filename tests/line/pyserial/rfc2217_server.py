"""pyserial's RFC 2217 server for one client: PortManager between TCP and a port.

usage: rfc2217_server.py PORT [refuse-baudrate | suspend]
Prints `port: N`, then `settings: ...` each time they change.
"""
import select
import socket
import sys
import time

import serial
import serial.rfc2217 as rfc2217


class Line(serial.Serial):
    """A native port on a pseudo-terminal: 8N1 and without modem lines, whatever is requested, and one that keeps what the
    control has said before."""

    cts = dsr = cd = property(lambda self: True)
    ri = property(lambda self: False)

    def _update_rts_state(self):
        pass

    def _update_dtr_state(self):
        pass

    def _reset_input_buffer(self):
        pass

    def _reconfigure_port(self, force_update=False):
        requested = self._bytesize, self._parity
        self._bytesize, self._parity = 8, "N"
        try:
            super()._reconfigure_port(force_update)
        finally:
            self._bytesize, self._parity = requested


class Client:
    def __init__(self, connection):
        self.connection = connection

    def write(self, data):
        self.connection.sendall(data)


def refusing(manager, port):
    """As a server whose port cannot do any other rate."""

    class Refusing(type(port)):
        @property
        def baudrate(self):
            return 1200

        @baudrate.setter
        def baudrate(self, value):
            if value != 1200:
                raise ValueError("only 1200")

    port.__class__ = Refusing


def main():
    url, mode = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
    port = serial.serial_for_url(url, timeout=0) if "://" in url else Line(url, timeout=0)
    listener = socket.create_server(("127.0.0.1", 0))
    print("port: %d" % listener.getsockname()[1], flush=True)
    connection, _ = listener.accept()
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    manager = rfc2217.PortManager(port, Client(connection))
    if mode == "refuse-baudrate":
        refusing(manager, port)
    said = None
    while True:
        ready, _, _ = select.select([connection], [], [], 0.001)
        if ready:
            data = connection.recv(1024)
            if not data:
                break
            plain = b"".join(manager.filter(data))
            if mode == "suspend" and b"S" in plain:
                connection.sendall(bytes([255, 250, 44, 108, 255, 240]))
                time.sleep(0.5)
                connection.sendall(bytes([255, 250, 44, 109, 255, 240]))
            if plain:
                port.write(plain)
        back = port.read(1024)
        if back:
            connection.sendall(b"".join(manager.escape(back)))
        has = "%d %d%s%g xonxoff=%d rtscts=%d" % (
            port.baudrate, port.bytesize, port.parity, port.stopbits, port.xonxoff, port.rtscts)
        if has != said:
            said = has
            print("settings: " + has, flush=True)


main()
