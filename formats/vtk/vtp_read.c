/* Reads the numbers of VTK's XML PolyData: polygons and strips with the data of their points, piece by
 * piece. The elements are known; each needed array is read after another, by the reader of voxels. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/grid_arrays.h"
#include "formats/mesh/face_colors.h"
#include "formats/mesh/join_pieces.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_sides.h"
#include "formats/vtk/vtp.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Bits of vtkGhostType: another piece has the cell, finer ones have replaced it, it is blanked. */
enum { LEFT_OUT_CELL = 1 | 8 | 32 };

typedef cwi_vtp_role role;

static const uint8_t white[4] = {255, 255, 255, 255};

typedef struct reading {
    cwi_mesh_input *in;
    cw_mesh *mesh;
    cw_mesh_file *metadata;
    const cwi_vtp *v;
    const cwi_vtp_piece *piece; /* the one at hand */
    const cwi_input *file;      /* that holds it */
    uint64_t claimed, bytes;    /* minimum bytes of all arrays so far; bytes of all files */
    size_t marked; /* cells left out, as another piece has them or they are hidden */
    bool keeps[CWI_VTP_ROLE_COUNT];      /* all pieces with points have it */
    size_t capacity[CWI_VTP_ROLE_COUNT]; /* of attributes */
    cwi_mesh_build build;
    cwi_tuples cell_colors, marks; /* of all cells; empty: none */
    cwi_face_colors faces;
    size_t *first;   /* first vertex of each piece, and the end */
    uint32_t *group; /* of each piece */
    int64_t *ids;    /* of vertices */
} reading;

/* --- numbers ----------------------------------------------------------------------------- */

static void drop_tuples(reading *r, cwi_tuples *t)
{
    r->in->bytes -= t->bytes;
    cwi_tuples_free(t);
}

/* Refuses pieces that share the bytes of their arrays: few bytes would give many triangles. */
static cw_status claim_bytes(reading *r, const cwi_source *src, cw_error *err)
{
    r->claimed += src->encoding == CWI_RAW ? src->bytes : src->bytes / 1032;
    if (r->v->count == 1 || r->claimed <= r->bytes)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "the arrays up to piece %zu take %llu bytes of the %llu that there are: some "
        "share theirs",
        (size_t)(r->piece - r->v->pieces), (unsigned long long)r->claimed,
        (unsigned long long)r->bytes);
}

/* Reads an array of `count` tuples; field: name of the count in the file. */
static cw_status load_tuples(reading *r, role which, const char *field, uint64_t count,
                             cwi_tuples *t, cw_error *err)
{
    const cwi_vtp_piece *p = r->piece;
    const cw_read_desc desc = {.progress = r->in->desc.progress};
    cwi_source src;
    bool wide;
    *t = (cwi_tuples){.count = 0};
    if (count == 0)
        return CW_OK;
    cw_status st = cwi_vtk_xml_tuples(&p->file, p->has[which] ? &p->arrays[which] : NULL, field,
                                      (size_t)count, r->file, &src, &wide, err);
    if (st == CW_OK)
        st = claim_bytes(r, &src, err);
    if (st == CW_OK)
        st = cwi_mesh_take_bytes(r->in, src.bytes, err);
    return st == CW_OK ? cwi_tuples_load(&src, r->file, &desc, wide, t, err) : st;
}

/* --- vertices ---------------------------------------------------------------------------- */

/* Reads points. Those of local files count from the origin of the first one. */
static cw_status read_points(reading *r, cw_error *err)
{
    const double *own = r->piece->origin, *first = r->v->pieces[0].origin;
    cwi_tuples n;
    cw_status st =
        load_tuples(r, CWI_VTP_POINTS, "NumberOfPoints", (uint64_t)r->piece->points, &n, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, r->build.point_count + n.count, 0, err);
    for (size_t i = 0; i < n.count && st == CW_OK; i++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] =
                cwi_tuples_real(&n, i, a) + (own[a] != first[a] ? own[a] - first[a] : -0.0);
        st = cwi_build_point(&r->build, point, err);
    }
    drop_tuples(r, &n);
    return st;
}

static float to_single(double number)
{
    return fabs(number) <= (double)FLT_MAX ? (float)number : NAN;
}

/* Stores the numbers of one point, in an array of an attribute. */
static void put_attribute(role which, const cwi_tuples *n, size_t i, size_t given, size_t v,
                          void *to)
{
    const size_t count = which == CWI_VTP_NORMALS ? 3 : which == CWI_VTP_COLORS ? 4 : 1;
    if (which == CWI_VTP_IDS) {
        ((int64_t *)to)[v] = cwi_tuples_whole(n, i);
        return;
    }
    for (size_t c = 0; c < count; c++) {
        const bool opaque = which == CWI_VTP_COLORS && c >= given;
        const double number = opaque ? 255 : cwi_tuples_real(n, i, c);
        if (which == CWI_VTP_COLORS)
            ((uint8_t *)to)[4 * v + c] = (uint8_t)number;
        else if (which == CWI_VTP_LABELS)
            ((uint32_t *)to)[v] = number > 0 ? (uint32_t)fmin(number, UINT32_MAX) : 0;
        else
            ((float *)to)[count * v + c] = to_single(number);
    }
}

