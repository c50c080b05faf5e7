"""Makes a volume of an image of SimpleITK: `python3 volume_of_simpleitk.py scan.nrrd 300 bone.stl`.

Not tested: no Debian release has SimpleITK. Both worlds are LPS, and both arrays run z, y, x.
"""

import sys

import cubewright as cw
import numpy as np


def volume_of(image):
    """Returns a cubewright.Volume of an image of SimpleITK. It shares the image's memory, which must outlive it."""
    import SimpleITK

    affine = np.eye(4)
    affine[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing()
    affine[:3, 3] = image.GetOrigin()
    voxels = SimpleITK.GetArrayViewFromImage(image)
    return cw.Volume(voxels, affine=affine, components=image.GetNumberOfComponentsPerPixel() > 1)


if __name__ == "__main__":
    import SimpleITK

    path, iso, output = sys.argv[1:]
    surface = cw.extract(volume_of(SimpleITK.ReadImage(path)), float(iso))
    cw.write(output, surface)
    print(surface)
