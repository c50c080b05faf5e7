/* Helpers that the fuzz targets of the volume readers share. */
#ifndef TESTS_FUZZ_READER_H
#define TESTS_FUZZ_READER_H

#include <cubewright/formats.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Adds up what a reader made of the bytes, so that none of it is left unlooked at. */
static inline double touch_voxels(const cw_volume *v)
{
    cw_volume one;
    double sum = 0;
    for (size_t c = 0; c < v->components; c++)
        for (size_t t = 0; t < v->steps && t < 4; t++) {
            if (cw_volume_select(v, c, t, &one, NULL) != CW_OK)
                __builtin_trap(); /* what was read must be usable */
            sum += cw_volume_value(&one, 0, 0, 0) +
                   cw_volume_value(&one, one.dim[0] - 1, one.dim[1] - 1, one.dim[2] - 1);
        }
    return sum;
}

/* A grid whose cells name samples that are there, and places that are some. */
static inline void check_cells(const cw_volume *v)
{
    static const size_t corners_of[CW_SHAPE_COUNT] = {4, 5, 6, 8};
    const cw_cells *c = v->cells;
    const uint32_t *corner = c->corners;
    for (size_t n = 0; n < 3 * v->dim[0]; n++)
        if (!(c->points[n] > -1e30 && c->points[n] < 1e30))
            __builtin_trap();
    for (size_t n = 0; n < c->count; n++)
        for (size_t i = 0; i < corners_of[c->shapes[n]]; i++)
            if (*corner++ >= v->dim[0])
                __builtin_trap();
}

static inline bool same_value(const cw_volume *a, const size_t at[3], const cw_volume *b,
                              const size_t there[3])
{
    const double x = cw_volume_value(a, at[0], at[1], at[2]);
    const double y = cw_volume_value(b, there[0], there[1], there[2]);
    return x == y || (x != x && y != y);
}

/* The middle of a volume that could be read whole can be read, too, and holds the same. */
static inline void read_middle(const char *path, const cw_read_desc *whole_desc,
                               const cw_volume *whole)
{
    cw_read_desc desc = *whole_desc;
    cw_box box;
    cw_volume part;
    size_t last[3], there[3];
    for (int a = 0; a < 3; a++) {
        box.first[a] = whole->dim[a] / 3;
        box.count[a] = whole->dim[a] - 2 * box.first[a];
        last[a] = box.count[a] - 1;
        there[a] = box.first[a] + last[a];
    }
    desc.region = &box;
    if (cw_volume_read(path, &desc, &part, NULL, NULL) != CW_OK ||
        !same_value(&part, (size_t[3]){0, 0, 0}, whole, box.first) ||
        !same_value(&part, last, whole, there))
        __builtin_trap();
    cw_volume_free(&part);
}

/* Reads the bytes as a file in memory. Its name has no extension: the reader is named, so that
 * every input reaches it. */
static inline int fuzz_with(const cw_read_desc *named, const uint8_t *bytes, size_t size)
{
    cw_read_desc desc = *named;
    cw_stored_file *file;
    cw_volume volume;
    cw_error err;
    const cw_byte_source source = {.bytes = bytes, .size = size};
    if (cw_stored_file_open(&source, &file, &err) != CW_OK)
        return 0;
    desc.stored = file;
    if (cw_volume_read(NULL, &desc, &volume, NULL, &err) == CW_OK) {
        volatile double sum = touch_voxels(&volume);
        (void)sum;
        if (volume.cells)
            check_cells(&volume);
        else
            read_middle(NULL, &desc, &volume);
        cw_volume_free(&volume);
    }
    cw_stored_file_close(file);
    return 0;
}

static inline int fuzz_reader(const char *reader, const uint8_t *bytes, size_t size)
{
    cw_label_table labels = {0};
    const cw_read_desc desc = {
        .reader = reader, .max_bytes = (uint64_t)64 << 20, .labels = &labels};
    const int result = fuzz_with(&desc, bytes, size);
    cw_label_table_free(&labels);
    return result;
}

#endif
