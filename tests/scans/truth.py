"""Makes truth.tsv: what other people's readers say of the real scans.

    /usr/bin/python3 truth.py [--data FOLDER] [--only PART-OF-A-PATH] >truth.tsv

Debian packages: python3-nibabel (NIfTI), python3-pydicom (DICOM), python3-tifffile and
python3-pil (TIFF), python3-mrcfile (MRC), python3-vtk9 (NRRD, MetaImage, legacy VTK, .vti, and
every surface), python3-numpy. Nothing of cubewright is used. Raw bytes and INRIMAGE are read by
numpy alone; the frames of NRRD and MetaImage are taken from their headers' text.

A row is a volume, and its surfaces at the levels that the data's README names:

    reader    as 'cubewright formats' names the format; slices: numbered raw files
    path      below the data folder, or a pattern
    options   for reading it
    check     full: all is compared; resampled: slices are made up between the file's, see
              compare.awk; refused: extraction must stop with exit 4 and name --gaps
    iso       levels
    box       indices, ends included
    dims type spacing unit frame
    affine    index to LPS mm, three rows of four
    last      where the last voxel is, LPS mm
    min max mean   of all voxels, scaled
    probe     the mean of the box, which no mirrored or transposed reading of the volume has

and for each level, apart by semicolons, of vtkFlyingEdges3D's surface of the same samples, its
points mapped through the affine in double precision:

    area      mm2
    bounds    x y z of the low corner, x y z of the high one, LPS mm
    edges     how many have one triangle: where the surface meets the volume's border

A star stands for what cannot be told.
"""
import argparse
import os
import itertools
import math
import re
import sys
import zlib
from glob import glob
from pathlib import Path

import mrcfile
import nibabel
import numpy as np
import PIL.Image
import pydicom
import tifffile
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNrrdReader
from vtkmodules.vtkIOLegacy import vtkStructuredPointsReader
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

LPS_FROM_RAS = np.diag([-1.0, -1, 1])
MM_PER_ANGSTROM = 1e-7


class Volume:
    """Samples as stored, [k, j, i]; value = slope * sample + intercept; affine to LPS mm."""

    def __init__(
        self, samples, affine, unit="unknown", frame="unknown", slope=1.0, intercept=0.0
    ):
        self.samples = np.ascontiguousarray(samples).astype(samples.dtype.newbyteorder("="))
        self.affine = np.array(affine, float)
        self.unit, self.frame = unit, frame
        self.slope, self.intercept = float(slope), float(intercept)

    def value(self, sample):
        return self.slope * float(sample) + self.intercept

    def mean(self, samples):
        whole = samples.dtype.kind in "iub"
        total = (
            int(samples.sum(dtype=np.int64)) if whole else math.fsum(samples.ravel().tolist())
        )
        return self.value(total / samples.size)


def scaled(spacing, origin=(0, 0, 0)):
    return np.column_stack([np.diag(spacing), origin])


# --- readers ----------------------------------------------------------------------------------


def nifti(path, step=0):
    image = nibabel.load(path)
    header = image.header
    slope, intercept = header.get_slope_inter()
    samples = np.asarray(image.dataobj.get_unscaled())
    samples = samples[..., step] if samples.ndim == 4 else samples
    known = header["sform_code"] > 0 or header["qform_code"] > 0
    unit = header.get_xyzt_units()[0]
    assert unit in ("mm", "unknown")
    return Volume(
        samples.T,
        LPS_FROM_RAS @ image.affine[:3],
        unit,
        "LPS" if known else "unknown",
        1 if slope is None else slope,
        intercept or 0,
    )


