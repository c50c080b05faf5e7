/* Reads irregular grids in two passes: checks the arrays and selects the cells, then builds the
 * volume. */
#include "formats/cells/irregular_grid.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"
#include "formats/cells/cell_connectivity.h"
#include "formats/cells/grid_overlap.h"
#include "formats/cells/merge_samples.h"
#include "formats/cells/vtk_cell_types.h"
#include "formats/volume/volume_reader.h"

#include <math.h>
#include <string.h>

/* Bits of vtkGhostType. Of a point: it is blanked. Of a cell: another piece has it, finer ones
 * have replaced it, it is blanked. */
enum { HIDDEN_POINT = 2, LEFT_OUT_CELL = 1 | 8 | 32 };

/* The maximum number of samples; more could not be numbered. */
static const size_t MAX_SAMPLES = UINT32_MAX - 1;

/* The building of a volume from the arrays in two passes. The first checks all arrays and finds
 * the cells that stay. The second has room for exactly those. */
typedef struct building {
    const cwi_irregular *g;
    const cwi_input *in, *side; /* side: the file of the piece at hand, if it has its own */
    const cw_read_desc *desc;
    uint64_t bytes;       /* of memory taken so far */
    uint64_t claimed;     /* minimum bytes of the file for all arrays */
    double total, done;   /* bytes of all checked arrays, and bytes read so far */
    double now;           /* ... of the current array */
    size_t points, cells; /* of all pieces, as the file counts them */
    uint8_t *types;       /* of all cells; CWI_VTK_EMPTY for left-out ones */
    size_t flat, curved, marked;

    cw_volume volume;
    cw_cells *grid; /* at the start of a block with the next three */
    double *at;
    uint32_t *corners;
    uint8_t *shapes;
    size_t corner_count; /* of cells that stay */
} building;

/* --- arrays ------------------------------------------------------------------------------ */

static cw_status take_bytes(building *b, uint64_t bytes, cw_error *err)
{
    const uint64_t max = b->desc->max_bytes;
    if (__builtin_add_overflow(b->bytes, bytes, &b->bytes))
        b->bytes = UINT64_MAX;
    if (!max || b->bytes <= max)
        return CW_OK;
    char requested[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
    cwi_print_memory(b->bytes, requested);
    cwi_print_memory(max, limit);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "the grid takes more than %s; the limit is %s (desc->max_bytes)", requested,
                    limit);
}

/* Opens the file of a piece. */
static cw_status open_piece(building *b, size_t piece, cw_error *err)
{
    b->side = NULL;
    return b->g->open ? b->g->open(b->g->file, piece, &b->side, err) : CW_OK;
}

/* Puts the name of the piece's own file in front of the message of a failure. */
static cw_status end_piece(const building *b, cw_status st, cw_error *err)
{
    return st == CW_OK || !b->side ? st : cwi_fail_in(err, st, b->side->path);
}

static const cwi_input *file_of(const building *b)
{
    return b->side ? b->side : b->in;
}

static cw_status describe_array(const building *b, size_t piece, cwi_grid_role role,
                                size_t count, cwi_source *src, bool *wide, cw_error *err)
{
    return b->g->describe(b->g->file, piece, role, count, src, wide, err);
}

/* Reports the progress of one array as part of all. Corners are counted only when they are
 * read. */
static bool report_progress(void *user, const char *step, double done)
{
    const building *b = user;
    const cw_progress *p = &b->desc->progress;
    return p->report(p->user, step, fmin((b->done + done * b->now) / b->total, 1));
}

static cw_status load_array(building *b, size_t piece, cwi_grid_role role, size_t count,
                            cwi_tuples *t, cw_error *err)
{
    const bool reports = b->desc->progress.report;
    const cw_read_desc desc = {.progress = {reports ? report_progress : NULL, b}};
    cwi_source src = {0};
    bool wide;
    *t = (cwi_tuples){.count = 0};
    if (count == 0)
        return CW_OK;
    cw_status st = describe_array(b, piece, role, count, &src, &wide, err);
    if (st == CW_OK)
        st = take_bytes(b, src.bytes, err);
    b->now = (double)src.bytes;
    if (st == CW_OK)
        st = cwi_tuples_load(&src, file_of(b), &desc, wide, t, err);
    cwi_source_free(&src);
    b->done += b->now;
    return st;
}

