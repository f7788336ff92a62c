"""A server of files with ranges and entity tags on this machine: with a delay, over TLS, and with signed requests, as S3 has them."""

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
    path = urllib.parse.quote(urllib.parse.unquote(request.path), safe="/-._~")
    canonical = "\n".join([request.command, path, "", headers, signed, request.headers.get("X-Amz-Content-Sha256", "")])
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

    def do_HEAD(self):
        self.do_GET()

    def do_GET(self):
        serving = self.server.serving
        serving.requests.append((self.command, self.path, self.headers.get("Range")))
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


class Listener(http.server.ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 64


class RangeServer:
    """Serves `folder`. `keys`: key id -> secret, where requests must be signed; `certificate`: for TLS, as certificate_for() makes it."""

    def __init__(self, folder, delay=0, keys=None, region="us-east-1", certificate=None):
        self.folder, self.delay, self.keys, self.region = pathlib.Path(folder), delay, keys, region
        self.requests, self.refusals = [], []
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
