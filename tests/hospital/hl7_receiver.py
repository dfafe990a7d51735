#!/usr/bin/env python3
"""A receiver of HL7 v2 over MLLP, which reads every message by hl7apy and validates it.

    hl7_receiver.py FOLDER [tls] [ADDRESS]

It listens on a port of its own at 127.0.0.1 or ADDRESS; FOLDER/port says which. With tls it shows FOLDER/server.pem and server.key.
Each message that is valid becomes FOLDER/messages/NUMBER.hl7, whatever is answered. FOLDER/mode says how it answers:
empty for AA; AE, AR or CE; locked (AE with the error 206); other (AA for another message); hang; half; garbage;
cut-after (takes the message and closes); huge.
"""

import os
import socket
import ssl
import sys
import threading
import time

from hl7apy.parser import parse_message

FOLDER = sys.argv[1]
START, END = b"\x0b", b"\x1c\r"


def path(name):
    return os.path.join(FOLDER, name)


def mode():
    try:
        with open(path("mode"), encoding="utf-8") as file:
            return file.read().strip()
    except FileNotFoundError:
        return ""


def taken(message):
    """Notes a message, and why it is none if it is not valid."""
    text = message.decode("utf-8")
    parsed = parse_message(text, find_groups=True)
    parsed.validate()
    folder = path("messages")
    number = len(os.listdir(folder)) + 1
    with open(os.path.join(folder, f"{number:04}.hl7"), "wb") as file:
        file.write(message)
    return parsed.msh.msh_10.value


def acknowledgement(control, code, error="", text="the patient has no open case"):
    now = time.strftime("%Y%m%d%H%M%S")
    head = f"MSH|^~\\&|KIS|HOUSE|GAITER|BOOTH|{now}||ACK^R01^ACK|A{control}|P|2.5"
    text = text if code not in ("AA", "CA") else ""
    segments = [head, f"MSA|{code}|{control}|{text}"]
    if error:
        segments.append(f"ERR||PID^1^3|{error}^Locked^HL70357|E")
    return START + ("\r".join(segments) + "\r").encode() + END


def serve(connection):
    with connection:
        data = b""
        while not data.endswith(END):
            part = connection.recv(65536)
            if not part:
                return
            data += part
        try:
            control = taken(data[1:-2])
        except Exception as fault:  # Whatever hl7apy finds is told, and is a fault of the sender.
            with open(path("faults"), "a", encoding="utf-8") as file:
                file.write(f"{type(fault).__name__}: {fault}\n")
            fields = data.decode("utf-8", "replace").split("\r")[0].split("|")
            connection.sendall(acknowledgement(fields[9], "AR", text=f"{fault}"))
            return
        how = mode()
        if how == "hang":
            time.sleep(3600)
        elif how == "cut-after":
            return
        elif how == "half":
            connection.sendall(acknowledgement(control, "AA")[:30])
        elif how == "garbage":
            connection.sendall(START + b"hello" + END)
        elif how == "huge":
            connection.sendall(START + b"x" * 100_000_000 + END)
        elif how == "other":
            connection.sendall(acknowledgement("another", "AA"))
        elif how == "locked":
            connection.sendall(acknowledgement(control, "AE", "206"))
        else:
            connection.sendall(acknowledgement(control, how or "AA"))


def main():
    os.makedirs(path("messages"), exist_ok=True)
    addresses = [word for word in sys.argv[2:] if word != "tls"]
    listener = socket.create_server((addresses[0] if addresses else "127.0.0.1", 0))
    context = None
    if "tls" in sys.argv[2:]:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(path("server.pem"), path("server.key"))
    with open(path("port.new"), "w", encoding="utf-8") as file:
        file.write(str(listener.getsockname()[1]))
    os.rename(path("port.new"), path("port"))

    def handled(connection):
        try:
            serve(context.wrap_socket(connection, server_side=True) if context else connection)
        except OSError:
            pass

    while True:
        connection, _ = listener.accept()
        threading.Thread(target=handled, args=(connection,), daemon=True).start()


main()