static void drop_array(building *b, cwi_tuples *t)
{
    b->bytes -= t->bytes;
    cwi_tuples_free(t);
}

/* Checks that each array fits the file, and that all of them together do. */
static cw_status check_array(building *b, size_t piece, cwi_grid_role role, size_t count,
                             cw_error *err)
{
    cwi_source src = {0};
    cw_volume shape;
    bool wide;
    if (count == 0)
        return CW_OK;
    cw_status st = describe_array(b, piece, role, count, &src, &wide, err);
    if (st == CW_OK)
        st = cwi_source_load(&src, file_of(b), &(cw_read_desc){.header_only = true}, &shape,
                             err);
    b->total += (double)src.bytes;
    b->claimed += src.encoding == CWI_RAW ? src.bytes : src.bytes / 1032;
    cwi_source_free(&src);
    if (st != CW_OK)
        return st;
    const uint64_t held = b->g->file_bytes ? b->g->file_bytes : b->in->size;
    if (b->claimed <= held)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "the arrays up to piece %zu take %llu bytes of the file, which has %llu: "
                    "some share theirs",
                    piece, (unsigned long long)b->claimed, (unsigned long long)held);
}

/* --- first pass: checks ------------------------------------------------------------------ */

cw_status cwi_grid_along(cwi_grid_piece *piece, const char *field, cw_error *err)
{
    const size_t *n = piece->along;
    for (int a = 0; a < 3; a++)
        if (n[a] < 2)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' has one plane of points along %c: the grid is flat, and has "
                            "no volume",
                            field, "xyz"[a]);
    if (!cwi_size_mul(n[0], n[1], &piece->points) ||
        !cwi_size_mul(piece->points, n[2], &piece->points))
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for more points than an address space holds", field);
    piece->cells = (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
    return CW_OK;
}

static bool is_curvilinear(const cwi_grid_piece *p)
{
    return p->along[0] != 0;
}

/* Computes the corners of a hexahedron, as sample numbers of its piece. */
static void find_corners(const cwi_grid_piece *p, size_t cell, size_t corners[8])
{
    static const uint8_t steps[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const size_t *n = p->along, nx = n[0] - 1, ny = n[1] - 1;
    const size_t i = cell % nx, j = cell / nx % ny, k = cell / nx / ny;
    for (int c = 0; c < 8; c++)
        corners[c] = i + steps[c][0] + n[0] * (j + steps[c][1] + n[1] * (k + steps[c][2]));
}

static cw_status check_arrays(building *b, size_t piece, cw_error *err)
{
    const cwi_grid_piece *p = &b->g->pieces[piece];
    const struct {
        cwi_grid_role role;
        size_t count;
    } arrays[] = {
        {CWI_GRID_POINTS, p->points},
        {CWI_GRID_TYPES, is_curvilinear(p) ? 0 : p->cells},
        {CWI_GRID_ENDS, is_curvilinear(p) || p->listed ? 0 : p->cells},
        {CWI_GRID_CORNERS, p->listed},
        {CWI_GRID_VALUES, b->g->of_cells ? p->cells : p->points},
        {CWI_GRID_POINT_MARKS, p->has_point_marks ? p->points : 0},
        {CWI_GRID_CELL_MARKS, p->has_cell_marks ? p->cells : 0},
    };
    cw_status st = CW_OK;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays && st == CW_OK; i++)
        st = check_array(b, piece, arrays[i].role, arrays[i].count, err);
    return st;
}

static cw_status count_shape(building *b, size_t cell, int64_t type, cw_error *err)
{
    const cwi_cell_kind *kind = cwi_cell_kind_find(type);
    if (!kind)
        return cwi_fail(err, CW_ERR_FORMAT, "cell %zu is of type %lld, which is not known",
                        cell, (long long)type);
    if (kind->use == CWI_CELL_REFUSED)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "cell %zu is a %s (type %lld); read are tetrahedra, pyramids, wedges, "
                        "hexahedra and voxels",
                        cell, kind->name, (long long)type);
    b->flat += kind->use == CWI_CELL_FLAT;
    b->curved += kind->use == CWI_CELL_CURVED;
    return CW_OK;
}

