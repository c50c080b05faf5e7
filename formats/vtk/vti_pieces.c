/* Joins the pieces of VTK's XML image data and rectilinear grids: of one file (.vti, .vtr), or of the
 * files that a list names (.pvti, .pvtr). */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/vti.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_grid.h"
#include "formats/vtk/vtk_sides.h"

#include <math.h>
#include <string.h>

/* The files of pieces: the file itself, or those that it lists. */
typedef struct joining {
    const cwi_input *in;
    const cw_read_desc *desc;
    cwi_vti_file list;   /* the file itself */
    cwi_vti_file *files; /* file_count of them: &list, or those of list.sources */
    size_t file_count, piece_count;
    cwi_vtk_sides sides;       /* the files of a list */
    int64_t low[3];            /* first index of the whole, of points */
    const cwi_vti_array *like; /* the array of the first piece */
    bool of_cells;
    cw_volume shape;     /* of the whole */
    cw_box box;          /* the wanted part */
    cw_volume all;       /* the voxels of that */
    uint8_t *has;        /* a bit a voxel: some piece has it */
    double held;         /* voxels of all pieces together */
    double along[3];     /* points of all pieces together along each axis */
    cw_volume places[3]; /* coordinates of a rectilinear grid; NaN: of no piece so far */
} joining;

/* Calls a file's reader with the file open. */
static cw_status with_file(joining *j, size_t n,
                           cw_status (*read)(joining *, size_t, const cwi_input *, cw_error *),
                           cw_error *err)
{
    const cwi_input *side;
    if (!j->list.is_list)
        return read(j, n, j->in, err);
    cw_status st = cwi_vtk_sides_open(&j->sides, n, &side, err);
    if (st != CW_OK)
        return st;
    cwi_input in = *side;
    in.arrays = n == 0 ? j->in->arrays : NULL;
    st = read(j, n, &in, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, in.path);
}

/* --- the pieces --------------------------------------------------------------------------- */

static cw_status open_listed(joining *j, size_t n, const cwi_input *side, cw_error *err)
{
    cwi_vti_file *f = &j->files[n];
    f->choice = (cwi_vti_choice){.expected = j->like ? j->like->data.name : j->in->array,
                                 .list = side->arrays};
    cw_status st = cwi_vti_open(side, f, err);
    if (st == CW_OK && (f->is_list || f->common.rectilinear != j->list.common.rectilinear))
        return cwi_fail(err, CW_ERR_FORMAT, "it is no %s, as the pieces of this list are",
                        j->list.common.rectilinear ? "RectilinearGrid" : "ImageData");
    if (st == CW_OK && !j->like && f->count) {
        const cwi_vti_array *chosen = cwi_vti_chosen(&f->pieces[0], &j->of_cells);
        j->like = *chosen->data.name ? chosen : NULL;
    }
    return st;
}

static cw_status open_files(joining *j, cw_error *err)
{
    cw_status st = CW_OK;
    if (!j->list.is_list) {
        j->files = &j->list;
        j->file_count = 1;
    } else {
        j->file_count = j->list.sources.count;
        uint64_t bytes;
        j->files = cwi_alloc_zeroed(j->file_count, sizeof *j->files);
        st = j->files ? cwi_vtk_sides_check(&j->sides, &bytes, err) : cwi_fail_memory(err);
        for (size_t n = 0; n < j->file_count && st == CW_OK; n++)
            st = with_file(j, n, open_listed, err);
    }
    for (size_t n = 0; n < j->file_count && st == CW_OK; n++)
        j->piece_count += j->files[n].count;
    return st == CW_OK && !j->piece_count
               ? cwi_fail(err, CW_ERR_FORMAT, "it has no Piece element")
               : st;
}

static const cwi_vti *first_piece(const joining *j, size_t *file)
{
    for (*file = 0; j->files[*file].count == 0;)
        ++*file;
    return &j->files[*file].pieces[0];
}

