#!/usr/bin/env python3
"""A receiver of HL7 v2 over MLLP, which reads every message by hl7apy and validates it.

    hl7_receiver.py FOLDER [ADDRESS]

It listens at 127.0.0.1 or ADDRESS. It ends with its standard input, if that is a pipe, and takes FOLDER with it if
there is FOLDER/temporary. FOLDER/ports says where it listens, once it is up: plain, and if FOLDER has certificates
(ca.pem, server.pem and server.key, expired.pem and expired.key) also tls, mutual (asks for a client's certificate)
and expired (shows the one that ran out).

MSH-5 of a message is its house, a receiver of its own with files in FOLDER/HOUSE. Each message that is valid becomes
HOUSE/messages/NUMBER.hl7, whatever is answered; why others are not is in FOLDER/faults. HOUSE/mode is read at every
message: FAULT [NUMBER]. The fault strikes every message, or the one of this number, from 1 since the file was
changed; HOUSE/log then has the line "strikes FAULT". Empty or missing: AA.

    AE AR CE CR  this code, with a reason          half         half an answer, and the connection is gone
    locked       AE with the error 206             half-hang    half an answer, and nothing more
    full         AE with the error 207             cut-before   closes, and takes nothing
    other        AA for another message            cut-after    takes the message and closes
    garbage      a frame with no answer in it      hang-before  no answer, takes nothing
    huge         100 MB                            hang-after   no answer, takes the message
    drip         a byte a second
    kill-before, kill-after, kill-half   the whole receiver is killed: before it has taken the message, once it has,
                                         in the middle of the answer
"""

import json
import os
import shutil
import signal
import socket
import ssl
import stat
import sys
import threading
import time

from hl7apy.parser import parse_message

FOLDER = sys.argv[1]
ADDRESS = sys.argv[2] if len(sys.argv) > 2 else "127.0.0.1"
START, END = b"\x0b", b"\x1c\r"
TAKES_NOTHING = {"cut-before", "hang-before", "kill-before"}
CHANGE = threading.Lock()
# By house: the file of its mode, and how many messages came since it is that.
MODES = {}


def path(*names):
    return os.path.join(FOLDER, *names)


def read(*names):
    try:
        with open(path(*names), encoding="utf-8") as file:
            return file.read().strip()
    except FileNotFoundError:
        return ""


def fault_of(house):
    """The fault that strikes this message; empty for none."""
    mode = read(house, "mode")
    if not mode:
        return ""
    found = os.stat(path(house, "mode"))
    since = (found.st_ino, found.st_mtime_ns)
    with CHANGE:
        known, count = MODES.get(house, (None, 0))
        count = count + 1 if known == since else 1
        MODES[house] = (since, count)
    fault, _, number = mode.partition(" ")
    if number and count != int(number):
        return ""
    with open(path(house, "log"), "a", encoding="utf-8") as file:
        file.write(f"strikes {fault}\n")
    return fault


def checked(message):
    """A message that is valid, as hl7apy reads it."""
    head = message.split(b"\r", 1)[0]
    charset = "latin-1" if b"8859/1" in head else "utf-8"
    parsed = parse_message(message.decode(charset), find_groups=True)
    parsed.validate()
    return parsed


def take(house, message):
    with CHANGE:
        folder = path(house, "messages")
        os.makedirs(folder, exist_ok=True)
        name = os.path.join(folder, f"{len(os.listdir(folder)) + 1:04}.hl7")
        with open(f"{name}.new", "wb") as file:
            file.write(message)
        os.rename(f"{name}.new", name)


def acknowledgement(control, code, error="", text="the patient 4711 has no open case"):
    now = time.strftime("%Y%m%d%H%M%S")
    head = f"MSH|^~\\&|KIS|HOUSE|GAITER|BOOTH|{now}||ACK^R01^ACK|A{control}|P|2.5"
    text = text if code not in ("AA", "CA") else ""
    segments = [head, f"MSA|{code}|{control}|{text}"]
    if error:
        segments.append(f"ERR||PID^1^3|{error}^^HL70357|E")
    return START + ("\r".join(segments) + "\r").encode() + END


def answer(connection, how, control):
    whole = acknowledgement(control, "AA")
    if how.startswith("hang"):
        time.sleep(3600)
    elif how.startswith("cut"):
        return
    elif how.startswith("kill"):
        if how == "kill-half":
            connection.sendall(whole[:30])
        os.kill(os.getpid(), signal.SIGKILL)
    elif how.startswith("half"):
        connection.sendall(whole[:30])
        time.sleep(3600 if how == "half-hang" else 0)
    elif how == "drip":
        for byte in whole:
            connection.sendall(bytes([byte]))
            time.sleep(1)
    elif how == "garbage":
        connection.sendall(START + b"hello" + END)
    elif how == "huge":
        connection.sendall(START + b"x" * 100_000_000 + END)
    elif how == "other":
        connection.sendall(acknowledgement("another", "AA"))
    elif how == "locked":
        connection.sendall(acknowledgement(control, "AE", "206"))
    elif how == "full":
        connection.sendall(acknowledgement(control, "AE", "207", "no space left on device"))
    else:
        connection.sendall(acknowledgement(control, how or "AA"))


def serve(connection):
    """Messages of a connection, one after the other."""
    data = b""
    while True:
        while END not in data:
            part = connection.recv(65536)
            if not part:
                return
            data += part
        message, _, data = data.partition(END)
        message = message.removeprefix(START)
        fields = message.split(b"\r")[0].decode("utf-8", "replace").split("|")
        control, house = fields[9], fields[4]
        try:
            checked(message)
        except Exception as fault:  # Whatever hl7apy finds is told, and is a fault of the sender.
            with open(path("faults"), "a", encoding="utf-8") as file:
                file.write(f"{house} {control}: {type(fault).__name__}: {fault}\n")
            connection.sendall(acknowledgement(control, "AR", text=f"{fault}"))
            continue
        how = fault_of(house)
        if how not in TAKES_NOTHING:
            take(house, message)
        answer(connection, how, control)
        if how.startswith(("cut", "half")):
            return


def accept(listener, context):
    def handled(connection):
        try:
            with context.wrap_socket(connection, server_side=True) if context else connection as opened:
                serve(opened)
        except OSError:
            pass

    while True:
        connection, _ = listener.accept()
        threading.Thread(target=handled, args=(connection,), daemon=True).start()


def contexts():
    """The ways in, with the certificates that each shows."""
    ways = {"plain": None}
    if os.path.exists(path("ca.pem")):
        for way, name in (("tls", "server"), ("mutual", "server"), ("expired", "expired")):
            ways[way] = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            ways[way].load_cert_chain(path(f"{name}.pem"), path(f"{name}.key"))
        ways["mutual"].load_verify_locations(path("ca.pem"))
        ways["mutual"].verify_mode = ssl.CERT_REQUIRED
    return ways


def main():
    ports = {}
    for way, context in contexts().items():
        listener = socket.create_server((ADDRESS, 0))
        ports[way] = listener.getsockname()[1]
        threading.Thread(target=accept, args=(listener, context), daemon=True).start()
    with open(path("ports.new"), "w", encoding="utf-8") as file:
        json.dump(ports, file)
    os.rename(path("ports.new"), path("ports"))
    if stat.S_ISFIFO(os.fstat(0).st_mode):
        sys.stdin.buffer.read()
        if os.path.exists(path("temporary")):
            shutil.rmtree(FOLDER)
    else:
        threading.Event().wait()


main()