/* Reads the types of a piece's cells; those of our shapes stay. */
static cw_status read_types(building *b, size_t piece, uint8_t *types, cw_error *err)
{
    const cwi_grid_piece *p = &b->g->pieces[piece];
    cwi_tuples t;
    if (is_curvilinear(p)) {
        memset(types, CWI_VTK_HEXAHEDRON, p->cells);
        return CW_OK;
    }
    cw_status st = load_array(b, piece, CWI_GRID_TYPES, p->cells, &t, err);
    for (size_t n = 0; n < p->cells && st == CW_OK; n++) {
        const int64_t type = cwi_tuples_whole(&t, n);
        st = count_shape(b, n, type, err);
        types[n] = st == CW_OK && cwi_cell_kind_find(type)->use != CWI_CELL_FLAT
                       ? (uint8_t)type
                       : CWI_VTK_EMPTY;
    }
    drop_array(b, &t);
    return st;
}

static void leave_out(building *b, uint8_t *type)
{
    b->marked += *type != CWI_VTK_EMPTY;
    *type = CWI_VTK_EMPTY;
}

/* Leaves out blanked cells, cells of curvilinear grids around blanked points, and cells that
 * other pieces have. */
static cw_status apply_marks(building *b, size_t piece, uint8_t *types, cw_error *err)
{
    const cwi_grid_piece *p = &b->g->pieces[piece];
    const bool points = p->has_point_marks && is_curvilinear(p);
    cwi_tuples t[2] = {0};
    cw_status st =
        load_array(b, piece, CWI_GRID_CELL_MARKS, p->has_cell_marks ? p->cells : 0, &t[0], err);
    for (size_t n = 0; n < t[0].count && st == CW_OK; n++)
        if (p->marks_are_levels ? cwi_tuples_whole(&t[0], n) > 0
                                : cwi_tuples_whole(&t[0], n) & LEFT_OUT_CELL)
            leave_out(b, &types[n]);
    drop_array(b, &t[0]);
    if (st == CW_OK)
        st = load_array(b, piece, CWI_GRID_POINT_MARKS, points ? p->points : 0, &t[1], err);
    for (size_t n = 0; points && n < p->cells && st == CW_OK; n++) {
        size_t corners[8];
        find_corners(p, n, corners);
        for (int c = 0; c < 8; c++)
            if (cwi_tuples_whole(&t[1], corners[c]) & HIDDEN_POINT)
                leave_out(b, &types[n]);
    }
    drop_array(b, &t[1]);
    return st;
}

static cw_status count_pieces(building *b, cw_error *err)
{
    const cwi_irregular *g = b->g;
    for (size_t n = 0; n < g->piece_count; n++)
        if (!cwi_size_add(b->points, g->pieces[n].points, &b->points) ||
            !cwi_size_add(b->cells, g->pieces[n].cells, &b->cells) || b->points > MAX_SAMPLES)
            return cwi_fail(err, CW_ERR_LIMIT, "'%s' asks for more than %zu points",
                            g->point_field, MAX_SAMPLES);
    if (b->points && b->cells)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT, "the grid has %zu points and %zu cells: no volume",
                    b->points, b->cells);
}

static cw_status set_shape(building *b, cw_error *err)
{
    const cwi_axis axes[] = {{CWI_AXIS_COMPONENT, b->g->components}, {CWI_AXIS_X, b->points}};
    cwi_source src = {.size_field = b->g->point_field, .shape = {.slope = 1}};
    src.shape.type = b->g->of_cells ? CW_F64 : b->g->type;
    cw_status st = cwi_source_set_axes(&src, axes, 2, err);
    for (int a = 0; a < 3; a++)
        src.shape.affine[a][a] = 1;
    b->volume = src.shape;
    if (st == CW_OK)
        st = cwi_check_limits(&b->volume, src.bytes, src.size_field, b->desc, err);
    return st;
}

static cw_status find_cells(building *b, cw_error *err)
{
    const cwi_irregular *g = b->g;
    cw_status st = count_pieces(b, err);
    for (size_t n = 0; n < g->piece_count && st == CW_OK; n++) {
        st = open_piece(b, n, err);
        if (st == CW_OK)
            st = check_arrays(b, n, err);
        st = end_piece(b, st, err);
    }
    if (st == CW_OK)
        st = set_shape(b, err);
    if (st == CW_OK)
        st = take_bytes(b, b->cells, err);
    if (st == CW_OK && !(b->types = cwi_alloc_array(b->cells, 1)))
        st = cwi_fail_memory(err);
    uint8_t *types = b->types;
    for (size_t n = 0; n < g->piece_count && st == CW_OK; types += g->pieces[n++].cells) {
        st = open_piece(b, n, err);
        if (st == CW_OK)
            st = read_types(b, n, types, err);
        if (st == CW_OK)
            st = apply_marks(b, n, types, err);
        st = end_piece(b, st, err);
    }
    if (st == CW_OK && is_curvilinear(&g->pieces[0]))
        st = cwi_grid_leave_out_repeated(g->pieces, g->piece_count, b->types, &b->marked, err);
    return st;
}