/* Reads an array of PointData into one of the mesh, which has `size` bytes per vertex. */
static cw_status read_attribute(reading *r, role which, void *array, size_t size, cw_error *err)
{
    const size_t first = r->build.point_count - (size_t)r->piece->points;
    cwi_tuples n;
    void *to;
    if (!r->keeps[which] || r->piece->points == 0)
        return CW_OK;
    cw_status st = load_tuples(r, which, "NumberOfPoints", (uint64_t)r->piece->points, &n, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, array, &r->capacity[which], first + n.count, size, err);
    memcpy(&to, array, sizeof to);
    for (size_t i = 0; i < n.count && st == CW_OK; i++)
        put_attribute(which, &n, i, r->piece->arrays[which].components, first + i, to);
    drop_tuples(r, &n);
    return st;
}

static cw_status read_vertices(reading *r, cw_error *err)
{
    const struct {
        role which;
        void *array;
        size_t size;
    } rows[] = {
        {CWI_VTP_NORMALS, &r->mesh->normals, 3 * sizeof(float)},
        {CWI_VTP_COLORS, &r->mesh->colors, 4},
        {CWI_VTP_SCALARS, &r->mesh->scalars, sizeof(float)},
        {CWI_VTP_LABELS, &r->mesh->labels, sizeof(uint32_t)},
        {CWI_VTP_IDS, &r->ids, sizeof(int64_t)},
    };
    cw_status st = read_points(r, err);
    for (size_t n = 0; n < sizeof rows / sizeof *rows && st == CW_OK; n++)
        st = read_attribute(r, rows[n].which, rows[n].array, rows[n].size, err);
    return st;
}

/* --- faces ------------------------------------------------------------------------------- */

/* Adds a corner, which must be a point of the piece. */
static cw_status add_corner(reading *r, const cwi_tuples *corners, size_t i, cw_error *err)
{
    const int64_t point = cwi_tuples_whole(corners, i), points = r->piece->points;
    if (point >= points)
        return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %lld of %lld",
                        r->build.triangle_count, (long long)point, (long long)points);
    const int64_t first = (int64_t)r->build.point_count - points;
    return cwi_build_corner(&r->build, point < 0 ? point : first + point, err);
}

/* Adds the corners of one polygon, or of one strip, whose triangles have alternating
 * winding. */
static cw_status add_corners(reading *r, const cwi_tuples *corners, size_t from, size_t to,
                             bool strip, cw_error *err)
{
    cw_status st = CW_OK;
    if (!strip) {
        for (size_t i = from; i < to && st == CW_OK; i++)
            st = add_corner(r, corners, i, err);
        return st == CW_OK ? cwi_build_end_face(&r->build, r->metadata, err) : st;
    }
    for (size_t i = from; i + 2 < to && st == CW_OK; i++) {
        const size_t odd = (i - from) % 2;
        const size_t order[3] = {i, i + 1 + odd, i + 2 - odd};
        for (int c = 0; c < 3 && st == CW_OK; c++)
            st = add_corner(r, corners, order[c], err);
        r->build.corners = 0;
    }
    return st;
}

static cw_status read_cell_data(reading *r, cw_error *err)
{
    const cwi_vtp_piece *p = r->piece;
    const uint64_t cells = (uint64_t)(p->skipped + p->polygons + p->strips);
    cw_status st = CW_OK;
    if (p->has[CWI_VTP_CELL_COLORS])
        st = load_tuples(r, CWI_VTP_CELL_COLORS, "cells", cells, &r->cell_colors, err);
    if (r->cell_colors.count && st == CW_OK) /* pieces before may have none */
        st = cwi_color_faces(&r->faces, r->build.triangle_count, white, err);
    if (p->has[CWI_VTP_CELL_MARKS] && st == CW_OK)
        st = load_tuples(r, CWI_VTP_CELL_MARKS, "cells", cells, &r->marks, err);
    return st;
}

/* Returns true for a cell that another piece has, or that is hidden. */
static bool is_left_out(const reading *r, size_t cell)
{
    if (!r->marks.count)
        return false;
    const int64_t mark = cwi_tuples_whole(&r->marks, cell);
    return r->piece->marks_are_levels ? mark > 0 : (mark & LEFT_OUT_CELL) != 0;
}

