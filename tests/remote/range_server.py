"""A server of files with ranges and entity tags on this machine: with a delay, over TLS, and with signed requests that also write, as S3 has them."""

import datetime
import hashlib
import hmac
import http.server
import pathlib
import re
import ssl
import subprocess
import threading
import time
import urllib.parse


def signing_key(secret, day, region):
    key = ("AWS4" + secret).encode()
    for part in (day, region, "s3", "aws4_request"):
        key = hmac.new(key, part.encode(), hashlib.sha256).digest()
    return key


def refusal_of(request, keys, region):
    """Why a request is not signed as S3 asks for it (AWS signature version 4, header form); None where it is."""
    given = re.fullmatch(r"AWS4-HMAC-SHA256 Credential=(\w+)/(\d{8})/([\w-]+)/s3/aws4_request, ?SignedHeaders=([\w;-]+), ?Signature=([0-9a-f]{64})",
                         request.headers.get("Authorization", ""))
    if not given:
        return "no signature"
    key_id, day, of_region, signed, signature = given.groups()
    if key_id not in keys or of_region != region:
        return "another key or region"
    when = request.headers.get("X-Amz-Date", "")
    now = datetime.datetime.now(datetime.timezone.utc)
    if not when.startswith(day) or abs((datetime.datetime.strptime(when, "%Y%m%dT%H%M%SZ").replace(tzinfo=datetime.timezone.utc) - now).total_seconds()) > 900:
        return "another time"
    # S3 wants these signed: the host and every header of its own.
    wanted = {"host"} | {name.lower() for name in request.headers if name.lower().startswith("x-amz-")}
    if not wanted <= set(signed.split(";")):
        return f"not signed: {wanted - set(signed.split(';'))}"
    headers = "".join(f"{name}:{' '.join(request.headers.get(name, '').split())}\n" for name in signed.split(";"))
    path, _, query = request.path.partition("?")
    path = urllib.parse.quote(urllib.parse.unquote(path), safe="/-._~")
    query = "&".join(sorted(query.split("&")))
    canonical = "\n".join([request.command, path, query, headers, signed, request.headers.get("X-Amz-Content-Sha256", "")])
    text = "\n".join(["AWS4-HMAC-SHA256", when, f"{day}/{region}/s3/aws4_request", hashlib.sha256(canonical.encode()).hexdigest()])
    right = hmac.new(signing_key(keys[key_id], day, region), text.encode(), hashlib.sha256).hexdigest()
    return None if hmac.compare_digest(right, signature) else "a wrong signature"


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def answer(self, status, headers, body=b""):
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        if "Content-Length" not in headers:
            self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def do_PUT(self):
        self.change()

    def do_POST(self):
        self.change()

    def do_DELETE(self):
        self.change()

    def change(self):
        """What S3 does with a request that writes, unless the server's `trouble` makes something else of it."""
        serving = self.server.serving
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        path, _, query = self.path.partition("?")
        query = dict(urllib.parse.parse_qsl(query, keep_blank_values=True))
        serving.requests.append((self.command, self.path, len(body)))
        why = refusal_of(self, serving.keys or {}, serving.region)
        if why is None and hashlib.sha256(body).hexdigest() != self.headers.get("X-Amz-Content-Sha256"):
            why = "another content than the signed one"
        if why is not None:
            serving.refusals.append(why)
            self.answer(403, {}, b"<Error><Code>AccessDenied</Code><Message>You may not &quot;write&quot; here</Message></Error>")
            return
        trouble = serving.trouble(self.command, path, query) if serving.trouble else None
        if trouble == "busy":
            self.answer(503, {}, b"<Error><Code>SlowDown</Code></Error>")
        elif trouble == "late error":  # S3 has begun to answer that all is well
            self.answer(200, {}, b"<?xml?>\n  <Error><Code>InternalError</Code></Error>")
        elif trouble == "cut":
            self.close_connection = True
        else:
            status, headers, answer = serving.bucket.carry_out(self.command, urllib.parse.unquote(path).lstrip("/"), query, body)
            if trouble == "lost answer":
                self.close_connection = True
            else:
                self.answer(status, headers, answer)

    def do_HEAD(self):
        self.do_GET()

    def do_GET(self):
        serving = self.server.serving
        serving.requests.append((self.command, self.path, self.headers.get("Range")))
        if serving.is_away():
            self.close_connection = True
            return
        time.sleep(serving.delay)
        if serving.keys is not None:
            why = refusal_of(self, serving.keys, serving.region)
            if why is not None:
                serving.refusals.append(why)
                self.answer(403, {})
                return
        path = serving.folder / urllib.parse.unquote(self.path).lstrip("/")
        if ".." in path.parts or not path.is_file():
            self.answer(404, {})
            return
        status = path.stat()
        headers = {"ETag": f'"{status.st_mtime_ns:x}-{status.st_size:x}"'}
        if self.headers.get("If-Match", headers["ETag"]) != headers["ETag"]:
            self.answer(412, headers)
            return
        part = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if self.command == "HEAD" or not part:
            self.answer(200, {**headers, "Content-Length": str(status.st_size)}, b"" if self.command == "HEAD" else path.read_bytes())
            return
        first, last = int(part[1]), min(int(part[2]), status.st_size - 1)
        if first > last:
            self.answer(416, {**headers, "Content-Range": f"bytes */{status.st_size}"})
            return
        with path.open("rb") as file:
            file.seek(first)
            body = file.read(last - first + 1)
        self.answer(206, {**headers, "Content-Range": f"bytes {first}-{last}/{status.st_size}"}, body)


