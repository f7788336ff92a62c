#!/usr/bin/env python3
"""Writes clouds with pcmlab and opens the files with the readers of others: the numbers must be those of the cloud.

    exports.py READER --pcmlab PCMLAB --dump DUMP_CLOUD --data FOLDER [--python PYTHON] [--only TEXT] [--all]

READER is one of laspy, plyfile, pypcd4, text, pymeshlab, open3d, meshlab (stock MeshLab, by meshlabserver) and pcl (PCL's
tools). The clouds are made here, of every kind of number that an export has to decide about, and some samples in FOLDER
are added, or with --all every one up to 1.5 MB. What the cloud has is what dump_cloud says of the source; that this is right
is checked by check.py. Open3D and PCL's tools are large, and tested where they are installed: pip install open3d in PYTHON's
environment, which needs libusb-1.0-0; apt-get install pcl-tools.

Prints a table. The exit code is 0 when all is equal, 1 when not, 77 (skipped) where the reader is not there.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

from check import clouds_of, common_arguments, skip

# Modules and programs that a reader needs beside numpy.
NEEDS = {"laspy": ["laspy", "laszip"], "plyfile": ["plyfile"], "pypcd4": ["pypcd4"], "text": [], "pymeshlab": ["pymeshlab"],
         "open3d": ["open3d"], "meshlab": ["plyfile"], "pcl": ["pypcd4"]}
PROGRAMS = {"meshlab": ["meshlabserver", "xvfb-run"], "pcl": ["pcl_convert_pcd_ascii_binary", "pcl_add_gaussian_noise"]}
LARGEST_SAMPLE = 1_500_000  # bytes
SAMPLES = ("las/1.0_1.las", "las/extrabytes.las", "las/pdrf8-1.4.laz", "las/simple.laz", "ptx/1.2-with-color.ptx",
           "e57/A_B.e57", "pcd/colored_cloud.pcd", "primitives/sac_plane_test.pcd", "ply/text_extradim.ply",
           "ply/open3d_frag001_double_normals_rgb.ply")


class Unsupported(Exception):
    pass


def convert(arguments, source, output, *options):
    """Returns the largest position error that pcmlab states."""
    done = subprocess.run([arguments.pcmlab, "convert", source, output, "--overwrite", "--json", *options],
                          capture_output=True, text=True, timeout=120)
    if "this build does not support LAZ" in done.stderr:
        raise Unsupported
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip())
    return json.loads(done.stdout)["position_error"]


def main():
    def add(parser):
        parser.add_argument("reader", choices=NEEDS)
        parser.add_argument("--pcmlab", required=True)
        parser.add_argument("--only", default="", help="only sources with this text in their name")
        parser.add_argument("--all", action="store_true", help="all samples")

    arguments = common_arguments(__doc__, add)
    for program in PROGRAMS.get(arguments.reader, []):
        if not shutil.which(program):
            skip(f"{program} is not installed")
    try:
        for module in ["numpy", *NEEDS[arguments.reader]]:
            __import__(module)
    except (ImportError, OSError) as error:
        skip(f"{error}; packaging/test-python installs what is small")
    import export_clouds
    import export_readers
    from compare import read_ours

    failed = files = 0
    with tempfile.TemporaryDirectory(prefix="pcm-exports-") as name:
        folder = pathlib.Path(name)
        sources = export_clouds.make(folder)
        samples = [arguments.data / name for name in SAMPLES]
        if arguments.all:
            samples = clouds_of(arguments.data, (".las", ".ply", ".pcd", ".ptx", ".e57", ".laz"))
        sources += [path for path in samples if path.exists() and path.stat().st_size < LARGEST_SAMPLE]
        for source in sources:
            if arguments.only not in str(source):
                continue
            try:
                truth = read_ours(arguments.dump, source)
            except RuntimeError as error:
                print(f"{source.name}: not read: {error}")  # a build without LAZ and E57
                continue
            for extension, options, check in export_readers.EXPORTS[arguments.reader]:
                output = folder / f"out{extension}"
                try:
                    found = check(output, truth, convert(arguments, source, output, *options), options)
                except Unsupported:  # a build without LAZ
                    continue
                except Exception as error:  # whatever a reader of others throws is a line of the table
                    found = [f"{type(error).__name__}: {error}"]
                files += 1
                failed += bool(found)
                if found or not arguments.only:
                    print(f"{source.name:<40} {' '.join([extension, *options]):<28} {'DIFFERENT' if found else 'equal'}")
                for difference in found:
                    print(f"    {difference}")
    print(f"{files - failed} of {files} files equal")
    return 1 if failed or not files else 0


if __name__ == "__main__":
    sys.exit(main())
