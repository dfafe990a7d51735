#!/usr/bin/env python3
"""An archive of images by pynetdicom and pydicom, over DICOMweb and over associations, which can be told to fail.

    dicom_archive.py FOLDER [ADDRESS]

It listens at 127.0.0.1 or ADDRESS. It ends with its standard input, if that is a pipe, and takes FOLDER with it if
there is FOLDER/temporary. FOLDER/ports says where it listens, once it is up: http (/HOUSE/dicom-web) and dimse (the
called title is the house).

A house is an archive of its own with files in FOLDER/HOUSE. Each object that pydicom reads to its end becomes
HOUSE/objects/UID.dcm, and is still there after the archive was killed; why others do not is in FOLDER/faults. One that
is there already is refused as a duplicate (0111), by other bytes or the same.

HOUSE/mode is read at every request and every message: FAULT [STORE | FIND | ECHO] [NUMBER]. The fault strikes all of
them, or those of the kind, or of these the one of the number, from 1 since the file was changed; HOUSE/log then has
the line "strikes FAULT". Empty or missing: no fault.

    400 … 507    web: this status; associations: the status C000
    0122, A700 … the last object of a request, or of a message the only one, is not stored, for this reason
    lose         success, and nothing is kept           garbage      no answer of the protocol, nothing is done
    cut-before   no answer, nothing is done             drip         a byte a second, nothing is done
    cut-after    half an answer, all is done            huge         100 MB, nothing is done
    hang-before  no answer, nothing is done             abort        web: as cut-before
    hang-after   no answer, all is done
    kill-before, kill-torn, kill-after, kill-half   the whole archive is killed: before anything is done; once half of
                 the objects of a request are kept; once all is done; in the middle of the answer
"""

import io
import json
import os
import re
import shutil
import signal
import socket
import stat
import struct
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pydicom
from pydicom.dataset import Dataset
from pynetdicom import AE, AllStoragePresentationContexts, evt
from pynetdicom.sop_class import StudyRootQueryRetrieveInformationModelFind, Verification

pydicom.config.settings.reading_validation_mode = pydicom.config.RAISE

FOLDER = sys.argv[1]
ADDRESS = sys.argv[2] if len(sys.argv) > 2 else "127.0.0.1"
JSON = "application/dicom+json"
SYNTAXES = ["1.2.840.10008.1.2.1", "1.2.840.10008.1.2"]
BEFORE = {"cut-before", "hang-before", "kill-before", "garbage", "drip", "huge", "abort"}
UIDS = ["SOPClassUID", "SOPInstanceUID", "SeriesInstanceUID", "StudyInstanceUID", "PatientID"]
DUPLICATE, UNREADABLE = 0x0111, 0xC000
CHANGE = threading.Lock()
# By house: the file of its mode, and how many requests it counted since it is that.
MODES = {}


def path(*names):
    return os.path.join(FOLDER, *names)


def note(name, line):
    with open(path(*name), "a", encoding="utf-8") as file:
        file.write(f"{line}\n")


def fault_of(house, kind):
    """The fault that strikes this request or message; empty for none."""
    try:
        with open(path(house, "mode"), encoding="utf-8") as file:
            mode = file.read().split()
            found = os.fstat(file.fileno())
    except FileNotFoundError:
        return ""
    if not mode:
        return ""
    fault, *further = mode
    only, number = (further + [""])[:2] if further and further[0].isupper() else (kind, (further + [""])[0])
    if only != kind:
        return ""
    since = (found.st_ino, found.st_mtime_ns)
    with CHANGE:
        known, count = MODES.get(house, (None, 0))
        count = count + 1 if known == since else 1
        MODES[house] = (since, count)
    if number and count != int(number):
        return ""
    note([house, "log"], f"strikes {fault}")
    return fault


def die():
    os.kill(os.getpid(), signal.SIGKILL)


def keep(house, file):
    """Keeps an object. Tells its UIDs, and the reason why it is not kept, or 0."""
    try:
        read = pydicom.dcmread(io.BytesIO(file))
        # Every element is looked at.
        str(read)
        uids = [str(read[name].value) for name in UIDS[:2]]
        for name in UIDS:
            assert read[name].value, name
    except Exception as fault:  # Whatever pydicom finds is told, and is a fault of the sender.
        note(["faults"], f"{house} {type(fault).__name__}: {fault}")
        return ["", ""], UNREADABLE
    os.makedirs(path(house, "objects"), exist_ok=True)
    name = path(house, "objects", f"{uids[1]}.dcm")
    if os.path.exists(name):
        return uids, DUPLICATE
    own = f"{name}.{threading.get_ident()}"
    with open(own, "wb") as opened:
        opened.write(file)
        opened.flush()
        os.fsync(opened.fileno())
    os.rename(own, name)
    return uids, 0


