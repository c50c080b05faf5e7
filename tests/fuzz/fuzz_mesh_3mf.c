/* Fuzzes the mesh reader of 3MF files: bytes that are no archive become the model of one. */
#include "fuzz_mesh.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static const char rels[] = "<Relationships><Relationship Type='/3dmodel' Target='m'/>"
                           "</Relationships>";

typedef struct archive {
    uint8_t *bytes;
    size_t size;
} archive;

static void put(archive *a, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++)
        a->bytes[a->size++] = (uint8_t)(i < 8 ? value >> (8 * i) : 0);
}

static void put_bytes(archive *a, const void *bytes, size_t size)
{
    memcpy(a->bytes + a->size, bytes, size);
    a->size += size;
}

/* The header of an entry that is stored as it is; start: of the entry, in the directory. */
static void put_head(archive *a, const char *name, const void *bytes, size_t size,
                     const size_t *start)
{
    put(a, start ? 0x02014b50 : 0x04034b50, 4);
    put(a, 0, start ? 2 : 0);
    put(a, 0, 10);
    put(a, crc32(0, bytes, (uInt)size), 4);
    put(a, size, 4);
    put(a, size, 4);
    put(a, strlen(name), 2);
    put(a, 0, 2);
    put(a, 0, start ? 10 : 0);
    put(a, start ? *start : 0, start ? 4 : 0);
    put_bytes(a, name, strlen(name));
}

/* Bytes that are no archive are the model of one, whose checksums are right. */
static int fuzz_model(const uint8_t *bytes, size_t size)
{
    const size_t starts[2] = {0, 30 + 11 + sizeof rels - 1};
    archive a = {.bytes = malloc(size + 1000)};
    if (!a.bytes)
        return 0;
    put_head(&a, "_rels/.rels", rels, sizeof rels - 1, NULL);
    put_bytes(&a, rels, sizeof rels - 1);
    put_head(&a, "m", bytes, size, NULL);
    put_bytes(&a, bytes, size);
    const size_t directory = a.size;
    put_head(&a, "_rels/.rels", rels, sizeof rels - 1, &starts[0]);
    put_head(&a, "m", bytes, size, &starts[1]);
    const size_t end = a.size;
    put(&a, 0x06054b50, 4);
    put(&a, 0, 4);
    put(&a, 2, 2);
    put(&a, 2, 2);
    put(&a, end - directory, 4);
    put(&a, directory, 4);
    put(&a, 0, 2);
    fuzz_mesh("3mf", a.bytes, a.size);
    free(a.bytes);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    const bool is_archive = size >= 2 && memcmp(bytes, "PK", 2) == 0;
    return is_archive ? fuzz_mesh("3mf", bytes, size) : fuzz_model(bytes, size);
}
