"""Makes a volume of a nibabel image: `python3 volume_of_nibabel.py scan.nii.gz 300 bone.stl`.

nibabel's arrays run x, y, z and its world is RAS+; here arrays run z, y, x and the world is LPS. Voxels keep their
type, and the scaling of the file becomes slope and intercept. Tried with nibabel 5.0.
"""

import sys

import cubewright as cw
import numpy as np

UNITS = {"meter": 1000.0, "mm": 1.0, "micron": 0.001}


def volume_of(image, step=0):
    """Returns a cubewright.Volume of an image of nibabel; step: of one with several."""
    proxy = image.dataobj
    has_scaling = hasattr(proxy, "get_unscaled")  # of a file: not of an image made of an array
    voxels = np.asanyarray(proxy.get_unscaled() if has_scaling else proxy)
    while voxels.ndim > 3:
        voxels = voxels[..., step if voxels.ndim == 4 else 0]
    unit = image.header.get_xyzt_units()[0] if hasattr(image.header, "get_xyzt_units") else "mm"
    to_mm = np.diag([UNITS.get(unit, 1.0)] * 3 + [1.0])
    affine = np.diag([-1.0, -1.0, 1.0, 1.0]) @ to_mm @ image.affine
    scaling = {"slope": proxy.slope, "intercept": proxy.inter} if has_scaling else {}
    return cw.Volume(voxels.T, affine=affine, **scaling)


if __name__ == "__main__":
    import nibabel

    path, iso, output = sys.argv[1:]
    surface = cw.extract(volume_of(nibabel.load(path)), float(iso))
    cw.write(output, surface)
    print(surface)