/* Gives the triangles of the last cell its colour. */
static cw_status color_cell(reading *r, size_t cell, cw_error *err)
{
    uint8_t color[4] = {255, 255, 255, 255};
    if (!r->cell_colors.count)
        return CW_OK;
    for (size_t c = 0; c < r->piece->arrays[CWI_VTP_CELL_COLORS].components; c++)
        color[c] = (uint8_t)cwi_tuples_real(&r->cell_colors, cell, c);
    return cwi_color_faces(&r->faces, r->build.triangle_count, color, err);
}

/* Checks the ends: they must not decrease; the last one is the number of corners. */
static cw_status check_ends(const cwi_tuples *ends, const char *field, cw_error *err)
{
    int64_t before = 0;
    for (size_t i = 0; i < ends->count; i++) {
        const int64_t end = cwi_tuples_whole(ends, i);
        if (end < before)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'offsets' says that number %zu of '%s' ends at %lld, behind %lld",
                            i, field, (long long)end, (long long)before);
        before = end;
    }
    return CW_OK;
}

static cw_status read_faces(reading *r, role first, const char *field, int64_t count,
                            cw_error *err)
{
    const cwi_vtp_piece *p = r->piece;
    const bool strip = first == CWI_VTP_STRIPS;
    const size_t before = (size_t)(p->skipped + (strip ? p->polygons : 0)); /* cells */
    cwi_tuples ends = {0}, corners = {0};
    cw_status st = load_tuples(r, first + 1, field, (uint64_t)count, &ends, err);
    if (st == CW_OK)
        st = check_ends(&ends, field, err);
    if (st == CW_OK && ends.count)
        st = load_tuples(r, first, "offsets", (uint64_t)cwi_tuples_whole(&ends, ends.count - 1),
                         &corners, err);
    if (st == CW_OK && corners.count > 2 * ends.count)
        st = cwi_build_reserve(&r->build, 0,
                               r->build.triangle_count + corners.count - 2 * ends.count, err);
    for (size_t i = 0, from = 0; i < ends.count && st == CW_OK; i++) {
        const size_t to = (size_t)cwi_tuples_whole(&ends, i);
        const bool left_out = is_left_out(r, before + i);
        r->marked += left_out;
        if (!left_out)
            st = add_corners(r, &corners, from, to, strip, err);
        if (st == CW_OK && !left_out)
            st = color_cell(r, before + i, err);
        from = to;
    }
    drop_tuples(r, &ends);
    drop_tuples(r, &corners);
    return st;
}

/* --- pieces ------------------------------------------------------------------------------ */

/* Finds the attributes of all pieces that have points, and reports those of some pieces alone. */
static void choose_attributes(reading *r)
{
    static const struct {
        role which;
        const char *name;
    } rows[] = {{CWI_VTP_NORMALS, "normals"},
                {CWI_VTP_COLORS, "colours"},
                {CWI_VTP_SCALARS, "scalars"},
                {CWI_VTP_LABELS, "labels"},
                {CWI_VTP_IDS, NULL}};
    const cwi_vtp *v = r->v;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const cwi_vtk_array *first = NULL;
        const role which = rows[k].which;
        char text[64];
        bool some = false, all = true;
        for (size_t n = 0; n < v->count; n++) {
            const cwi_vtp_piece *p = &v->pieces[n];
            const bool has = p->points && p->has[which] &&
                             (!first || which != CWI_VTP_SCALARS ||
                              strcmp(first->name, p->arrays[which].name) == 0);
            first = has && !first ? &p->arrays[which] : first;
            some = some || has;
            all = all && (has || p->points == 0);
        }
        r->keeps[which] = some && all && (which != CWI_VTP_IDS || v->count > 1);
        snprintf(text, sizeof text, "%s of some pieces", rows[k].name ? rows[k].name : "");
        cwi_say_left_out(r->metadata, some && !all && rows[k].name, text);
    }
}

static cw_status read_piece(reading *r, cw_error *err)
{
    const cwi_vtp_piece *p = r->piece;
    r->metadata->skipped += (size_t)p->skipped;
    cw_status st = read_vertices(r, err);
    if (st == CW_OK)
        st = read_cell_data(r, err);
    if (st == CW_OK)
        st = read_faces(r, CWI_VTP_POLYGONS, "NumberOfPolys", p->polygons, err);
    if (st == CW_OK)
        st = read_faces(r, CWI_VTP_STRIPS, "NumberOfStrips", p->strips, err);
    drop_tuples(r, &r->cell_colors);
    drop_tuples(r, &r->marks);
    return st;
}

static cw_status begin_part(reading *r, size_t n, const cwi_names *names, cw_error *err)
{
    const bool begins = n == 0 || r->group[n] != r->group[n - 1];
    return names && begins ? cwi_mesh_begin_part(r->in, names->items[r->group[n]],
                                                 r->build.triangle_count, err)
                           : CW_OK;
}

