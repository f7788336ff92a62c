"""Both plugins for PyMeshLab in one file, in a folder without another of ours, and files that PyMeshLab is to refuse."""
import shutil
import subprocess
import sys
import unittest

import pymeshlab_session as session
from pymeshlab_session import BUILD, FILTER, IO, PyMeshLabTest, pcmlab

if __name__ == "__main__" and "--in-pymeshlab" not in sys.argv:
    session.go_on_in_pymeshlab(__file__)

FILE = BUILD / "second" / "whole" / "pcm_point_clouds.so"
REFUSED = BUILD / "second" / "refused"


class OneFile(PyMeshLabTest):
    def run_alone(self, text):
        """What a process of its own prints, without any of our plugins."""
        done = subprocess.run([sys.executable, "-c", "import pymeshlab\n" + text], capture_output=True, text=True, timeout=300)
        return done.stdout + done.stderr, done.returncode

    def refused(self, *files):
        """What PyMeshLab says about the last of the files."""
        loads = "".join(f"pymeshlab.load_plugin('{file}')\n" for file in files[:-1])
        text, code = self.run_alone(f"""{loads}
try:
    pymeshlab.load_plugin('{files[-1]}')
    print('loaded')
except pymeshlab.PyMeshLabException as error:
    print(error)
meshes = pymeshlab.MeshSet()
meshes.create_cube()
""")
        self.assertEqual(code, 0, text)
        return text

    def test_alone_in_a_folder(self):
        shutil.copy(FILE, self.folder)
        las = self.generated()
        text, code = self.run_alone(f"""
pymeshlab.load_plugin('{self.folder / FILE.name}')
meshes = pymeshlab.MeshSet()
built = meshes.apply_filter('build_point_cloud_tree', inputs='{las}', output='city.pct')
assert built['points'] == 60000, built
meshes.apply_filter('remove_outliers_of_point_cloud_tree', output='clean.pct')
meshes.save_current_mesh('clean.las')
""")
        self.assertEqual((text, code), ("", 0))
        pcmlab("build", las, "-o", "city2.pct")
        pcmlab("outliers", "city2.pct", "-o", "clean2.pct")
        self.assertEqual(pcmlab("info", "clean.las")["points"], pcmlab("info", "clean2.pct")["points"])

    def test_it_needs_what_pymeshlab_and_the_system_bring_and_dxflib(self):
        dynamic = subprocess.run(["readelf", "--wide", "--dynamic", str(FILE)], capture_output=True, text=True, check=True).stdout
        needed = sorted(line.split("[")[1].split("]")[0] for line in dynamic.splitlines() if "(NEEDED)" in line)
        brought = ("libdxflib", "libmeshlab-common.so", "libQt5", "libstdc++", "libgcc_s", "libm.", "libc.", "ld-linux")
        self.assertEqual([name for name in needed if not name.startswith(brought)], [])

    def test_a_second_one_is_refused(self):
        for files in ((FILE, IO), (FILE, FILTER), (IO, FILE)):
            self.assertIn("loaded already, from another file", self.refused(*files), files)

    def test_what_does_not_fit_is_refused_by_name(self):
        for name, reason in {"version": "different version", "scalar": "different floating point precision",
                             "symbol": "pcm_that_is_nowhere"}.items():
            text = self.refused(REFUSED / f"refused_{name}.so")
            self.assertIn(f"refused_{name}.so", text)
            self.assertIn(reason, text)


if __name__ == "__main__":
    sys.argv.remove("--in-pymeshlab")
    unittest.main(verbosity=2)
