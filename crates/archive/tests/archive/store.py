"""moto as a store of objects on the port that is named; where port, certificate and key are named as well, by TLS on
that port, too. It ends with its input."""

import os
import ssl
import sys
import threading

from moto.moto_server.werkzeug_app import MotoRequestHandler
from moto.server import DomainDispatcherApplication, ThreadedMotoServer, create_backend_app
from werkzeug.serving import make_server

ThreadedMotoServer(ip_address="127.0.0.1", port=int(sys.argv[1]), verbose=False).start()
if sys.argv[2:]:
    port, certificate, key = sys.argv[2:]
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    app = DomainDispatcherApplication(create_backend_app)
    server = make_server("127.0.0.1", int(port), app, threaded=True, request_handler=MotoRequestHandler)
    # Each handshake has a thread of its own: a client whose line hangs keeps no other waiting.
    server.socket = context.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    server.ssl_context = context
    threading.Thread(target=server.serve_forever, daemon=True).start()
sys.stdin.read()
os._exit(0)