def from_vtk(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    samples = vtk_to_numpy(image.GetPointData().GetScalars())
    assert image.GetExtent()[::2] == (0, 0, 0)
    turn = np.array(
        [[image.GetDirectionMatrix().GetElement(r, c) for c in range(3)] for r in range(3)]
    )
    affine = np.column_stack([turn @ np.diag(image.GetSpacing()), image.GetOrigin()])
    return Volume(samples.reshape(image.GetDimensions()[::-1]), affine)


def nrrd(path):
    volume = from_vtk(vtkNrrdReader(), path)
    header = Path(path).read_bytes().split(b"\n\n")[0].decode()
    field = dict(re.findall(r"^([a-z ]+): (.*)$", header, re.M))
    numbers = lambda key: [float(n) for n in re.findall(r"[-+.\deE]+", field[key])]
    assert field["space"] == "left-posterior-superior"
    axes = np.array(numbers("space directions")).reshape(3, 3)
    volume.affine = np.column_stack([axes.T, numbers("space origin")])
    volume.unit, volume.frame = "mm", "LPS"
    return volume


def metaimage(path):
    """Header by VTK, voxels by numpy and zlib, which VTK must confirm. It does so but for the
    frog: there VTK 9.1 stops inflating before the end of the stream, which is whole and bears a
    checksum, and leaves the last million voxels as the memory was."""
    volume = from_vtk(vtkMetaImageReader(), path)
    header, local = Path(path).read_bytes().split(b"ElementDataFile = ", 1)
    side, local = local.split(b"\n", 1)
    field = dict(re.findall(r"^(\w+) = (.*)$", header.decode(), re.M))
    data = local if side == b"LOCAL" else path.with_name(side.decode()).read_bytes()
    if field.get("CompressedData") == "True":
        data = zlib.decompress(data)
    read = volume.samples
    volume.samples = np.frombuffer(data, read.dtype).reshape(read.shape)
    assert np.array_equal(volume.samples, read) or path.stem == "frogtissue"
    assert field.get("TransformMatrix", "1 0 0 0 1 0 0 0 1") == "1 0 0 0 1 0 0 0 1"
    numbers = lambda key, default: [float(n) for n in field.get(key, default).split()]
    stated = scaled(numbers("ElementSpacing", "1 1 1"), numbers("Offset", "0 0 0"))
    assert np.allclose(volume.affine, stated, rtol=1e-9)
    volume.unit, volume.frame = "mm", "LPS"  # ITK's, and so MetaImage's
    return volume


def vtk(path):
    return from_vtk(vtkStructuredPointsReader(), path)


def vti(path):
    return from_vtk(vtkXMLImageDataReader(), path)


def mrc(path):
    """Axes in the order X, Y, Z of the cell; a along x, b in the plane of x and y."""
    with mrcfile.open(path) as file:
        h, samples = file.header, file.data.copy()
    # the axis along columns, rows, sections
    stored = [int(h[n]) - 1 for n in ("mapc", "mapr", "maps")]
    start = np.zeros(3)
    start[stored] = [int(h[n]) for n in ("nxstart", "nystart", "nzstart")]
    assert h.origin.tolist() == (0, 0, 0)
    samples = samples.transpose([2 - stored.index(axis) for axis in (2, 1, 0)])
    a, b, c = (float(n) for n in h.cella.tolist())
    alpha, beta, gamma = np.radians(h.cellb.tolist())
    cx, cy = math.cos(beta), (math.cos(alpha) - math.cos(beta) * math.cos(gamma)) / math.sin(
        gamma
    )
    cell = np.array(
        [
            [a, 0, 0],
            [b * math.cos(gamma), b * math.sin(gamma), 0],
            [c * cx, c * cy, c * math.sqrt(1 - cx * cx - cy * cy)],
        ]
    ).T
    axes = cell / [int(h.mx), int(h.my), int(h.mz)] * MM_PER_ANGSTROM
    return Volume(samples, np.column_stack([axes, axes @ start]), "mm")


def inr(path):
    data = Path(path).read_bytes()
    field = dict(re.findall(r"^(\w+)=(.*)$", data[:256].decode(), re.M))
    assert (field["TYPE"], field["PIXSIZE"], field["CPU"]) == ("float", "32 bits", "decm")
    size = [int(field[n]) for n in ("ZDIM", "YDIM", "XDIM")]
    samples = np.frombuffer(data, "<f4", math.prod(size), 256).reshape(size)
    return Volume(samples, scaled([float(field[n]) for n in ("VX", "VY", "VZ")]))


def brainsmall(path):
    samples = np.fromfile(path, "u1", offset=62).reshape(84, 128, 128)
    return Volume(samples, scaled((1, 1, 1.5)), "mm")


def quarters(pattern):
    paths = sorted(glob(str(pattern)), key=lambda p: int(p.rsplit(".", 1)[1]))
    slices = [np.fromfile(p, "<u2").reshape(64, 64) for p in paths]
    return Volume(np.stack(slices), scaled((1, 1, 1)))


def tiff_pages(path):
    """By tifffile, and by PIL, which also knows G4; where both can, they must agree."""
    file = tifffile.TiffFile(path)
    with PIL.Image.open(path) as image:
        assert image.n_frames == len(file.pages)
        pages = []
        for n in range(image.n_frames):
            image.seek(n)
            pages.append(np.array(image))  # mode 1: True is white, whatever the photometric
    pages = np.stack(pages)
    if file.pages[0].compression != tifffile.COMPRESSION.CCITT_T6:
        assert np.array_equal(pages, np.stack([page.asarray() for page in file.pages]))
    return pages.astype(np.uint8)


def tiff(path):
    return Volume(tiff_pages(path), scaled((1, 1, 1)))


def mouse(path):
    """A page a file, whose names hold numbers of the same width."""
    folder = path if path.is_dir() else path.parent
    pages = [tiff_pages(p) for p in sorted(folder.glob("*.tif"))]
    return Volume(np.concatenate(pages), scaled((0.1411, 0.1411, 0.1409)), "mm")


class Series:
    """A folder of single-frame DICOM files, in the order of their places along the normal."""

    def __init__(self, folder):
        files = [pydicom.dcmread(p) for p in sorted(glob(f"{folder}/*.dcm"))]
        of = lambda key: {str(f.get(key)) for f in files}
        for key in (
            "SeriesInstanceUID ImageOrientationPatient PixelSpacing Rows Columns RescaleSlope "
            "RescaleIntercept PixelRepresentation BitsAllocated"
        ).split():
            assert len(of(key)) == 1, key
        one = files[0]
        row, column = np.array(one.ImageOrientationPatient, float).reshape(2, 3)
        place = lambda f: np.array([float(n) for n in f.ImagePositionPatient])
        along = lambda f: place(f) @ np.cross(row, column)
        self.files = sorted(files, key=along)
        self.along = np.array([along(f) for f in self.files])
        self.position = np.array([place(f) for f in self.files])
        down, across = (float(n) for n in one.PixelSpacing)  # between rows, between columns
        self.i, self.j = row * across, column * down
        self.slope, self.intercept = float(one.RescaleSlope), float(one.RescaleIntercept)

    def volume(self, k):
        samples = np.stack([f.pixel_array for f in self.files])
        affine = np.column_stack([self.i, self.j, k, self.position[0]])
        return Volume(samples, affine, "mm", "LPS", self.slope, self.intercept)


def dicom(folder):
    s = Series(folder)
    steps = np.diff(s.along)
    assert np.ptp(steps) < 1e-3 * steps.mean(), "uneven"
    return s.volume((s.position[-1] - s.position[0]) / (len(s.files) - 1))


def dicom_uneven(folder):
    """Samples as stored; `position` tells where each slice is, and k is left open."""
    s = Series(folder)
    assert np.ptp(np.diff(s.along)) > 0.1
    volume = s.volume([math.nan] * 3)
    volume.position = s.position
    return volume


def dicom_seg(folder):
    """Segment numbers as labels, on the grid from the first to the last position of a frame."""
    (name,) = folder.glob("*.dcm")
    file = pydicom.dcmread(name)
    shared, frames = (
        file.SharedFunctionalGroupsSequence[0],
        file.PerFrameFunctionalGroupsSequence,
    )
    plane, pixel = shared.PlaneOrientationSequence[0], shared.PixelMeasuresSequence[0]
    row, column = np.array(plane.ImageOrientationPatient, float).reshape(2, 3)
    down, across = (float(n) for n in pixel.PixelSpacing)
    step = float(pixel.SpacingBetweenSlices)
    places = [f.PlanePositionSequence[0].ImagePositionPatient for f in frames]
    position = np.array([[float(n) for n in p] for p in places])
    along = position @ np.cross(row, column)
    place = np.rint((along - along.min()) / step).astype(int)
    assert np.abs(along - along.min() - place * step).max() < 1e-3
    labels = np.zeros((place.max() + 1, file.Rows, file.Columns), np.uint8)
    for frame, k, bits in zip(frames, place, file.pixel_array):
        number = frame.SegmentIdentificationSequence[0].ReferencedSegmentNumber
        assert not (labels[k][bits > 0]).any(), "segments overlap"
        labels[k][bits > 0] = number
    first, last = position[along.argmin()], position[along.argmax()]
    axes = [row * across, column * down, (last - first) / place.max(), first]
    return Volume(labels, np.column_stack(axes), "mm", "LPS")


# --- what is told -----------------------------------------------------------------------------


def world(volume, points):
    """Indices (i, j, k) to LPS mm; slices may be at places of their own."""
    if not hasattr(volume, "position"):
        return points @ volume.affine[:, :3].T + volume.affine[:, 3]
    slices = np.arange(len(volume.position))
    at = [np.interp(points[:, 2], slices, along) for along in volume.position.T]
    return points[:, :2] @ volume.affine[:, :2].T + np.column_stack(at)


def open_edges(corner):
    """How many edges have one triangle."""
    sides = np.concatenate([corner[:, [n, (n + 1) % 3]] for n in range(3)])
    sides = np.sort(sides, axis=1).astype(np.int64)
    key = np.sort(sides[:, 0] << 32 | sides[:, 1])
    first = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1], [True]]))
    return int((np.diff(first) == 1).sum())


