"""Holds GIfTI and FreeSurfer's surfaces against nibabel, and against gifti_tool where it is installed.

Runs in an empty folder, with cubewright in the path; prints what differs, and exits with 1 then."""
import itertools
import shutil
import subprocess
import sys

import numpy
from nibabel import freesurfer, gifti, load, save

failed = 0


def expect(what, holds):
    global failed
    if not holds:
        print("differs:", what)
        failed = 1


def run(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True)


def read_by_us(path):
    """Returns points (RAS) and triangles of a file as we read it."""
    run("cubewright", "convert", path, "-o", "ours.off", "--frame", "ras")
    lines = [line for line in open("ours.off").read().splitlines() if line[0] != "#"]
    count = int(lines[1].split()[0])
    numbers = [[float(n) for n in line.split()] for line in lines[2:]]
    return numpy.array(numbers[:count]), numpy.array(numbers[count:], int)[:, 1:]


def same(path, points, triangles):
    ours = read_by_us(path)
    return (ours[0].shape == points.shape and abs(ours[0] - points).max() < 2e-5
            and (ours[1] == triangles).all())


def make_ball(n):
    """An octahedron whose faces are cut n times, as points on a sphere that is no sphere's."""
    points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    for _ in range(n):
        middle, cut = {}, []
        for face in faces:
            between = []
            for i in range(3):
                edge = tuple(sorted((face[i], face[(i + 1) % 3])))
                if edge not in middle:
                    middle[edge] = len(points)
                    points.append([points[edge[0]][a] + points[edge[1]][a] for a in range(3)])
                between.append(middle[edge])
            cut += [[face[i], between[i], between[i - 1]] for i in range(3)] + [between]
        faces = cut
    array = numpy.array(points, float)
    array /= numpy.linalg.norm(array, axis=1)[:, None]
    return (array * [30, 40, 25] + [5, -17, 11]).astype("f4"), numpy.array(faces, "i4")


def make_gifti(points, triangles, **how):
    arrays = [gifti.GiftiDataArray(points, intent="NIFTI_INTENT_POINTSET",
                                   datatype="NIFTI_TYPE_FLOAT32", **how),
              gifti.GiftiDataArray(triangles, intent="NIFTI_INTENT_TRIANGLE",
                                   datatype="NIFTI_TYPE_INT32", **how)]
    return gifti.GiftiImage(darrays=arrays)


def hold_gifti(points, triangles):
    for encoding, endian, order in itertools.product(("ASCII", "B64BIN", "B64GZ"),
                                                     ("little", "big"), "CF"):
        if (encoding, order) == ("ASCII", "F"):  # nibabel writes rows there
            continue
        how = {"encoding": "GIFTI_ENCODING_" + encoding, "endian": endian, "ordering": order}
        save(make_gifti(points, triangles, **how), "theirs.surf.gii")
        expect(how, same("theirs.surf.gii", points, triangles))
    run("cubewright", "convert", "theirs.surf.gii", "-o", "ours.surf.gii")
    back = load("ours.surf.gii")
    expect("points of ours", (back.darrays[0].data == points).all())
    expect("triangles of ours", (back.darrays[1].data == triangles).all())
    if not shutil.which("gifti_tool"):
        return
    expect("valid", "is VALID" in run("gifti_tool", "-infile", "ours.surf.gii", "-gifti_test").stdout)
    for how in (("-encoding", "ASCII"), ("-encoding", "BASE64"), ("-encoding", "BASE64GZIP"),
                ("-set_extern_filelist", "points.bin", "triangles.bin")):
        run("gifti_tool", "-infiles", "ours.surf.gii", *how, "-write_gifti", "tool.surf.gii")
        expect(how, same("tool.surf.gii", points, triangles))


def to_scanner(volume):
    """The matrix from tkregister's coordinates, by way of the voxels' indices."""
    size, step = volume["volume"], volume["voxelsize"]
    voxels, tkregister = numpy.eye(4), numpy.zeros((4, 4))
    voxels[:3, :3] = numpy.c_[volume["xras"] * step[0], volume["yras"] * step[1],
                              volume["zras"] * step[2]]
    voxels[:3, 3] = volume["cras"] - voxels[:3, :3] @ (size / 2)
    for row, axis, sign in ((0, 0, -1), (1, 2, 1), (2, 1, -1)):
        tkregister[row, axis] = sign * step[axis]
        tkregister[row, 3] = -sign * step[axis] * size[axis] / 2
    tkregister[3, 3] = 1
    return voxels @ numpy.linalg.inv(tkregister)


def hold_freesurfer(points, triangles):
    volumes = [numpy.array(v, float) for v in (
        [[-1, 0, 0], [0, 0, -1], [0, 1, 0], [3.5, -17.25, 9]],
        [[0, 0.8, 0.6], [-1, 0, 0], [0, -0.6, 0.8], [-40, 1, 2]])]
    for axes in volumes:
        volume = {"head": numpy.array([2, 0, 20], "i4"), "valid": "1  # volume info valid",
                  "filename": "../mri/filled.mgz", "volume": numpy.array([200, 220, 256]),
                  "voxelsize": numpy.array([1, 0.9, 1.1]), "xras": axes[0], "yras": axes[1],
                  "zras": axes[2], "cras": axes[3]}
        freesurfer.write_geometry("lh.white", points, triangles, volume_info=volume)
        matrix = to_scanner(volume)
        expected = points @ matrix[:3, :3].T + matrix[:3, 3]
        corners = triangles[:, [0, 2, 1]] if numpy.linalg.det(matrix) < 0 else triangles
        expect(axes, same("lh.white", expected, corners))
        for local in ([], ["--local"]):
            run("cubewright", "convert", "lh.white", "-o", "lh.pial", *local)
            back, faces, facts = freesurfer.read_geometry("lh.pial", read_metadata=True)
            expect(("back", local), abs(back + facts["cras"] - expected).max() < 2e-5)
            expect(("corners", local), (faces == corners).all())
    freesurfer.write_geometry("lh.white", points, triangles)
    expect("no geometry", same("lh.white", points, triangles))


ball = make_ball(3)
hold_gifti(*ball)
hold_freesurfer(*ball)
sys.exit(failed)
