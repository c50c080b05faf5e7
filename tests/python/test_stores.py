"""Tests reading of N5 and of Neuroglancer's volumes against writers of their own: all codecs, types and shards."""

import bz2
import gzip
import itertools
import json
import zlib

import cubewright as cw
import numpy as np
from support import Case, main

MASK = 0xFFFFFFFF
PACKERS = {"raw": bytes, "gzip": gzip.compress, "zlib": zlib.compress, "bzip2": bz2.compress}


def cut(sizes, block):
    """Yields the place of each block in the grid, its first voxel and its end."""
    for place in itertools.product(*(range(-(-s // b)) for s, b in zip(sizes, block))):
        first = [p * b for p, b in zip(place, block)]
        yield place, first, [min(f + b, s) for f, b, s in zip(first, block, sizes)]


def big(array):
    return array.astype(array.dtype.newbyteorder(">")).tobytes()


def little(array):
    return array.astype(array.dtype.newbyteorder("<")).tobytes()


def write_n5(folder, array, block, codec, counted, whole):
    """Writes an array of z, y, x."""
    sizes = array.shape[::-1]
    folder.mkdir(parents=True)
    attributes = {"dimensions": sizes, "blockSize": block, "dataType": array.dtype.name}
    (folder / "attributes.json").write_text(json.dumps({**attributes, "compression": {"type": codec}}))
    for place, first, end in cut(sizes, block):
        part = array[tuple(slice(f, e) for f, e in zip(first, end))[::-1]]
        if whole:
            part = np.pad(part, [(0, b - s) for b, s in zip(block[::-1], part.shape)])
        header = [counted, part.ndim, *part.shape[::-1], *([part.size] if counted else [])]
        bytes_of = [2, 2] + [4] * (len(header) - 2)
        path = folder.joinpath(*map(str, place))
        path.parent.mkdir(parents=True, exist_ok=True)
        head = b"".join(int(h).to_bytes(n, "big") for h, n in zip(header, bytes_of))
        path.write_bytes(head + PACKERS[codec](big(part)))


def rotate(word, bits):
    return (word << bits | word >> (32 - bits)) & MASK


def hash_murmur(number):
    """MurmurHash3_x86_128 of eight bytes: the low half."""

    def mix(word):
        word = ((word ^ word >> 16) * 0x85EBCA6B) & MASK
        word = ((word ^ word >> 13) * 0xC2B2AE35) & MASK
        return word ^ word >> 16

    def spread(words):
        words = [sum(words) & MASK, *words[1:]]
        return [words[0]] + [(w + words[0]) & MASK for w in words[1:]]

    low = rotate(number * 0x239B961B & MASK, 15) * 0xAB0E9789 & MASK
    high = rotate((number >> 32) * 0xAB0E9789 & MASK, 16) * 0x38B34AE5 & MASK
    words = spread([mix(w) for w in spread([low ^ 8, high ^ 8, 8, 8])])
    return words[1] << 32 | words[0]


def find_code(grid, place):
    """The compressed Morton code of a chunk."""
    code, used = 0, 0
    for bit, axis in itertools.product(range(64), range(3)):
        if 2**bit < grid[axis]:
            code |= (place[axis] >> bit & 1) << used
            used += 1
    return code


def encode_labels(array, block):
    """Encodes an array of channels, z, y, x as compressed_segmentation."""
    starts, words = [], []
    for channel in array:
        grid = [-(-s // b) for s, b in zip(channel.shape[::-1], block)]
        heads, body, tables = [], [], {}
        for place in itertools.product(*map(range, grid[::-1])):
            part = channel[tuple(slice(p * b, p * b + b) for p, b in zip(place, block[::-1]))]
            labels, entries = np.unique(part, return_inverse=True)
            bits = next(b for b in (0, 1, 2, 4, 8, 16, 32) if len(labels) <= 2**b)
            whole = np.zeros(block[::-1], int)
            whole[tuple(map(slice, part.shape))] = entries.reshape(part.shape)
            packed = sum(int(e) << n * bits for n, e in enumerate(whole.ravel())) if bits else 0
            base = 2 * int(np.prod(grid))
            values = base + len(body)
            body += [packed >> 32 * n & MASK for n in range(-(-whole.size * bits // 32))]
            if tuple(labels) not in tables:
                tables[tuple(labels)] = base + len(body)
                body += np.frombuffer(little(labels), "<u4").tolist()
            heads += [tables[tuple(labels)] | bits << 24, values]
        starts.append(len(array) + len(words))
        words += heads + body
    return np.array(starts + words, "<u4").tobytes()


def write_shards(folder, sharding, chunks):
    shards = {}
    for code, data in sorted(chunks.items()):
        number = code >> sharding["preshift_bits"]
        number = hash_murmur(number) if sharding["hash"] != "identity" else number
        bits = sharding["minishard_bits"]
        shard = number >> bits & (1 << sharding["shard_bits"]) - 1
        shards.setdefault(shard, {}).setdefault(number & (1 << bits) - 1, []).append((code, data))
    for shard, minishards in shards.items():
        places, body = [(0, 0)] * (1 << sharding["minishard_bits"]), b""
        for minishard, entries in minishards.items():
            codes = np.diff([0] + [code for code, _ in entries])
            table = np.array([codes, [len(body)] + [0] * (len(entries) - 1), [len(d) for _, d in entries]], "<u8")
            body += b"".join(data for _, data in entries)
            table = table.tobytes()
            table = gzip.compress(table) if sharding.get("minishard_index_encoding") == "gzip" else table
            places[minishard] = (len(body), len(body) + len(table))
            body += table
        name = f"{shard:x}".zfill(-(-sharding["shard_bits"] // 4))
        (folder / f"{name}.shard").write_bytes(np.array(places, "<u8").tobytes() + body)


def write_precomputed(folder, array, chunk, block=None, offset=(0, 0, 0), sharding=None):
    """Writes an array of channels, z, y, x."""
    sizes = array.shape[:0:-1]
    scale = {"key": "fine", "size": sizes, "resolution": (4, 4, 40), "voxel_offset": offset, "chunk_sizes": [chunk]}
    scale["encoding"] = "compressed_segmentation" if block else "raw"
    scale |= {"compressed_segmentation_block_size": block} if block else {}
    scale |= {"sharding": sharding} if sharding else {}
    (folder / "fine").mkdir(parents=True)
    info = {"data_type": array.dtype.name, "num_channels": len(array), "type": "image", "scales": [scale]}
    (folder / "info").write_text(json.dumps(info))
    chunks, grid = {}, [-(-s // c) for s, c in zip(sizes, chunk)]
    for place, first, end in cut(sizes, chunk):
        part = array[(slice(None), *(slice(f, e) for f, e in zip(first[::-1], end[::-1])))]
        data = encode_labels(part, block) if block else little(part)
        if sharding:
            chunks[find_code(grid, place)] = gzip.compress(data) if "data_encoding" in sharding else data
            continue
        name = "_".join(f"{f + o}-{e + o}" for f, e, o in zip(first, end, offset))
        if sum(place) % 2:
            (folder / "fine" / f"{name}.gz").write_bytes(gzip.compress(data))
        else:
            (folder / "fine" / name).write_bytes(data)
    if sharding:
        write_shards(folder / "fine", sharding, chunks)


class Stores(Case):
    def compare(self, folder, array):
        """Compares what is read with an array of z, y, x or of channels, z, y, x."""
        wide = {"uint64": "uint32", "int64": "int32"}.get(array.dtype.name, array.dtype.name)
        got = cw.read_volume(folder).array
        self.assertEqual(got.dtype.name, wide)
        if array.ndim == 4:
            array = np.moveaxis(array, 0, -1) if len(array) > 1 else array[0]
        self.assertTrue((got == array).all())

    def test_n5(self):
        voxels = np.random.default_rng(1).integers(0, 100, (11, 9, 13))
        types = ("uint8", "int16", "float32", "uint64", "float64", "int8", "int64")
        cases = itertools.product(PACKERS, types, (0, 1), (False, True))
        for number, (codec, kind, counted, whole) in enumerate(cases):
            with self.subTest(codec=codec, kind=kind, counted=counted, whole=whole):
                folder = self.folder / f"{number}.n5"
                block = ((5, 9, 4), (20, 4, 3), (64, 64, 64))[number % 3]
                write_n5(folder, voxels.astype(kind), block, codec, counted, whole)
                try:
                    self.compare(folder, voxels.astype(kind))
                except cw.Error as error:
                    self.assertEqual((error.status, codec), (cw.Status.UNSUPPORTED, "bzip2"))

    def test_precomputed(self):
        random = np.random.default_rng(2)
        shards = {"@type": "neuroglancer_uint64_sharded_v1", "preshift_bits": 1, "hash": "identity"}
        shards |= {"minishard_bits": 1, "shard_bits": 2}
        hashed = {**shards, "hash": "murmurhash3_x86_128", "minishard_bits": 2, "shard_bits": 5}
        hashed |= {"minishard_index_encoding": "gzip", "data_encoding": "gzip"}
        one = {**shards, "preshift_bits": 9, "minishard_bits": 0, "shard_bits": 0}
        kinds = [("uint8", None), ("float32", None), ("uint64", None), ("int16", None)]
        kinds += [("uint32", (3, 4, 2)), ("uint64", (8, 8, 8))]
        chunks = ((8, 8, 8), (64, 5, 3), (4, 20, 6))
        cases = itertools.product(kinds, (1, 2), chunks, (None, shards, hashed, one))
        for number, ((kind, block), channels, chunk, sharding) in enumerate(cases):
            with self.subTest(kind=kind, block=block, channels=channels, chunk=chunk, sharding=sharding):
                folder = self.folder / str(number)
                array = random.integers(0, (3, 100, 1)[number % 3] + 1, (channels, 11, 9, 21)).astype(kind)
                write_precomputed(folder, array, chunk, block, (number % 5 - 2, 7, -100), sharding)
                self.compare(folder, array)
        self.assertTrue(np.allclose(cw.read_volume(folder).origin, (4e-6 * (number % 5 - 1.5), 3e-5, -99.5 * 4e-5)))


if __name__ == "__main__":
    main()