def surface(volume, iso):
    """Area in mm2, bounds, and how many edges have one triangle."""
    image = vtkImageData()
    image.SetDimensions(volume.samples.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(volume.samples.ravel()))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, (iso - volume.intercept) / volume.slope)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    mesh = edges.GetOutput()
    points = world(volume, vtk_to_numpy(mesh.GetPoints().GetData()).astype(float))
    corner = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    area = 0.0
    for part in np.array_split(corner, len(corner) // 1000000 + 1):
        a, b, c = (points[part[:, n]] for n in range(3))
        area += 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    used = points[np.unique(corner)]
    return area, np.concatenate([used.min(axis=0), used.max(axis=0)]), open_edges(corner)


def box_part(samples, box):
    (i0, i1), (j0, j1), (k0, k1) = box
    return samples[k0 : k1 + 1, j0 : j1 + 1, i0 : i1 + 1]


def content(samples, level):
    """Per axis of the array, the first and last index where anything exceeds the level."""
    above = samples > level
    return [np.flatnonzero(above.any(axis=axes))[[0, -1]] for axes in ((1, 2), (0, 2), (0, 1))]


def probe(volume, level):
    """A box inside what exceeds the level: the one whose mean differs most from what it would
    be, were axes mirrored or exchanged."""
    samples, shape = volume.samples, volume.samples.shape
    orders = [
        o for o in itertools.permutations(range(3)) if shape == tuple(shape[a] for a in o)
    ]
    flips = list(itertools.product((slice(None), slice(None, None, -1)), repeat=3))
    others = [samples.transpose(o)[f] for o in orders for f in flips][1:]
    ends = content(samples, (level - volume.intercept) / volume.slope)[::-1]
    part = lambda low, high, a, b: (low + (high - low) * a // 16, low + (high - low) * b // 16)
    best = None
    for choice in itertools.product(((3, 6), (4, 8), (9, 14)), repeat=3):
        box = [part(int(low), int(high), *c) for (low, high), c in zip(ends, choice)]
        here = volume.mean(box_part(samples, box))
        apart = min(abs(volume.value(box_part(o, box).mean()) - here) for o in others)
        if best is None or apart > best[0]:
            best = apart, box, here
    assert best[0] > 1e-4 * abs(volume.slope) * np.ptp(samples), "nothing tells the axes apart"
    return best[1:]


def text(numbers, digits=10):
    return " ".join(
        "*" if math.isnan(n) else f"{n + 0.0:.{digits}g}" for n in np.ravel(numbers)
    )


TYPES = {"uint8": "u8", "int8": "i8", "uint16": "u16", "int16": "i16", "float32": "f32"}
COLUMNS = (
    "reader path options check iso box dims type spacing unit frame affine last "
    "min max mean probe area bounds edges"
).split()


def row(reader, path, options, volume, levels):
    samples, even = volume.samples, not hasattr(volume, "position")
    dims = np.array(samples.shape[::-1])
    star = lambda value: value if even else "*"
    box, inside = probe(volume, levels[0]) if even else (None, None)
    made = [surface(volume, level) for level in levels]
    spacing = np.linalg.norm(volume.affine[:, :3], axis=0)
    facts = {
        "reader": reader,
        "path": path,
        "options": options or "-",
        "check": "full" if even else "resampled",
        "iso": ",".join(text(level) for level in levels),
        "box": ",".join(f"{low}:{high}" for low, high in box) if even else "*",
        "dims": text(dims[:2]) + " " + star(text(dims[2:])),
        "type": TYPES[samples.dtype.name],
        "spacing": text(spacing),
        "unit": volume.unit,
        "frame": volume.frame,
        "affine": text(volume.affine, 12),
        "last": text(world(volume, np.array([dims - 1.0])), 12),
        "min": text(volume.value(samples.min())),
        "max": text(volume.value(samples.max())),
        "mean": star(text(volume.mean(samples), 12)),
        "probe": text(inside, 12) if even else "*",
        "area": ";".join(text(area) for area, _, _ in made),
        "bounds": ";".join(text(bounds) for _, bounds, _ in made),
        "edges": ";".join(star(str(edges)) for _, _, edges in made),
    }
    return [facts[name] for name in COLUMNS]


# Reader, path, options, levels of the data's README, and how it is read here.
SPACING = "--spacing 0.1411,0.1411,0.1409mm"
HEADER = "--raw dims=128x128x84,type=u8,offset=62,spacing=1x1x1.5mm"
TABLE = [
    ("nifti", "ch2-mri/ch2.nii.gz", "", [50, 100], nifti),
    ("nifti", "ch2-mri/aal.nii.gz", "", [0.5], nifti),
    ("nifti", "ct-example/ct_example.nii.gz", "", [-300, 300], nifti),
    ("nifti", "bonsai-ct/bonsai.nii.gz", "", [40, 100], nifti),
    ("nifti", "mouse-microct/low_res_template_UCHAR.nii.gz", "", [18], nifti),
    ("nifti", "mouse-microct/low_res_template_UCHAR-label.nii.gz", "", [0.5], nifti),
    ("nifti", "fmri-4d/example4d.nii.gz", "--step 0", [300], nifti),
    ("nifti", "fmri-4d/example4d.nii.gz", "--step 1", [300], lambda p: nifti(p, 1)),
    ("nrrd", "flair-mri/FLAIR.nrrd", "", [40, 120], nrrd),
    ("nrrd", "avf-mr/avf_float_32.nrrd", "", [800], nrrd),
    ("metaimage", "headsq-ct/headsq.mha", "", [500, 1150], metaimage),
    ("metaimage", "phantom-ct/phantom_head.mha", "", [-400, 0, 300], metaimage),
    ("metaimage", "frog-labels/frogtissue.mhd", "", [0.5], metaimage),
    ("metaimage", "heart-mask/mask.mhd", "", [0.5], metaimage),
    ("metaimage", "headmr/HeadMRVolume.mhd", "", [60], metaimage),
    ("vtk", "vtk-legacy/carotid.vtk", "", [200, 255], vtk),
    ("vtk", "vtk-legacy/ironProt.vtk", "", [128], vtk),
    ("vti", "embryo/embryo.vti", "", [70, 110], vti),
    ("vti", "fingers-series/fingers_010.vti", "", [20, 30], vti),
    ("vti", "fingers-series/fingers_020.vti", "", [20, 30], vti),
    ("vti", "fingers-series/fingers_030.vti", "", [20, 30], vti),
    ("vti", "fingers-series/fingers_040.vti", "", [20, 30], vti),
    ("vti", "fingers-series/fingers_050.vti", "", [20, 30], vti),
    ("vti", "fingers-series/fingers_060.vti", "", [20, 30], vti),
    ("inr", "inr/skull_2.9.inr", "", [2.9], inr),
    ("mrc", "mrc/EMD-3001.map", "", [0.47], mrc),  # mean + 3 standard deviations
    ("raw", "brainsmall-mri/brainsmall.den", HEADER, [50], brainsmall),
    (
        "slices",
        "headsq-ct/slices/quarter.*",
        "--raw dims=64x64x93,type=u16le",
        [500, 1150],
        quarters,
    ),
    ("tiff", "berea-microct/berea_200.tif", "", [128], tiff),
    ("tiff", "brain-labels-tiff/brain_seg.tif", "", [0.5], tiff),
    ("tiff", "brain-labels-tiff/head_mask_g4.tif", "", [0.5], tiff),
    ("tiff", "mouse-tiff-stack", SPACING, [40], mouse),
    ("tiff", "mouse-tiff-stack/*.tif", SPACING, [40], mouse),
    ("dicom", "pet-dicom", "", [2000, 10000], dicom),
    ("dicom", "pet-dicom-seg", "", [0.5], dicom_seg),
    ("dicom", "ct-head-ge-dicom", "--gaps interpolate", [-300, 250], dicom_uneven),
]
REFUSED = ("dicom", "ct-head-ge-dicom", "-", "refused")


def main():
    here = Path(__file__).resolve()
    parser = argparse.ArgumentParser()
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("CUBEWRIGHT_DATA", "."), "data"))
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    print(*COLUMNS, sep="\t")
    for reader, path, options, levels, read in TABLE:
        if args.only in path:
            print(path, file=sys.stderr)
            volume = read(args.data / path)
            print(*row(reader, path, options, volume, levels), sep="\t", flush=True)
    print(*REFUSED, *["*"] * (len(COLUMNS) - len(REFUSED)), sep="\t")


if __name__ == "__main__":
    main()