class Bucket:
    """Files of a folder as S3 writes them, at once or in parts."""

    def __init__(self, folder):
        self.folder, self.uploads, self.made = folder, {}, 0
        self.lock = threading.Lock()

    def carry_out(self, method, name, query, body):
        with self.lock:
            return self.carry_out_alone(method, name, query, body)

    def carry_out_alone(self, method, name, query, body):
        file = self.folder / name
        if not (self.folder / pathlib.Path(name).parts[0]).is_dir():
            return 404, {}, b"<Error><Code>NoSuchBucket</Code></Error>"
        if method == "POST" and "uploads" in query:
            self.made += 1
            self.uploads[f"id+/{self.made}=="] = {}
            return 200, {}, f"<InitiateMultipartUploadResult><UploadId>id+/{self.made}==</UploadId></InitiateMultipartUploadResult>".encode()
        if "uploadId" in query and query["uploadId"] not in self.uploads:
            return 404, {}, b"<Error><Code>NoSuchUpload</Code></Error>"
        if method == "DELETE" and "uploadId" in query:
            del self.uploads[query["uploadId"]]
            return 204, {}, b""
        if method == "DELETE":
            file.unlink(missing_ok=True)
            return 204, {}, b""
        tag = f'"{hashlib.md5(body).hexdigest()}"'
        if "partNumber" in query:
            self.uploads[query["uploadId"]][int(query["partNumber"])] = (tag, body)
            return 200, {"ETag": tag}, b""
        if method == "POST":
            parts = self.uploads[query["uploadId"]]
            named = re.findall(r"<PartNumber>(\d+)</PartNumber><ETag>([^<]*)</ETag>", body.decode())
            if [(int(number), tag.replace("&quot;", '"')) for number, tag in named] != [(number, parts[number][0]) for number in sorted(parts)]:
                return 400, {}, b"<Error><Code>InvalidPart</Code></Error>"
            body = b"".join(parts[number][1] for number in sorted(parts))
            if any(len(parts[number][1]) < 5 << 20 for number in sorted(parts)[:-1]):
                return 400, {}, b"<Error><Code>EntityTooSmall</Code></Error>"
            del self.uploads[query["uploadId"]]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(body)
        return 200, {"ETag": tag}, b""


class Listener(http.server.ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 64


class RangeServer:
    """Serves `folder`. `keys`: key id -> secret, where requests must be signed; `certificate`: for TLS, as certificate_for() makes it."""

    def __init__(self, folder, delay=0, keys=None, region="us-east-1", certificate=None):
        self.folder, self.delay, self.keys, self.region = pathlib.Path(folder), delay, keys, region
        self.requests, self.refusals = [], []
        self.bucket, self.trouble = Bucket(self.folder), None
        self.is_away = lambda: False  # connections are then closed without an answer
        self.listener = Listener(("127.0.0.1", 0), Handler)
        self.listener.serving = self
        self.scheme = "https" if certificate else "http"
        if certificate:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(certificate)
            self.listener.socket = context.wrap_socket(self.listener.socket, server_side=True)
        threading.Thread(target=self.listener.serve_forever, daemon=True).start()

    def address(self, path=""):
        return f"{self.scheme}://127.0.0.1:{self.listener.server_address[1]}/{path}"

    def stop(self):
        self.listener.shutdown()
        self.listener.server_close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


def certificate_for(folder, name="127.0.0.1"):
    """A file with a key and a certificate of its own for a server of this address."""
    file = pathlib.Path(folder) / "certificate.pem"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", f"/CN={name}",
                    "-addext", f"subjectAltName=IP:{name}", "-keyout", f"{file}.key", "-out", f"{file}.crt"], check=True, capture_output=True)
    file.write_text(pathlib.Path(f"{file}.key").read_text() + pathlib.Path(f"{file}.crt").read_text())
    return file
