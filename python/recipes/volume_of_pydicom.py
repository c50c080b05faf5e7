"""Makes a volume of datasets of pydicom: `python3 volume_of_pydicom.py FOLDER 300 bone.stl`.

The slices may come in any order. They are sorted along their normal, and have to lie at even distances; read_volume()
also sorts out several series in a folder. Tried with pydicom 2.3.
"""

import pathlib
import sys

import cubewright as cw
import numpy as np


def volume_of(datasets):
    """Returns a cubewright.Volume of the slices of one series: LPS millimetres, in Hounsfield units of a CT."""
    along_row, along_column = np.array(datasets[0].ImageOrientationPatient, float).reshape(2, 3)
    normal = np.cross(along_row, along_column)
    places = np.array([each.ImagePositionPatient for each in datasets], float)
    order = np.argsort(places @ normal)
    places = places[order]
    steps = np.diff(places @ normal)
    if len(steps) and not np.allclose(steps, steps.mean(), rtol=0.01):
        raise ValueError(f"slices lie {steps.min():g} to {steps.max():g} mm apart: some are missing, or of other series")
    first = datasets[order[0]]
    down, across = map(float, first.PixelSpacing)
    affine = np.eye(4)
    affine[:3, 0] = along_row * across
    affine[:3, 1] = along_column * down
    affine[:3, 2] = (places[-1] - places[0]) / len(steps) if len(steps) else normal
    affine[:3, 3] = places[0]
    scalings = {(float(each.get("RescaleSlope", 1)), float(each.get("RescaleIntercept", 0))) for each in datasets}
    voxels = np.stack([datasets[n].pixel_array for n in order])
    if len(scalings) > 1:  # as of PET: each slice has its own
        values = [float(datasets[n].RescaleSlope) * voxels[k] + float(datasets[n].RescaleIntercept) for k, n in enumerate(order)]
        return cw.Volume(np.stack(values).astype("f4"), affine=affine)
    slope, intercept = scalings.pop()
    return cw.Volume(voxels, affine=affine, slope=slope, intercept=intercept)


if __name__ == "__main__":
    import pydicom

    folder, iso, output = sys.argv[1:]
    slices = [pydicom.dcmread(path) for path in pathlib.Path(folder).iterdir()]
    surface = cw.extract(volume_of(slices), float(iso))
    cw.write(output, surface)
    print(surface)
