"""No object that was compiled for some processors alone defines a function that the linker could take for all.

    LIBRARY=build/release/core/libpcm.a python3 -B -m unittest test_levels
"""

import os
import re
import subprocess
import unittest


class Levels(unittest.TestCase):
    def test_objects_of_levels_share_no_function(self):
        listing = subprocess.run(['nm', '--defined-only', os.environ['LIBRARY']], check=True, capture_output=True, text=True)
        members, shared, member = set(), [], ''
        for line in listing.stdout.splitlines():
            if line.endswith('.o:'):
                member = line[:-1]
                if re.search(r'_avx(2|512)\.cpp\.o$', member):
                    members.add(member)
            elif member in members and line and line.split()[-2] in 'WVu':
                shared.append(f'{member}: {line.split()[-1]}')
        self.assertGreaterEqual(len(members), 6)
        self.assertEqual(shared, [], 'weak symbols: a processor without these instructions may run them')


if __name__ == '__main__':
    unittest.main()