/* --- the block of the grid --------------------------------------------------------------- */

static cw_status allocate_grid(building *b, cw_error *err)
{
    const bool whole = !b->desc->header_only;
    size_t cells = 0;
    b->corner_count = 0;
    for (size_t n = 0; n < b->cells; n++)
        if (b->types[n] != CWI_VTK_EMPTY) {
            cells++;
            b->corner_count += cwi_shape_corners(cwi_cell_kind_find(b->types[n])->shape);
        }
    if (cells == 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "none of the grid's %zu cells is left: %zu have fewer than three "
                        "dimensions, %zu are marked as hidden or as another piece's",
                        b->cells, b->flat, b->marked);
    const uint64_t points = whole ? b->points : 0, corners = whole ? b->corner_count : 0,
                   bytes = sizeof *b->grid + 3 * sizeof *b->at * points +
                           sizeof *b->corners * corners + cells;
    cw_status st = take_bytes(b, bytes, err);
    if (st != CW_OK)
        return st;
    char *block = cwi_alloc_large(bytes, 1);
    if (!block)
        return cwi_fail_memory(err);
    b->volume.owned_grid = block;
    b->grid = (cw_cells *)(void *)block;
    b->at = (double *)(void *)(b->grid + 1);
    b->corners = (uint32_t *)(void *)(b->at + 3 * points);
    b->shapes = (uint8_t *)(b->corners + corners);
    *b->grid = (cw_cells){.points = whole ? b->at : NULL,
                          .count = cells,
                          .shapes = b->shapes,
                          .corners = whole ? b->corners : NULL};
    b->volume.cells = b->grid;
    for (size_t n = 0, to = 0; n < b->cells; n++)
        if (b->types[n] != CWI_VTK_EMPTY)
            b->shapes[to++] = (uint8_t)cwi_cell_kind_find(b->types[n])->shape;
    return CW_OK;
}

/* --- second pass ------------------------------------------------------------------------- */

/* Limits coordinates: vertices are written in single precision, and products of three lengths
 * are taken. */
static bool is_moderate(double x)
{
    return fabs(x) < 1e30;
}

static cw_status read_points(building *b, size_t piece, size_t first, cw_error *err)
{
    cwi_tuples t;
    cw_status st = load_array(b, piece, CWI_GRID_POINTS, b->g->pieces[piece].points, &t, err);
    double *to = b->at + 3 * first;
    for (size_t n = 0; n < t.count && st == CW_OK; n++)
        for (size_t a = 0; a < 3; a++) {
            const double x = cwi_tuples_real(&t, n, a);
            if (!is_moderate(x))
                st = cwi_fail(err, CW_ERR_FORMAT,
                              "point %zu has the coordinate %g; they must be finite and below "
                              "1e30",
                              n, x);
            *to++ = x + 0.0; /* no negative zeros, so that equal places have equal bits */
        }
    drop_array(b, &t);
    return st;
}

static cw_status load_corners(building *b, size_t piece, cwi_corner_list *list, cw_error *err)
{
    const cwi_grid_piece *p = &b->g->pieces[piece];
    size_t count = p->listed;
    *list = (cwi_corner_list){
        .counted = p->listed, .points = p->points, .point_field = b->g->point_field};
    cw_status st =
        load_array(b, piece, CWI_GRID_ENDS, list->counted ? 0 : p->cells, &list->ends, err);
    if (st == CW_OK && list->ends.count) {
        const int64_t last = cwi_tuples_whole(&list->ends, list->ends.count - 1);
        count = last > 0 ? (size_t)last : 0;
    }
    return st == CW_OK ? load_array(b, piece, CWI_GRID_CORNERS, count, &list->numbers, err)
                       : st;
}

/* Reads the corners of one piece's remaining cells to *to, which advances. base is the number
 * of the piece's first sample. */
