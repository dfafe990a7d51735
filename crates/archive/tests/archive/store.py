"""moto as a store of objects on the port that is named; it ends with its input."""

import os
import sys

from moto.server import ThreadedMotoServer

ThreadedMotoServer(ip_address="127.0.0.1", port=int(sys.argv[1]), verbose=False).start()
sys.stdin.read()
os._exit(0)
