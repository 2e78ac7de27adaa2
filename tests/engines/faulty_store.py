"""A store with faults, in front of one without: what clients of it must live with.

- Puts fail (500, 503), before they are done or after; come late; are done twice.
- Listings tell what there was some seconds ago: new objects are missing, removed ones are there.
"""

import collections
import http.client
import http.server
import itertools
import random
import sys
import threading
import time
import urllib.parse
from xml.sax.saxutils import escape

# How old a listing is, s.
DELAY = 6
FAULTS = ["refused", "lost", "twice", "late"]


class FaultyStore(http.server.ThreadingHTTPServer):
    """Passes requests on to the server at `address`, with faults; `s3` is a client of that server."""

    daemon_threads = True

    def __init__(self, address, s3, bucket):
        super().__init__(("127.0.0.1", 0), Handler)
        self.behind = address.removeprefix("http://")
        self.address = f"http://127.0.0.1:{self.server_address[1]}"
        self.s3, self.bucket = s3, bucket
        self.random, self.faults = random.Random(2), itertools.cycle(FAULTS)
        self.counts = collections.Counter()
        self.snapshots = collections.deque([(time.monotonic(), {})])
        self.open = True
        self.memory = threading.Thread(target=self.remember, daemon=True)
        self.memory.start()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def handle_error(self, request, client_address):
        """A client that does not wait for its answer is none of our faults."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)

    def close(self):
        """Ends it."""
        self.open = False
        self.shutdown()
        self.memory.join()

    def remember(self):
        """Keeps what there is, every half second."""
        while self.open:
            found = {}
            for page in self.s3.get_paginator("list_objects_v2").paginate(Bucket=self.bucket):
                found.update({item["Key"]: item for item in page.get("Contents", [])})
            self.snapshots.append((time.monotonic(), found))
            while self.snapshots[1][0] < time.monotonic() - DELAY:
                self.snapshots.popleft()
            time.sleep(0.5)

    def listing(self, prefix, delimiter):
        """What a client is told that there is."""
        self.counts["listings"] += 1
        old, now = self.snapshots[0][1], self.snapshots[-1][1]
        keys = [key for key in sorted(old) if key.startswith(prefix)]
        self.counts["stale listings"] += keys != [key for key in sorted(now) if key.startswith(prefix)]
        contents, folders = [], {}
        for key in keys:
            rest = key[len(prefix) :]
            if delimiter and delimiter in rest:
                folders[prefix + rest.split(delimiter)[0] + delimiter] = True
            else:
                contents.append(old[key])
        return LISTING.format(
            bucket=self.bucket,
            prefix=escape(prefix),
            count=len(contents) + len(folders),
            contents="".join(
                CONTENTS.format(
                    key=escape(item["Key"]),
                    time=item["LastModified"].strftime("%Y-%m-%dT%H:%M:%S.000Z"),
                    etag=escape(item["ETag"]),
                    size=item["Size"],
                )
                for item in contents
            ),
            folders="".join(FOLDER.format(prefix=escape(folder)) for folder in folders),
        ).encode()


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def handle_any(self):
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        url = urllib.parse.urlsplit(self.path)
        query = urllib.parse.parse_qs(url.query, keep_blank_values=True)
        if self.command == "GET" and "list-type" in query:
            prefix, delimiter = (query.get(name, [""])[0] for name in ["prefix", "delimiter"])
            return self.answer(200, {"Content-Type": "application/xml"}, self.server.listing(prefix, delimiter))
        fault = None
        if self.command in ["PUT", "POST"] and self.server.random.random() < 0.4:
            fault = next(self.server.faults)
            self.server.counts[fault] += 1
        if fault == "refused":
            return self.refuse()
        if fault == "late":
            time.sleep(self.server.random.uniform(0.5, 2))
        if fault == "twice":
            self.pass_on(body)
        answer = self.pass_on(body)
        return self.refuse() if fault == "lost" else self.answer(*answer)

    do_GET = do_PUT = do_POST = do_DELETE = do_HEAD = handle_any

    def pass_on(self, body):
        connection = http.client.HTTPConnection(self.server.behind)
        connection.request(self.command, self.path, body, dict(self.headers))
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, dict(answer.getheaders()), content

    def refuse(self):
        self.answer(self.server.random.choice([500, 503]), {}, b"")

    def answer(self, status, headers, content):
        self.send_response_only(status)
        for name, value in headers.items():
            if name.lower() not in ["content-length", "transfer-encoding", "connection"]:
                self.send_header(name, value)
        length = headers.get("Content-Length", "0") if self.command == "HEAD" else str(len(content))
        self.send_header("Content-Length", length)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def log_message(self, *_):
        pass


LISTING = """<?xml version="1.0" encoding="UTF-8"?>
<ListBucketResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/"><Name>{bucket}</Name><Prefix>{prefix}</Prefix>\
<KeyCount>{count}</KeyCount><MaxKeys>1000</MaxKeys><IsTruncated>false</IsTruncated>{contents}{folders}\
</ListBucketResult>"""
CONTENTS = """<Contents><Key>{key}</Key><LastModified>{time}</LastModified><ETag>{etag}</ETag>\
<Size>{size}</Size><StorageClass>STANDARD</StorageClass></Contents>"""
FOLDER = "<CommonPrefixes><Prefix>{prefix}</Prefix></CommonPrefixes>"
