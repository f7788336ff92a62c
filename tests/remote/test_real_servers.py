"""Trees on servers that others wrote: nginx (packaging/nginx-program), over HTTP, TLS and HTTP/2, and the buckets of moto (packaging/test-python)."""

import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from command_case import CommandCase
from range_server import certificate_for

BUILD = pathlib.Path(__file__).resolve().parents[2] / "build"
NGINX = BUILD / "nginx" / "usr" / "sbin" / "nginx"
PYTHON = BUILD / "test-python" / "bin" / "python3"
CONFIGURATION = """
daemon off; pid {here}/pid; worker_processes 2;
events {{ worker_connections 512; }}
http {{
    log_format protocols "$server_protocol $request_method $status";
    access_log {here}/log protocols;
    {places}
    gzip on; gzip_min_length 1; gzip_types application/octet-stream text/plain;
    limit_req_zone $binary_remote_addr zone=few:1m rate=2r/s;
    root {root};
    server {{ listen 127.0.0.1:{plain}; listen 127.0.0.1:{tls} ssl http2; ssl_certificate {certificate}; ssl_certificate_key {certificate}; }}
    server {{ listen 127.0.0.1:{busy}; limit_req zone=few; }}
    server {{ listen 127.0.0.1:{whole}; max_ranges 0; }}
}}
"""


def free_ports(count):
    held = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return ports


def wait_for(port, process):
    for _ in range(300):
        if process.poll() is not None:
            break
        try:
            socket.create_connection(("127.0.0.1", port), 1).close()
            return
        except OSError:
            time.sleep(0.1)
    raise AssertionError(f"the server does not answer: {process.stderr.read() if process.poll() is not None else ''}")


class Server(CommandCase):
    @classmethod
    def start(cls, command, port):
        cls.process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        cls.addClassCleanup(cls.process.communicate)
        cls.addClassCleanup(cls.process.terminate)
        wait_for(port, cls.process)

    def assert_same_points(self, tree, **variables):
        """What is there is the tree, and its points come in its order."""
        here, there = self.folder / "here.las", self.folder / "there.las"
        self.answer("convert", self.tree, "-o", here, "--overwrite")
        report = self.answer("convert", tree, "-o", there, "--overwrite", **variables)
        self.assertEqual(here.read_bytes(), there.read_bytes())
        self.assertEqual(self.answer("verify", tree, **variables)["faults"], [])
        return report


@unittest.skipUnless(NGINX.exists(), "nginx is not here: packaging/nginx-program build/nginx fetches it")
class Nginx(Server):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.here = cls.folder / "nginx"
        cls.here.mkdir()
        cls.certificate = certificate_for(cls.folder)
        cls.ports = dict(zip(("plain", "tls", "busy", "whole"), free_ports(4)))
        kinds = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
        places = " ".join(f"{kind}_temp_path {cls.here}/{kind};" for kind in kinds)
        (cls.here / "conf").write_text(CONFIGURATION.format(here=cls.here, places=places, root=cls.folder, certificate=cls.certificate, **cls.ports))
        os.chmod(cls.folder, 0o755)  # it serves as another user
        cls.start([NGINX, "-e", cls.here / "errors", "-p", cls.here, "-c", cls.here / "conf"], cls.ports["plain"])

    def address(self, server, scheme="http"):
        return f"{scheme}://127.0.0.1:{self.ports[server]}/site.pct"

    def requests(self):
        return (self.here / "log").read_text().splitlines()

    def test_a_tree_is_read(self):
        before = len(self.requests())
        report = self.assert_same_points(self.address("plain"))
        self.assertGreaterEqual(len(self.requests()) - before, report["requests"])
        self.assertTrue(all(" 206" in line or " HEAD 200" in line for line in self.requests()[before:]))

    def test_tls_and_its_second_version_of_http(self):
        before = len(self.requests())
        self.assert_same_points(self.address("tls", "https"), CURL_CA_BUNDLE=f"{self.certificate}.crt", SSL_CERT_FILE=f"{self.certificate}.crt")
        self.assertIn("HTTP/2.0 GET 206", self.requests()[before:])
        unknown = self.run_command("info", self.address("tls", "https"))
        self.assertEqual(unknown.returncode, 1)
        self.assertIn("certificate", unknown.stderr)

    def test_a_server_that_is_too_busy_for_some_requests_gives_every_point(self):
        before = len(self.requests())
        self.assert_same_points(self.address("busy"))
        self.assertTrue(any(line.endswith(" 503") for line in self.requests()[before:]))

    def test_a_server_without_ranges_is_refused(self):
        run = self.run_command("info", self.address("whole"))
        self.assertEqual(run.returncode, 1)
        self.assertIn("sends whole files only", run.stderr)

    def test_a_tree_that_is_not_there(self):
        run = self.run_command("info", self.address("plain").replace("site", "other"))
        self.assertEqual(run.returncode, 1)
        self.assertIn("there is no point cloud tree at this address", run.stderr)


@unittest.skipUnless((PYTHON.parent / "moto_server").exists(), "moto is not here: packaging/test-python installs it")
class Moto(Server):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.port = free_ports(1)[0]
        cls.start([PYTHON.parent / "moto_server", "-H", "127.0.0.1", "-p", cls.port], cls.port)
        cls.s3("client.create_bucket(Bucket='scans')")

    @classmethod
    def place(cls):
        return {"AWS_ENDPOINT_URL": f"http://127.0.0.1:{cls.port}", "AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_REGION": "us-east-1"}

    @classmethod
    def s3(cls, text):
        """What the text prints in Python, with a client of Amazon's own library."""
        run = subprocess.run([PYTHON, "-c", f"import boto3; client = boto3.client('s3', region_name='us-east-1'); {text}"],
                             env={**os.environ, **cls.place()}, capture_output=True, text=True, check=True)
        return run.stdout

    def run_command(self, *arguments, **variables):
        return super().run_command(*arguments, **{**self.place(), **variables})

    def test_a_tree_is_built_into_a_bucket_and_read_again(self):
        self.answer("build", self.folder / "site.pct.las", "-o", "s3://scans/2026/site.pct")
        self.assert_same_points("s3://scans/2026/site.pct")
        listed = self.s3("print(*(f\"{one['Key']} {one['Size']}\" for one in client.list_objects_v2(Bucket='scans', Prefix='2026/')['Contents']), sep='\\n')")
        here = {f"2026/site.pct/{file.name} {file.stat().st_size}" for file in self.tree.iterdir() if file.name != "lock"}
        self.assertEqual(set(listed.split("\n")) - {""}, here)
        self.assertEqual(self.s3("print(client.list_multipart_uploads(Bucket='scans').get('Uploads', []))").strip(), "[]")

    def test_a_tree_that_is_there_is_replaced_when_asked(self):
        self.answer("convert", self.tree, "-o", "s3://scans/site.pct", "--max-points", "100000")
        self.assertEqual(self.run_command("convert", self.tree, "-o", "s3://scans/site.pct").returncode, 1)
        self.answer("convert", self.tree, "-o", "s3://scans/site.pct", "--overwrite")
        self.assert_same_points("s3://scans/site.pct")

    def test_a_bucket_that_is_not_there(self):
        run = self.run_command("convert", self.tree, "-o", "s3://other/site.pct")
        self.assertEqual(run.returncode, 1)
        self.assertIn("the server has no such bucket", run.stderr)


if __name__ == "__main__":
    unittest.main()