/* Makes the shape of the whole from that of the first piece. */
static cw_status take_shape(joining *j, size_t n, const cwi_input *in, cw_error *err)
{
    const cwi_vti *first = &j->files[n].pieces[0];
    const int64_t *whole = j->list.extent;
    cwi_source src = {0};
    cw_status st = cwi_vti_describe(first, &j->files[n].choice, in, &src, err);
    if (st == CW_OK) {
        j->like = cwi_vti_chosen(first, &j->of_cells);
        cwi_array_list_choose(j->in->arrays, j->like->data.name, j->of_cells);
        j->shape = src.shape;
    }
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        const int64_t shift = whole[2 * a] - first->extent[2 * a];
        const int64_t points = whole[2 * a + 1] - whole[2 * a] + 1;
        j->low[a] = whole[2 * a];
        j->shape.dim[a] = (size_t)(j->of_cells && points > 1 ? points - 1 : points);
        for (int r = 0; r < 3 && !j->list.common.rectilinear; r++)
            j->shape.affine[r][3] += j->shape.affine[r][a] * (double)shift;
        j->shape.coordinates[a] = NULL; /* those of the piece */
    }
    j->shape.owned_grid = NULL;
    cwi_source_free(&src);
    return st;
}

/* Finds the box of a piece within the whole. */
static cw_status find_box(const joining *j, const cwi_vti *piece, const cw_volume *shape,
                          cw_box *box, cw_error *err)
{
    for (int a = 0; a < 3; a++) {
        const int64_t first = piece->extent[2 * a] - j->low[a];
        box->count[a] = shape->dim[a];
        box->first[a] = (size_t)first;
        if (first < 0 || box->first[a] + box->count[a] > j->shape.dim[a])
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "a Piece from %lld to %lld along %c leaves the 'WholeExtent', %lld to "
                "%lld",
                (long long)piece->extent[2 * a], (long long)piece->extent[2 * a + 1], "xyz"[a],
                (long long)j -> list.extent[2 * a], (long long)j->list.extent[2 * a + 1]);
    }
    return CW_OK;
}

/* Reduces a box to what lies in another. Returns false if nothing does. */
static bool meet_boxes(cw_box *box, const cw_box *other)
{
    for (int a = 0; a < 3; a++) {
        const size_t end = box->first[a] + box->count[a];
        const size_t other_end = other->first[a] + other->count[a];
        const size_t first = box->first[a] > other->first[a] ? box->first[a] : other->first[a];
        const size_t last = end < other_end ? end : other_end;
        if (first >= last)
            return false;
        box->first[a] = first;
        box->count[a] = last - first;
    }
    return true;
}

/* Checks that a piece fits the whole, and that its file can hold it, before memory is taken. */
static cw_status check_piece(joining *j, const cwi_vti *piece, const cwi_vti_choice *choice,
                             const cwi_input *in, cw_error *err)
{
    const cw_read_desc head = {.header_only = true, .max_voxels = UINT64_MAX};
    cwi_source src = {0};
    cw_volume shape = {0};
    cw_box box;
    cw_status st = cwi_vti_describe(piece, choice, in, &src, err);
    if (st == CW_OK)
        st = find_box(j, piece, &src.shape, &box, err);
    if (st == CW_OK)
        st = cwi_source_load(&src, in, &head, &shape, err);
    if (st == CW_OK) {
        j->held += (double)box.count[0] * (double)box.count[1] * (double)box.count[2];
        for (int a = 0; a < 3; a++)
            j->along[a] += (double)(piece->extent[2 * a + 1] - piece->extent[2 * a] + 1);
    }
    cw_volume_free(&shape);
    cwi_source_free(&src);
    return st;
}

static cw_status check_pieces(joining *j, size_t n, const cwi_input *in, cw_error *err)
{
    const cwi_vti_file *f = &j->files[n];
    cw_status st = CW_OK;
    for (size_t p = 0; p < f->count && st == CW_OK; p++)
        st = check_piece(j, &f->pieces[p], &f->choice, in, err);
    return st;
}

/* Refuses a whole that is far larger than its pieces, before memory is taken for it. Smaller gaps
 * get an error that names their place. */