static cw_status read_corners(building *b, size_t piece, const uint8_t *types, size_t base,
                              uint32_t **to, cw_error *err)
{
    const cwi_grid_piece *p = &b->g->pieces[piece];
    cwi_corner_list list;
    cw_status st = load_corners(b, piece, &list, err);
    for (size_t n = 0; n < p->cells && st == CW_OK; n++) {
        size_t count;
        st = cwi_corner_list_next(&list, types[n], base, *to, &count, err);
        *to += count;
    }
    drop_array(b, &list.ends);
    drop_array(b, &list.numbers);
    return st;
}

static void number_corners(const cwi_grid_piece *p, const uint8_t *types, size_t base,
                           uint32_t **to)
{
    for (size_t n = 0; n < p->cells; n++) {
        size_t corners[8];
        if (types[n] == CWI_VTK_EMPTY)
            continue;
        find_corners(p, n, corners);
        for (int c = 0; c < 8; c++)
            *(*to)++ = (uint32_t)(base + corners[c]);
    }
}

static cw_status read_cells(building *b, cw_error *err)
{
    const cwi_irregular *g = b->g;
    const uint8_t *types = b->types;
    uint32_t *to = b->corners;
    size_t first = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < g->piece_count && st == CW_OK; n++) {
        const cwi_grid_piece *p = &g->pieces[n];
        st = open_piece(b, n, err);
        if (st == CW_OK)
            st = read_points(b, n, first, err);
        if (st == CW_OK && is_curvilinear(p))
            number_corners(p, types, first, &to);
        else if (st == CW_OK)
            st = read_corners(b, n, types, first, &to, err);
        st = end_piece(b, st, err);
        types += p->cells;
        first += p->points;
    }
    return st;
}

/* --- values ------------------------------------------------------------------------------ */

static size_t value_bytes(const building *b)
{
    return cw_type_size(b->volume.type) * b->volume.components;
}

static cw_status allocate_values(building *b, cw_error *err)
{
    const size_t bytes = value_bytes(b) * b->volume.dim[0];
    cw_status st = take_bytes(b, bytes, err);
    if (st == CW_OK && !(b->volume.owned = cwi_alloc_zeroed(bytes, 1)))
        st = cwi_fail_memory(err);
    b->volume.data = b->volume.owned;
    return st;
}

static cw_status read_values(building *b, cw_error *err)
{
    cw_status st = allocate_values(b, err);
    char *to = b->volume.owned;
    for (size_t n = 0; n < b->g->piece_count && st == CW_OK; n++) {
        cwi_tuples t = {0};
        const size_t bytes = value_bytes(b) * b->g->pieces[n].points;
        st = open_piece(b, n, err);
        if (st == CW_OK)
            st = load_array(b, n, CWI_GRID_VALUES, b->g->pieces[n].points, &t, err);
        if (st == CW_OK && bytes)
            memcpy(to, t.data.data, bytes);
        to += bytes;
        drop_array(b, &t);
        st = end_piece(b, st, err);
    }
    return st;
}

/* Adds a cell's value to each of its corners; a corner may occur twice. */
static void add_value(building *b, const cwi_tuples *t, size_t cell, const uint32_t *corners,
                      size_t corner_count, uint32_t *around)
{
    double *sums = b->volume.owned;
    for (size_t c = 0; c < corner_count; c++) {
        bool met = false;
        for (size_t d = 0; d < c; d++)
            met = met || corners[d] == corners[c];
        if (met)
            continue;
        around[corners[c]]++;
        for (size_t i = 0; i < t->components; i++)
            sums[corners[c] * t->components + i] += cwi_tuples_real(t, cell, i);
    }
}

static cw_status add_values(building *b, uint32_t *around, cw_error *err)
{
    const cwi_irregular *g = b->g;
    const uint8_t *types = b->types;
    const uint32_t *corners = b->corners;
    cw_status st = CW_OK;
    for (size_t n = 0; n < g->piece_count && st == CW_OK; types += g->pieces[n++].cells) {
        cwi_tuples t = {0};
        st = open_piece(b, n, err);
        if (st == CW_OK)
            st = load_array(b, n, CWI_GRID_VALUES, g->pieces[n].cells, &t, err);
        for (size_t c = 0; c < t.count && st == CW_OK; c++) {
            if (types[c] == CWI_VTK_EMPTY)
                continue;
            const size_t count = cwi_shape_corners(cwi_cell_kind_find(types[c])->shape);
            add_value(b, &t, c, corners, count, around);
            corners += count;
        }
        drop_array(b, &t);
        st = end_piece(b, st, err);
    }
    return st;
}

