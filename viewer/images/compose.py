"""Composes the pictures of draw.sh: sheets of tiles with captions, and VTK's surfaces.

    compose.py sheet OUTPUT COLUMNS FOOTER (TILE TITLE TEXT)...
    compose.py trim INPUT OUTPUT
    compose.py pages OUTPUT WIDTH INPUT...     side by side
    compose.py part INPUT OUTPUT FIRST END     columns, as parts of the width from 0 to 1
    compose.py pad VOLUME VALUE OUTPUT.mha [X Y Z RADIUS]
    compose.py surface VOLUME.mha ISOVALUE OUTPUT.ply
    compose.py get FORMAT (FILE.json KEY)...   KEY:ms is the median of a list of
                                               seconds without the first, in milliseconds
"""
import json
import statistics
import sys

DARK, INK, SOFT = (22, 27, 34), (235, 238, 242), (160, 170, 180)
FONTS = "/usr/share/fonts/truetype/dejavu/DejaVuSans"
GAP = 8  # pixels between tiles
LIMIT = 400_000  # bytes of a picture in the tree


def font(size, bold=False):
    from PIL import ImageFont
    return ImageFont.truetype(FONTS + ("-Bold.ttf" if bold else ".ttf"), size)


def save(image, path):
    import os
    image = image.convert("RGB")
    if path.endswith(".jpg"):
        image.save(path, quality=88, optimize=True)
    else:
        image.save(path, optimize=True)
    if os.path.getsize(path) > LIMIT:
        sys.exit(f"{path}: {os.path.getsize(path)} bytes, more than {LIMIT}")


def sheet(output, columns, footer, *rest):
    """Places tiles in rows, each above its title and text."""
    from PIL import Image, ImageDraw
    columns = int(columns)
    tiles = [(Image.open(rest[i]).convert("RGB"), rest[i + 1], rest[i + 2])
             for i in range(0, len(rest), 3)]
    width, height = (max(t[0].size[k] for t in tiles) for k in (0, 1))
    title, text = font(15, True), font(13)
    lines = max(t[2].count("\n") + 1 if t[2] else 0 for t in tiles)
    cell = height + 26 + 18 * lines + GAP
    rows = -(-len(tiles) // columns)
    notes = footer.split("\n") if footer else []
    whole = Image.new("RGB", (columns * (width + GAP) + GAP,
                              rows * cell + GAP + 19 * len(notes) + (6 if notes else 0)), DARK)
    draw = ImageDraw.Draw(whole)
    for i, (image, name, about) in enumerate(tiles):
        x, y = GAP + i % columns * (width + GAP), GAP + i // columns * cell
        whole.paste(image, (x, y))
        draw.text((x + 2, y + height + 4), name, INK, title)
        draw.multiline_text((x + 2, y + height + 24), about, SOFT, text, spacing=3)
        longest = max(draw.textlength(line, text) for line in about.split("\n"))
        if max(longest, draw.textlength(name, title)) > width:
            sys.exit(f"{output}: the caption of '{name}' is wider than its tile")
    for i, line in enumerate(notes):
        draw.text((GAP + 2, rows * cell + GAP + 19 * i), line, SOFT, text)
        if draw.textlength(line, text) > whole.size[0] - 2 * GAP:
            sys.exit(f"{output}: a line of the footer is wider than the sheet")
    save(whole, output)


def trim(source, output):
    """Leaves out the empty border, and keeps 20 pixels of it."""
    from PIL import Image, ImageChops
    image = Image.open(source).convert("RGB")
    paper = image.getpixel((0, 0))
    box = ImageChops.difference(image, Image.new("RGB", image.size, paper)).getbbox()
    framed = Image.new("RGB", (box[2] - box[0] + 40, box[3] - box[1] + 40), paper)
    framed.paste(image.crop(box), (20, 20))
    framed.save(output)


def part(source, output, first, end):
    from PIL import Image
    image = Image.open(source)
    w, h = image.size
    image.crop((round(float(first) * w), 0, round(float(end) * w), h)).save(output)


def pages(output, width, *sources):
    """Places pages side by side, scaled to a width in all."""
    from PIL import Image
    images = [Image.open(s).convert("RGB") for s in sources]
    whole = Image.new("RGB", (sum(i.size[0] for i in images), max(i.size[1] for i in images)),
                      images[0].getpixel((0, 0)))
    x = 0
    for image in images:
        whole.paste(image, (x, 0))
        x += image.size[0]
    width = int(width)
    save(whole.resize((width, round(whole.size[1] * width / whole.size[0])), Image.LANCZOS),
         output)


def pad(volume, value, output, *box):
    """Surrounds a volume, or a box of it, with a layer of voxels of one value."""
    import vtk
    reader = vtk.vtkNIFTIImageReader() if ".nii" in volume else vtk.vtkMetaImageReader()
    reader.SetFileName(volume)
    reader.Update()
    port = reader.GetOutputPort()
    if box:
        x, y, z, r = map(int, box)
        crop = vtk.vtkExtractVOI()
        crop.SetInputConnection(port)
        crop.SetVOI(x - r, x + r, y - r, y + r, z - r, z + r)
        crop.Update()
        port = crop.GetOutputPort()
        extent = crop.GetOutput().GetExtent()
    else:
        extent = reader.GetOutput().GetExtent()
    padded = vtk.vtkImageConstantPad()
    padded.SetInputConnection(port)
    padded.SetConstant(float(value))
    padded.SetOutputWholeExtent(*(e + (1 if i % 2 else -1) for i, e in enumerate(extent)))
    writer = vtk.vtkMetaImageWriter()
    writer.SetInputConnection(padded.GetOutputPort())
    writer.SetFileName(output)
    writer.SetCompression(False)
    writer.Write()


def surface(volume, isovalue, output):
    """Extracts a surface with vtkFlyingEdges3D."""
    import vtk
    reader = vtk.vtkMetaImageReader()
    reader.SetFileName(volume)
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputConnection(reader.GetOutputPort())
    edges.SetValue(0, float(isovalue))
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    writer = vtk.vtkPLYWriter()
    writer.SetInputConnection(edges.GetOutputPort())
    writer.SetFileName(output)
    writer.Write()


def get(form, *rest):
    """Prints numbers of JSON files in a format of Python's."""
    values = []
    for path, key in zip(rest[::2], rest[1::2]):
        with open(path) as file:
            value = json.load(file)
        key, _, unit = key.partition(":")
        for name in key.split("."):
            if isinstance(value, list) and not name.isdigit():
                value = [v[name] for v in value]
            else:
                value = value[int(name) if name.isdigit() else name]
        if isinstance(value, list) and unit:
            value = statistics.median(value[1:] or value)
        values.append(value * 1000 if unit == "ms" else value)
    print(form.format(*values))


if __name__ == "__main__":
    {"sheet": sheet, "trim": trim, "part": part, "pages": pages, "pad": pad,
     "surface": surface, "get": get}[sys.argv[1]](*sys.argv[2:])