static cw_status check_sizes(joining *j, cw_error *err)
{
    const size_t *dim = j->shape.dim;
    const double voxels = (double)dim[0] * (double)dim[1] * (double)dim[2];
    cw_status st = CW_OK;
    for (size_t n = 0; n < j->file_count && st == CW_OK; n++)
        st = with_file(j, n, check_pieces, err);
    if (st == CW_OK && j->held < voxels / 2)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the 'WholeExtent' has %.0f voxels; all pieces together have %.0f",
                        voxels, j->held);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        if (j->along[a] < (double)dim[a])
            return cwi_fail(err, CW_ERR_FORMAT,
                            "the 'WholeExtent' has %zu points along %c; all pieces have %.0f",
                            dim[a], "xyz"[a], j -> along[a]);
    return st;
}

/* --- coordinates -------------------------------------------------------------------------- */

/* Puts the coordinates of a piece where they belong among those of the whole. */
static cw_status put_coordinates(joining *j, const cwi_vti *piece, const cw_volume numbers[3],
                                 cw_error *err)
{
    for (int a = 0; a < 3; a++) {
        double *to = cw_volume_voxels(&j->places[a]);
        const int64_t first = piece->extent[2 * a] - j->low[a];
        for (size_t i = 0; i < numbers[a].dim[0]; i++) {
            double *at = to + first + (int64_t)i;
            const double x =
                cwi_voxel_at(numbers[a].type, cwi_voxel_address(&numbers[a], i, 0, 0));
            if (!isnan(*at) && *at != x)
                return cwi_fail(
                    err, CW_ERR_FORMAT,
                    "pieces differ: plane %lld along %c is at %g here, at %g before",
                    (long long)piece->extent[2 * a] + (long long)i, "xyz"[a], x, *at);
            *at = x;
        }
    }
    return CW_OK;
}

static cw_status read_coordinates(joining *j, size_t n, const cwi_input *in, cw_error *err)
{
    const cwi_vti_file *f = &j->files[n];
    cw_status st = CW_OK;
    for (size_t p = 0; p < f->count && st == CW_OK; p++) {
        cw_volume numbers[3] = {0};
        st = cwi_vti_coordinates_load(&f->pieces[p], in, numbers, err);
        if (st == CW_OK)
            st = put_coordinates(j, &f->pieces[p], numbers, err);
        for (int a = 0; a < 3; a++)
            cw_volume_free(&numbers[a]);
    }
    return st;
}

/* Gives the whole the coordinates of its pieces. */
static cw_status join_coordinates(joining *j, cw_error *err)
{
    cw_status st = CW_OK;
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        const size_t points = (size_t)(j->list.extent[2 * a + 1] - j->low[a] + 1);
        const size_t dim[3] = {points, 1, 1};
        st = cw_volume_alloc(&j->places[a], CW_F64, dim, 1, 1, err);
        double *at = st == CW_OK ? cw_volume_voxels(&j->places[a]) : NULL;
        for (size_t i = 0; i < points && at; i++)
            at[i] = NAN;
    }
    for (size_t n = 0; n < j->file_count && st == CW_OK; n++)
        st = with_file(j, n, read_coordinates, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        for (size_t i = 0; i < j->places[a].dim[0]; i++)
            if (isnan(((const double *)j->places[a].data)[i]))
                return cwi_fail(err, CW_ERR_FORMAT, "no Piece has the plane %lld along %c",
                                (long long)j->low[a] + (long long)i, "xyz"[a]);
    return st == CW_OK ? cwi_vtk_grid_give(j->places, j->of_cells, &j->shape, err) : st;
}

/* --- voxels ------------------------------------------------------------------------------- */

/* Copies rows of a piece to their place. */
static void copy_rows(joining *j, const cw_volume *part, const cw_box *place)
{
    const size_t voxel = cw_type_size(part->type) * part->components;
    const size_t row = place->count[0] * voxel;
    const size_t *dim = j->all.dim;
    for (size_t z = 0; z < place->count[2]; z++)
        for (size_t y = 0; y < place->count[1]; y++) {
            const size_t at = ((place->first[2] - j->box.first[2] + z) * dim[1] +
                               place->first[1] - j->box.first[1] + y) *
                                  dim[0] +
                              place->first[0] - j->box.first[0];
            memcpy((char *)cw_volume_voxels(&j->all) + at * voxel,
                   (const char *)part->data + (z * place->count[1] + y) * row, row);
            for (size_t x = at; x < at + place->count[0]; x++)
                j->has[x / 8] |= (uint8_t)(1u << x % 8);
        }
}