def found(house, **wanted):
    """The objects of a house that have these values."""
    folder = path(house, "objects")
    names = sorted(os.listdir(folder)) if os.path.isdir(folder) else []
    sets = [pydicom.dcmread(os.path.join(folder, name), specific_tags=UIDS) for name in names if name.endswith(".dcm")]
    return [of for of in sets if all(str(of[key].value) == value for key, value in wanted.items())]


def huge(house, send, part):
    """100 MB, as fast as they are taken; the log says how many were."""
    taken = 0
    try:
        while taken < 100 << 20:
            send(part)
            taken += len(part)
    except OSError:
        pass
    note([house, "log"], f"huge {taken >> 20} MB")


# DICOMweb.


class Web(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def tell(self, status, body, media_type=JSON, part=1.0):
        body = body if isinstance(body, bytes) else json.dumps(body).encode()
        self.send_response(status)
        self.send_header("Content-Type", media_type)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(body[: int(len(body) * part)])
        self.wfile.flush()
        self.close_connection = True

    def do_GET(self):
        self.answered("FIND", b"")

    def do_POST(self):
        self.answered("STORE", self.rfile.read(int(self.headers["Content-Length"])))

    def answered(self, kind, body):
        _, house, _, services = self.path.split("/", 3)
        fault = fault_of(house, kind)
        if re.fullmatch("[45][0-9]{2}", fault):
            return self.tell(int(fault), b"the archive says no to 4711", "text/plain")
        if fault in BEFORE:
            return self.struck(house, fault)
        status, answer = self.searched(house, services) if kind == "FIND" else self.stored(house, body, fault)
        if fault in ("kill-torn", "kill-after"):
            die()
        if fault == "hang-after":
            time.sleep(3600)
        self.tell(status, answer, part=0.5 if fault in ("cut-after", "kill-half") else 1.0)
        if fault == "kill-half":
            die()

    def struck(self, house, fault):
        """Nothing is done, and this is told."""
        self.close_connection = True
        if fault == "kill-before":
            die()
        elif fault == "hang-before":
            time.sleep(3600)
        elif fault == "garbage":
            self.tell(200, b"<html>Log in to the network of the hospital</html>", "text/html")
        elif fault in ("drip", "huge"):
            self.send_response(200)
            self.send_header("Content-Type", JSON)
            self.send_header("Content-Length", str(100 << 20))
            self.end_headers()
            if fault == "huge":
                huge(house, self.wfile.write, b" " * (1 << 20))
            while fault == "drip":
                self.wfile.write(b" ")
                time.sleep(1)

    def searched(self, house, services):
        asked = re.fullmatch("studies/([0-9.]+)/instances", services)
        objects = found(house, StudyInstanceUID=asked[1]) if asked else []
        tags = {"00080016": "SOPClassUID", "00080018": "SOPInstanceUID", "0020000E": "SeriesInstanceUID"}
        shown = [{tag: {"vr": "UI", "Value": [str(of[name].value)]} for tag, name in tags.items()} for of in objects]
        return 200, shown

    def stored(self, house, body, fault):
        boundary = re.search('boundary="?([^";]+)', self.headers["Content-Type"])[1].encode()
        parts = body.split(b"--" + boundary)[1:-1]
        files = [part.partition(b"\r\n\r\n")[2][:-2] for part in parts]
        refused = []
        for at, file in enumerate(files, 1):
            if fault == "lose" or (fault == "kill-torn" and at > len(files) // 2):
                continue
            if re.fullmatch("[0-9A-F]{4}", fault) and at == len(files):
                refused.append(int(fault, 16))
                continue
            _, reason = keep(house, file)
            refused += [reason] if reason else []
        failed = [{"00081197": {"vr": "US", "Value": [reason]}} for reason in refused]
        status = 200 if not failed else 409 if len(failed) == len(files) else 202
        return status, {"00081198": {"vr": "SQ", "Value": failed}}


# Associations.


class Connection:
    """A connection below the messages of its association."""

    def __init__(self, event):
        self.assoc = event.assoc
        self.socket = event.assoc.dul.socket.socket
        self.context = event.context.context_id

    def packet(self, length, part):
        """A packet with a part of a command that is not its last."""
        head = struct.pack(">BBIIBB", 4, 0, length, length - 4, self.context, 1)
        self.socket.sendall((head + b"\0" * (length - 6))[: part or None])

    def close(self):
        try:
            self.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


def kinds_fault(event, kind):
    house = event.assoc.requestor.primitive.called_ae_title.strip()
    return house, fault_of(house, kind)


def struck_before(event, house, fault):
    """Nothing is done, and this is told. Returns whether that was it."""
    if fault not in BEFORE:
        return False
    connection = Connection(event)
    try:
        if fault == "kill-before":
            die()
        elif fault == "hang-before":
            time.sleep(3600)
        elif fault == "abort":
            event.assoc.abort()
            return True
        elif fault == "garbage":
            connection.socket.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
        elif fault == "huge":
            huge(house, lambda part: connection.packet(len(part), None), b"\0" * (16 << 10))
        while fault == "drip":
            connection.socket.sendall(b"\4")
            time.sleep(1)
    except OSError:
        pass
    connection.close()
    return True


def struck_after(event, fault):
    """What happens once all is done."""
    if fault in ("kill-torn", "kill-after"):
        die()
    elif fault == "hang-after":
        time.sleep(3600)
    elif fault in ("cut-after", "kill-half"):
        connection = Connection(event)
        connection.packet(200, 100)
        if fault == "kill-half":
            die()
        connection.close()


def status_of(fault):
    """The status that the answer has by a fault, or 0."""
    if re.fullmatch("[0-9A-F]{4}", fault):
        return int(fault, 16)
    return UNREADABLE if re.fullmatch("[45][0-9]{2}", fault) else 0


def echoed(event):
    house, fault = kinds_fault(event, "ECHO")
    if not struck_before(event, house, fault):
        struck_after(event, fault)
    return status_of(fault)


def stored(event):
    house, fault = kinds_fault(event, "STORE")
    if struck_before(event, house, fault):
        return UNREADABLE
    status = status_of(fault)
    if not status and fault != "lose":
        _, status = keep(house, event.encoded_dataset())
    struck_after(event, fault)
    return status


def searched(event):
    house, fault = kinds_fault(event, "FIND")
    if struck_before(event, house, fault):
        return
    if status_of(fault):
        yield status_of(fault), None
        return
    asked = event.identifier
    keys = {name: str(asked[name].value) for name in UIDS[2:] if name in asked and asked[name].value}
    # One answer for each study, series or object, with the keys of its level and those above.
    level = asked.QueryRetrieveLevel
    told = {"STUDY": UIDS[3:], "SERIES": UIDS[2:], "IMAGE": UIDS}[level]
    answers = {tuple(str(of[name].value) for name in told) for of in found(house, **keys)}
    struck_after(event, fault)
    for values in sorted(answers):
        answer = Dataset()
        answer.QueryRetrieveLevel = level
        answer.SpecificCharacterSet = "ISO_IR 192"
        for name, value in zip(told, values):
            setattr(answer, name, value)
        yield 0xFF00, answer


def associations():
    archive = AE()
    archive.maximum_associations = 1000
    for context in AllStoragePresentationContexts:
        archive.add_supported_context(context.abstract_syntax, SYNTAXES)
    for service in (Verification, StudyRootQueryRetrieveInformationModelFind):
        archive.add_supported_context(service, SYNTAXES)
    handlers = [(evt.EVT_C_ECHO, echoed), (evt.EVT_C_STORE, stored), (evt.EVT_C_FIND, searched)]
    return archive.start_server((ADDRESS, 0), block=False, evt_handlers=handlers)


def main():
    ThreadingHTTPServer.daemon_threads = True
    web = ThreadingHTTPServer((ADDRESS, 0), Web)
    threading.Thread(target=web.serve_forever, daemon=True).start()
    ports = {"http": web.server_address[1], "dimse": associations().socket.getsockname()[1]}
    with open(path("ports.new"), "w", encoding="utf-8") as file:
        json.dump(ports, file)
    os.rename(path("ports.new"), path("ports"))
    if stat.S_ISFIFO(os.fstat(0).st_mode):
        sys.stdin.buffer.read()
        if os.path.exists(path("temporary")):
            shutil.rmtree(FOLDER, ignore_errors=True)
        # Threads that hang do not keep it.
        os._exit(0)
    threading.Event().wait()


main()
