"""moto as a store of objects: makes some buckets, writes its port to the file that is named, and ends with its input.

Names of the buckets: archive-0, archive-1, ...
"""

import os
import sys

import boto3
from moto.server import ThreadedMotoServer

BUCKETS = 20

server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
server.start()
port = server.get_host_and_port()[1]
s3 = boto3.client(
    "s3",
    endpoint_url=f"http://127.0.0.1:{port}",
    aws_access_key_id="key",
    aws_secret_access_key="word",
    region_name="us-east-1",
)
for number in range(BUCKETS):
    s3.create_bucket(Bucket=f"archive-{number}")
with open(sys.argv[1] + ".new", "w") as file:
    file.write(str(port))
os.rename(sys.argv[1] + ".new", sys.argv[1])
sys.stdin.read()
os._exit(0)