static cw_status read_piece(joining *j, const cwi_vti *piece, const cwi_vti_choice *choice,
                            const cwi_input *in, cw_error *err)
{
    cwi_source src = {0};
    cw_box box = {{0}, {0}}, place;
    cw_volume part = {0};
    bool of_cells;
    cw_status st = cwi_vti_describe(piece, choice, in, &src, err);
    if (st == CW_OK &&
        (src.shape.type != j->shape.type || src.shape.components != j->shape.components ||
         (cwi_vti_chosen(piece, &of_cells), of_cells != j->of_cells)))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "pieces differ: an array of %zu x %s here, of %zu x %s in the first",
                      src.shape.components, cw_type_name(src.shape.type), j->shape.components,
                      cw_type_name(j->shape.type));
    if (st == CW_OK)
        st = find_box(j, piece, &src.shape, &box, err);
    place = box;
    if (st == CW_OK && meet_boxes(&place, &j->box)) {
        cw_box inside = place;
        for (int a = 0; a < 3; a++)
            inside.first[a] -= box.first[a];
        const cw_read_desc desc = {.region = &inside, .max_voxels = UINT64_MAX};
        st = cwi_source_load(&src, in, &desc, &part, err);
        if (st == CW_OK)
            copy_rows(j, &part, &place);
    }
    cw_volume_free(&part);
    cwi_source_free(&src);
    return st;
}

static cw_status read_pieces(joining *j, size_t n, const cwi_input *in, cw_error *err)
{
    const cwi_vti_file *f = &j->files[n];
    cw_status st = CW_OK;
    for (size_t p = 0; p < f->count && st == CW_OK; p++)
        st = read_piece(j, &f->pieces[p], &f->choice, in, err);
    return st;
}

static cw_status check_whole(const joining *j, cw_error *err)
{
    const size_t *dim = j->all.dim, count = dim[0] * dim[1] * dim[2];
    for (size_t n = 0; n < count; n++)
        if (!(j->has[n / 8] >> n % 8 & 1))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "no Piece has the voxel %zu, %zu, %zu of the 'WholeExtent'",
                            j->box.first[0] + n % dim[0], j->box.first[1] + n / dim[0] % dim[1],
                            j->box.first[2] + n / dim[0] / dim[1]);
    return CW_OK;
}

/* Keeps every n-th voxel, in memory of its own. */
static cw_status thin_voxels(joining *j, const size_t step[3], cw_error *err)
{
    cw_volume view, thin;
    cw_status st = cw_volume_coarsen(&j->all, step, &view, err);
    if (st == CW_OK)
        st = cw_volume_alloc(&thin, view.type, view.dim, view.components, 1, err);
    if (st != CW_OK)
        return st;
    const size_t voxel = cw_type_size(view.type) * view.components;
    char *to = cw_volume_voxels(&thin);
    for (size_t z = 0; z < view.dim[2]; z++)
        for (size_t y = 0; y < view.dim[1]; y++)
            for (size_t x = 0; x < view.dim[0]; x++, to += voxel)
                memcpy(to, cwi_voxel_address(&view, x, y, z), voxel);
    memcpy(thin.affine, view.affine, sizeof thin.affine);
    thin.slope = view.slope;
    cw_volume_free(&j->all);
    j->all = thin;
    return CW_OK;
}

