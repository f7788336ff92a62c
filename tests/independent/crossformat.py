#!/usr/bin/env python3
"""One cloud in six encodings, as the project reads them: the same points in the same order, to the precision of each.

    crossformat.py --dump DUMP_CLOUD --data FOLDER [--python PYTHON]
"""
import sys

import check

# Half a unit of the last digit of a coordinate, a colour (of 255) and a normal in each encoding; None: not present.
# Single precision near 5 steps by 4.8e-7, near 1 by 1.2e-7.
ENCODINGS = {
    "ripple_bin.ply": (0.0, 0.0, 0.0),
    "ripple_ascii.ply": (2.4e-7, 0.0, 5.1e-7),  # CloudCompare printed six decimals
    "ripple.las": (2.5e-7, 0.0, None),
    "ripple.laz": (2.5e-7, 0.0, None),
    "ripple.pts": (5.1e-5, 0.0, None),  # four decimals
    "ripple.txt": (5.1e-5, 0.0, None),  # its normals are others: they point the other way, and differ along the rim
}


def main():
    arguments = check.common_arguments(__doc__)
    folder = arguments.data / "crossformat"
    if not folder.is_dir():
        check.skip(f"no folder {folder}")
    try:
        import numpy as np

        import compare
    except ImportError as error:
        check.skip(f"{error}; packaging/test-python installs what the comparison needs")

    def colours(cloud):
        values = cloud.attributes["rgb"].values.astype(np.int64)
        # LAS has 16 bits: the 8 of the source, times 256.
        return values >> 8 if cloud.attributes["rgb"].values.dtype == np.uint16 else values

    clouds = {name: compare.read_ours(arguments.dump, folder / name) for name in ENCODINGS}
    reference = clouds["ripple_bin.ply"]
    failed = 0
    print(f"{'encoding':<18} {'points':>7} {'position':>10} {'colour':>7} {'normal':>9}")
    for name, (place, colour, normal) in ENCODINGS.items():
        cloud = clouds[name]
        same = len(cloud.positions) == len(reference.positions) > 0
        errors = [np.inf] * 3
        if same:
            errors[0] = np.abs(cloud.positions - reference.positions).max()
            errors[1] = np.abs(colours(cloud) - colours(reference)).max()
            errors[2] = None
            if normal is not None:
                errors[2] = np.abs(cloud.attributes["normal"].values.astype("f8")
                                   - reference.attributes["normal"].values.astype("f8")).max()
            same = errors[0] <= place and errors[1] <= colour and (normal is None or errors[2] <= normal)
        failed += not same
        print(f"{name:<18} {len(cloud.positions):>7} {errors[0]:>10.2g} {errors[1]:>7} "
              f"{'none' if errors[2] is None else format(errors[2], '.2g'):>9}  {'' if same else 'DIFFERENT'}")
    if (clouds["ripple.las"].grid != clouds["ripple.laz"].grid).any():
        failed += 1
        print("the integers of LAS and LAZ are not the same")
    print("one and the same cloud" if not failed else f"{failed} encodings differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