/* Computes the mean of the cells around each sample; without any, it has no value. */
static cw_status average_values(building *b, cw_error *err)
{
    const size_t samples = b->volume.dim[0], components = b->volume.components;
    cw_status st = allocate_values(b, err);
    if (st == CW_OK)
        st = take_bytes(b, samples * sizeof(uint32_t), err);
    uint32_t *around = st == CW_OK ? cwi_alloc_zeroed(samples, sizeof *around) : NULL;
    if (st == CW_OK && !around)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = add_values(b, around, err);
    double *values = b->volume.owned;
    for (size_t n = 0; n < samples && st == CW_OK; n++)
        for (size_t i = 0; i < components; i++)
            values[n * components + i] =
                around[n] ? values[n * components + i] / around[n] : NAN;
    cwi_free(around);
    return st;
}

/* Keeps the first of equal samples. Values of cells are not compared. */
static cw_status merge_samples(building *b, cw_error *err)
{
    const size_t samples = b->volume.dim[0], bytes = b->g->of_cells ? 0 : value_bytes(b);
    void *values = b->g->of_cells ? (void *)b->at : b->volume.owned;
    size_t same;
    cw_status st = take_bytes(b, (uint64_t)samples * 20, err);
    if (st != CW_OK)
        return st;
    uint32_t *map = cwi_alloc_array(samples, sizeof *map);
    if (!map || !cwi_samples_map(b->at, values, bytes, samples, map, &same)) {
        cwi_free(map);
        return cwi_fail_memory(err);
    }
    if (same) {
        cwi_samples_drop(b->at, values, bytes, samples, map);
        for (size_t c = 0; c < b->corner_count; c++)
            b->corners[c] = map[b->corners[c]];
        b->volume.dim[0] -= same;
        cwi_note(b->desc, "merged, because others have the same position%s: %zu of %zu points",
                 b->g->of_cells ? "" : " and value", same, samples);
    }
    cwi_free(map);
    b->bytes -= (uint64_t)samples * 20;
    return CW_OK;
}

/* --- all of it --------------------------------------------------------------------------- */

static void note_count(const building *b, const char *what, size_t count)
{
    if (count)
        cwi_note(b->desc, "%s: %zu of %zu cells", what, count, b->cells);
}

static void note_cells(const building *b)
{
    note_count(b, "left out, as they have fewer than three dimensions", b->flat);
    note_count(b, "left out, as they are hidden or another piece's", b->marked);
    note_count(b, "curved, and taken as straight, by their corners alone", b->curved);
    if (b->g->of_cells)
        cwi_note(b->desc,
                 "'%s' has a value for each cell: samples are the mean of the cells around "
                 "them",
                 b->g->array);
}

static cw_status refuse_options(const cw_read_desc *desc, cw_error *err)
{
    const cw_volume irregular = {.cells = &(cw_cells){.count = 0}};
    if (desc->spacing_mm[0] != 0)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "a spacing is given (desc->spacing_mm); the samples of an irregular grid stand "
            "where its points are");
    return desc->region ? cwi_volume_expect_dense(&irregular, "a crop", err) : CW_OK;
}

cw_status cwi_irregular_read(const cwi_irregular *grid, const cwi_input *in,
                             const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    building b = {.g = grid, .in = in, .desc = desc};
    const bool whole = !desc->header_only;
    cw_status st = refuse_options(desc, err);
    if (st == CW_OK)
        st = find_cells(&b, err);
    if (st == CW_OK)
        st = allocate_grid(&b, err);
    if (st == CW_OK)
        note_cells(&b);
    if (st == CW_OK && whole)
        st = read_cells(&b, err);
    if (st == CW_OK && whole && !grid->of_cells)
        st = read_values(&b, err);
    if (st == CW_OK && whole)
        st = merge_samples(&b, err);
    if (st == CW_OK && whole && grid->of_cells)
        st = average_values(&b, err);
    cwi_free(b.types);
    if (st == CW_OK)
        *volume = b.volume;
    else
        cw_volume_free(&b.volume);
    return st;
}