static cw_status load_whole(joining *j, const size_t step[3], cw_error *err)
{
    const cw_volume *v = &j->shape;
    size_t bytes = cw_type_size(v->type) * v->components;
    for (int a = 0; a < 3; a++)
        if (__builtin_mul_overflow(bytes, j->box.count[a], &bytes))
            return cwi_fail(err, CW_ERR_LIMIT, "the 'WholeExtent' is beyond memory");
    cw_volume part = *v;
    part.owned_grid = NULL; /* the coordinates stay those of the shape */
    cw_status st = cwi_volume_shrink(&part, &j->box, err);
    if (st == CW_OK)
        st = cwi_check_limits(&part, bytes, "WholeExtent", j->desc, err);
    if (st == CW_OK && j->desc->header_only) {
        st = cwi_volume_thin(&part, step, err);
        j->all = part;
        j->all.data = NULL;
        return st == CW_OK ? cwi_volume_own_coordinates(&j->all, err) : st;
    }
    if (st == CW_OK)
        st = cw_volume_alloc(&j->all, v->type, part.dim, v->components, 1, err);
    if (st != CW_OK)
        return st;
    memcpy(j->all.affine, part.affine, sizeof part.affine);
    memcpy(j->all.coordinates, part.coordinates, sizeof part.coordinates);
    j->all.slope = 1;
    st = cwi_volume_own_coordinates(&j->all, err);
    if (st != CW_OK)
        return st;
    j->has = cwi_alloc_zeroed(part.dim[0] * part.dim[1] * part.dim[2] / 8 + 1, 1);
    st = j->has ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; n < j->file_count && st == CW_OK; n++) {
        st =
            cwi_progress(&j->desc->progress, "reading", (double)n / (double)j->file_count, err);
        if (st == CW_OK)
            st = with_file(j, n, read_pieces, err);
    }
    if (st == CW_OK)
        st = check_whole(j, err);
    return st == CW_OK && step[0] * step[1] * step[2] > 1 ? thin_voxels(j, step, err) : st;
}

static cw_status join_pieces(joining *j, cw_error *err)
{
    size_t file, step[3];
    if (!j->list.has_extent)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'WholeExtent' does not state the six ends of the whole, which several "
                        "pieces need");
    cw_status st = open_files(j, err);
    if (st != CW_OK)
        return st;
    first_piece(j, &file);
    st = with_file(j, file, take_shape, err);
    if (st == CW_OK)
        st = check_sizes(j, err);
    if (st == CW_OK && j->list.common.rectilinear)
        st = join_coordinates(j, err);
    if (st == CW_OK)
        st = cwi_check_frame(&j->shape, "Direction, Spacing, Origin", err);
    if (st != CW_OK)
        return st;
    cwi_set_spacing(&j->shape, j->desc);
    for (int a = 0; a < 3; a++) {
        step[a] = j->desc->every[a] ? j->desc->every[a] : 1;
        j->box.count[a] = j->shape.dim[a];
    }
    if (j->desc->region)
        j->box = *j->desc->region;
    return load_whole(j, step, err);
}

cw_status cwi_vti_read_pieces(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                              cw_volume *volume, cw_error *err)
{
    joining j = {
        .in = in, .desc = desc, .list.choice = {.expected = in->array, .list = in->arrays}};
    *is_grid = false;
    if (!cwi_vti_may_have_pieces(in))
        return CW_OK;
    j.sides = (cwi_vtk_sides){.list = in, .names = &j.list.sources};
    cw_status st = cwi_vti_open(in, &j.list, err);
    *is_grid = st == CW_OK && (j.list.is_list || j.list.count > 1);
    if (*is_grid)
        st = join_pieces(&j, err);
    if (*is_grid && st == CW_OK) {
        cwi_note(desc, "%zu pieces are joined", j.piece_count);
        *volume = j.all;
        j.all = (cw_volume){0};
    }
    for (size_t n = 0; n < j.file_count && j.list.is_list && j.files; n++)
        cwi_vti_close(&j.files[n]);
    cwi_free(j.list.is_list ? j.files : NULL);
    cwi_vti_close(&j.list);
    cwi_vtk_sides_close(&j.sides);
    for (int a = 0; a < 3; a++)
        cw_volume_free(&j.places[a]);
    cwi_free(j.shape.owned_grid);
    cw_volume_free(&j.all);
    cwi_free(j.has);
    return st;
}