static cw_status read_pieces(reading *r, cwi_vtk_sides *sides, const cwi_names *names,
                             cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < r->v->count && st == CW_OK; n++) {
        r->piece = &r->v->pieces[n];
        r->group[n] = r->piece->group;
        r->first[n] = r->build.point_count;
        st = begin_part(r, n, names, err);
        if (st == CW_OK && sides)
            st = cwi_vtk_sides_open(sides, r->piece->side, &r->file, err);
        if (st != CW_OK)
            break;
        st = read_piece(r, err);
        if (st != CW_OK && sides)
            st = cwi_fail_in(err, st, r->file->path);
    }
    r->first[r->v->count] = r->build.point_count;
    return st;
}

static size_t count_groups(const reading *r)
{
    size_t count = 0;
    for (size_t n = 0; n < r->v->count; n++)
        count += n == 0 || r->group[n] != r->group[n - 1];
    return count;
}

static cw_status finish_mesh(reading *r, cw_error *err)
{
    const cwi_mesh_pieces pieces = {
        .first = r->first, .group = r->group, .count = r->v->count, .ids = r->ids};
    cw_status st = cwi_build_finish(&r->build, r->mesh, r->metadata, err);
    if (st == CW_OK)
        st = cwi_color_mesh(&r->faces, false, r->mesh, err);
    r->metadata->pieces = count_groups(r) < r->v->count ? r->v->count : 0;
    r->metadata->marked_cells = r->marked;
    return st == CW_OK && (r->v->count > 1 || r->marked)
               ? cwi_join_pieces(r->in, &pieces, r->mesh, &r->metadata->merged_vertices, err)
               : st;
}

cw_status cwi_vtp_load(const cwi_vtp *v, cwi_vtk_sides *sides, uint64_t bytes,
                       const cwi_names *names, cwi_mesh_input *in, cw_mesh *mesh,
                       cw_mesh_file *metadata, cw_error *err)
{
    reading *r = cwi_alloc_zeroed(1, sizeof *r);
    if (!r)
        return cwi_fail_memory(err);
    *r = (reading){.in = in,
                   .mesh = mesh,
                   .metadata = metadata,
                   .v = v,
                   .file = &in->file,
                   .bytes = bytes,
                   .build = {.in = in},
                   .faces = {.in = in},
                   .first = cwi_alloc_zeroed(v->count + 1, sizeof *r->first),
                   .group = cwi_alloc_zeroed(v->count + 1, sizeof *r->group)};
    metadata->known = v->facts.known;
    metadata->axes = v->facts.axes;
    metadata->local = v->facts.local;
    if (v->count)
        memcpy(mesh->origin, v->pieces[0].origin, sizeof mesh->origin);
    choose_attributes(r);
    cw_status st =
        r->first && r->group ? read_pieces(r, sides, names, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = finish_mesh(r, err);
    drop_tuples(r, &r->cell_colors);
    drop_tuples(r, &r->marks);
    cwi_build_free(&r->build);
    cwi_face_colors_free(&r->faces);
    cwi_free(r->first);
    cwi_free(r->group);
    cwi_free(r->ids);
    cwi_free(r);
    return st;
}

/* --- files ------------------------------------------------------------------------------- */

static cw_status parse_sides(cwi_vtp *v, cwi_vtk_sides *sides, uint64_t *bytes, cw_error *err)
{
    const cwi_input *in;
    cw_status st = cwi_vtk_sides_check(sides, bytes, err);
    v->is_side = true;
    for (size_t n = 0; n < v->names.count && st == CW_OK; n++) {
        st = cwi_vtk_sides_open(sides, n, &in, err);
        if (st != CW_OK)
            break;
        st = cwi_vtp_parse(v, in, n, 0, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, v->names.items[n]);
    }
    if (st == CW_OK && !v->count)
        st = cwi_fail(err, CW_ERR_FORMAT, "PPolyData lists no Piece");
    return st;
}

cw_status cwi_vtp_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    cwi_vtp v = {0};
    cwi_vtk_sides sides = {.list = &in->file, .names = &v.names};
    uint64_t bytes = in->file.size;
    cw_status st = cwi_vtp_parse(&v, &in->file, 0, 0, err);
    const bool is_list = v.is_list;
    if (st == CW_OK && is_list)
        st = parse_sides(&v, &sides, &bytes, err);
    if (st == CW_OK)
        st = cwi_vtp_load(&v, is_list ? &sides : NULL, bytes, NULL, in, mesh, metadata, err);
    cwi_vtk_sides_close(&sides);
    cwi_vtp_free(&v);
    return st;
}
