"""Writes stores of Zarr 2 by zarr-python, and beside each the bytes that are expected of it."""
import itertools
import numpy
import numcodecs
import zarr

compressors = {
    "none": None,
    "zlib": numcodecs.Zlib(5),
    "gzip": numcodecs.GZip(5),
    "zstd": numcodecs.Zstd(5),
    "lz4": numcodecs.LZ4(),
    "blosclz": numcodecs.Blosc("blosclz", 5, numcodecs.Blosc.SHUFFLE),
    "bloscbit": numcodecs.Blosc("lz4", 5, numcodecs.Blosc.BITSHUFFLE),
    "blosczstd": numcodecs.Blosc("zstd", 9, numcodecs.Blosc.NOSHUFFLE),
    "blosczlib": numcodecs.Blosc("zlib", 5, numcodecs.Blosc.SHUFFLE),
}
types = ["u1", "i1", "<u2", ">u2", "<i2", ">i4", "<u4", "<f4", ">f4", "<f8", ">f8", "b1", "<i8", ">u8"]
shapes = [((17, 19, 23), (8, 8, 8)), ((33, 5, 40), (33, 5, 7)), ((3, 9, 10, 11), (1, 4, 16, 5))]
generator = numpy.random.default_rng(5)
cases = itertools.cycle(shapes)
count = 0
for (name, compressor), kind in itertools.product(compressors.items(), types):
    shape, chunks = next(cases)
    smooth = numpy.indices(shape).sum(0) + generator.integers(0, 9, shape)
    values = (smooth % 2 if kind == "b1" else smooth).astype(kind)
    path = "store%d" % count
    order, separator = "F" if count % 3 == 0 else "C", "/" if count % 2 else "."
    if zarr.__version__.startswith("2."):
        array = zarr.open(path, mode="w", shape=shape, chunks=chunks, dtype=kind, compressor=compressor,
                          order=order, fill_value=3, dimension_separator=separator)
    else:  # it writes Zarr 3 unless it is told otherwise, and its open() forgets the order
        array = zarr.create_array(path, shape=shape, chunks=chunks, dtype=kind, compressors=compressor,
                                  order=order, fill_value=3, zarr_format=2,
                                  chunk_key_encoding={"name": "v2", "separator": separator})
    values[tuple(slice(0, c) for c in chunks)] = array.fill_value  # such a chunk need not be written
    array[...] = values
    narrow = {"<i8": "<i4", ">u8": "<u4", "b1": "u1"}.get(kind, kind.replace(">", "<"))
    values.astype(narrow).tofile(path + ".raw")
    count += 1
print(count)
