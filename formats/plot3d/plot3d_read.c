/* Reads PLOT3D: a solution and, in another file, the points of its curvilinear grid. The file
 * sizes decide the encoding, since the files do not state it. */
#define _DEFAULT_SOURCE /* realpath */
#include "core/base/status.h"
#include "formats/cells/irregular_grid.h"
#include "formats/plot3d/plot3d_format.h"
#include "formats/volume/named_arrays.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The quantities of a solution, in the file's order. */
static const char *const names[] = {"Density", "MomentumX", "MomentumY", "MomentumZ",
                                    "StagnationEnergy"};
enum { QUANTITIES = sizeof names / sizeof *names, CONDITIONS = 4 };

/* The encoding of a file. It is written as by C, or as by Fortran with the size of each record
 * around it. It has a count of grids, which must be 1, or none. It has one of two byte
 * orders. */
typedef struct form {
    bool big_endian, counted;
    size_t mark, width; /* bytes around a record; bytes of a number */
    size_t along[3];
    uint64_t data; /* offset of the numbers */
} form;

typedef struct plot3d {
    form points, solution;
    char *path; /* path of the file of points */
    size_t quantity;
} plot3d;

static int32_t integer_at(const unsigned char *p, bool big_endian)
{
    uint32_t n = 0;
    for (int b = 0; b < 4; b++)
        n |= (uint32_t)p[b] << 8 * (big_endian ? 3 - b : b);
    return (int32_t)n;
}

/* Tries one encoding: sets the sizes; returns false where they cannot be right. conditions:
 * numbers in a separate record before the others; quantities: numbers per point. */
static bool try_form(form *f, const unsigned char *head, uint64_t size, size_t conditions,
                     size_t quantities)
{
    const size_t record = 2 * f->mark, count = f->counted ? 4 + record : 0;
    const unsigned char *dims = head + count + f->mark;
    uint64_t points = 1;
    if (f->counted && integer_at(head + f->mark, f->big_endian) != 1)
        return false;
    for (int a = 0; a < 3; a++) {
        const int32_t n = integer_at(dims + 4 * a, f->big_endian);
        if (n < 1 || __builtin_mul_overflow(points, (uint64_t)n, &points))
            return false;
        f->along[a] = (size_t)n;
    }
    f->data = count + 12 + record + f->mark + (conditions ? conditions * f->width + record : 0);
    return points < size && size == f->data + points * quantities * f->width + f->mark;
}

static cw_status find_form(int fd, uint64_t size, const char *what, size_t conditions,
                           size_t quantities, form *out, cw_error *err)
{
    unsigned char head[64] = {0};
    size_t got;
    cw_status st = cwi_input_read_at(fd, 0, head, sizeof head, &got, err);
    if (st != CW_OK)
        return st;
    for (unsigned n = 0; n < 16; n++) {
        form f = {.big_endian = n & 1,
                  .counted = n >> 1 & 1,
                  .mark = n >> 2 & 1 ? 4 : 0,
                  .width = n >> 3 & 1 ? 8 : 4};
        if (try_form(&f, head, size, conditions, quantities)) {
            *out = f;
            return CW_OK;
        }
    }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "%llu bytes are not those of a PLOT3D %s of one grid in three dimensions, "
                    "without blanking, of float or double",
                    (unsigned long long)size, what);
}

static cw_status describe_array(const void *file, size_t piece, cwi_grid_role role,
                                size_t count, cwi_source *src, bool *wide, cw_error *err)
{
    const plot3d *p = file;
    const bool points = role == CWI_GRID_POINTS;
    const form *f = points ? &p->points : &p->solution;
    const cwi_axis axes[] = {{CWI_AXIS_X, count}, {CWI_AXIS_COMPONENT, points ? 3 : 1}};
    (void)piece;
    *wide = false;
    *src = (cwi_source){.size_field = "dimensions",
                        .noun = "numbers",
                        .big_endian = f->big_endian,
                        .offset = f->data,
                        .shape = {.slope = 1, .type = f->width == 8 ? CW_F64 : CW_F32}};
    if (!points)
        src->offset += p->quantity * count * f->width;
    cw_status st = cwi_source_set_axes(src, axes, 2, err);
    return st == CW_OK && points ? cwi_names_add(&src->files, p->path, err) : st;
}

static cw_status choose_quantity(const char *expected, size_t *quantity, cw_error *err)
{
    *quantity = 0;
    for (size_t n = 0; n < QUANTITIES && expected; n++)
        if (strcmp(names[n], expected) == 0) {
            *quantity = n;
            return CW_OK;
        }
    return expected
               ? cwi_fail(err, CW_ERR_ARGUMENT,
                          "there is no array '%s'; a PLOT3D solution has Density, MomentumX, "
                          "MomentumY, MomentumZ and StagnationEnergy",
                          expected)
               : CW_OK;
}

/* Finds the encodings of both files, which must have the same sizes. */
static cw_status find_forms(const cwi_input *in, const cwi_input *points, plot3d *p,
                            cw_error *err)
{
    cw_status st = find_form(points->fd, points->size, "grid", 0, 3, &p->points, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, points->path);
    st = find_form(in->fd, in->size, "solution", CONDITIONS, QUANTITIES, &p->solution, err);
    const size_t *a = p->points.along, *b = p->solution.along;
    if (st == CW_OK && memcmp(a, b, sizeof p->points.along) != 0)
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "it is of %zu x %zu x %zu points; '%s' has %zu x %zu x %zu", b[0], b[1],
                      b[2], points->path, a[0], a[1], a[2]);
    return st;
}

static cw_status read_grid(const cwi_input *in, const cwi_input *points, plot3d *p,
                           const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    cwi_grid_piece piece = {0};
    cwi_input both = *in; /* the user named the other file, so it may be anywhere */
    both.allow_external = true;
    both.size += points->size;
    memcpy(piece.along, p->points.along, sizeof piece.along);
    const cwi_irregular grid = {.pieces = &piece,
                                .piece_count = 1,
                                .point_field = "dimensions",
                                .array = names[p->quantity],
                                .type = p->solution.width == 8 ? CW_F64 : CW_F32,
                                .components = 1,
                                .describe = describe_array,
                                .file = p};
    cw_status st = cwi_grid_along(&piece, "dimensions", err);
    return st == CW_OK ? cwi_irregular_read(&grid, &both, desc, volume, err) : st;
}

cw_status cwi_plot3d_read(const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                          cw_error *err)
{
    plot3d p = {0};
    cwi_input points = {0};
    if (!desc->points)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a PLOT3D solution needs the file of its grid's points (desc->points)");
    cw_status st = choose_quantity(desc->array, &p.quantity, err);
    if (st != CW_OK)
        return st;
    for (size_t n = 0; n < QUANTITIES; n++)
        cwi_array_list_add(in->arrays, names[n], "float", 1, false, true);
    cwi_array_list_choose(in->arrays, names[p.quantity], false);
    st = cwi_input_open(&points, desc->points, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, desc->points);
    p.path = realpath(desc->points, NULL);
    st = p.path ? find_forms(in, &points, &p, err)
                : cwi_fail(err, CW_ERR_IO, "'%s' cannot be found", desc->points);
    if (st == CW_OK)
        st = read_grid(in, &points, &p, desc, volume, err);
    free(p.path);
    cwi_input_close(&points);
    return st;
}
