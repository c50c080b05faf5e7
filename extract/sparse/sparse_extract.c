/* Extracts the isosurface of a sparse grid: marches its blocks in parallel, and joins their
 * meshes at the seams. */
#include "extract/sparse/sparse_extract.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/base/thread_pool.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"
#include "extract/common/extract_limits.h"
#include "extract/common/field_normals.h"
#include "extract/dense/crossed_edges.h"
#include "extract/dense/dense_plan.h"
#include "extract/sparse/block_gather.h"

#include <string.h>

/* Size of a block in cells, along the axes. */
enum {
    CELLS_X = CWI_LEAF * CWI_BLOCK_X,
    CELLS_Y = CWI_LEAF * CWI_BLOCK_Y,
    CELLS_Z = CWI_LEAF * CWI_BLOCK_Z
};
static const int cells[3] = {CELLS_X, CELLS_Y, CELLS_Z};

/* A thread's data of the block it works on. */
typedef struct worker {
    cwi_plan plan;
    cwi_gathering gathering;
    cwi_seam *seam;
    cwi_stranger *strangers;
    size_t seam_count, stranger_count;
    uint32_t *number; /* in the mesh, of a block's vertices */
    size_t number_capacity;
    bool missing; /* some gradient vanished */
    cw_status status;
    cw_error error;
} worker;

typedef struct sparse_plan {
    cwi_leaf_blocks blocks;
    cwi_bit_grid whole; /* the level, and the volume; no planes */
    const cwi_engine *engine;
    worker *workers;
    int threads;
    cwi_emission emission;
    cwi_vertex_sink sink;
    const cw_extract_desc *desc;
    bool predicting;    /* pieces are counted, not made */
    size_t made, bytes; /* triangles so far, and their pieces */
    cw_mesh *mesh;
} sparse_plan;

/* --- a block's vertices ------------------------------------------------------------------- */

/* Returns the key of an edge in its block; keys sort as the vertices are numbered. */
static uint32_t key_of(const int at[3], int axis)
{
    return (uint32_t)(((at[2] << 6 | at[1]) << 2 | axis) << 6 | at[0]);
}

static void note_side(worker *w, const int at[3], int axis, uint32_t vertex)
{
    int here[3];
    uint32_t beyond = 0;
    for (int a = 0; a < 3; a++) {
        here[a] = at[a] == cells[a] ? 0 : at[a];
        beyond |= (uint32_t)(at[a] == cells[a]) << a;
    }
    if (beyond)
        w->strangers[w->stranger_count++] = (cwi_stranger){vertex, key_of(here, axis), beyond};
    else
        w->seam[w->seam_count++] =
            (cwi_seam){key_of(here, axis), vertex - (uint32_t)w->stranger_count};
}

/* Notes the vertices of a row's edges along an axis that lie in the block's sides: of rows in a
 * side all, of others those at the ends. */
static void note_row(worker *w, size_t halo, int j, int k, int axis)
{
    const cwi_bit_grid *g = &w->plan.grid;
    const size_t first = halo + 1, row = (size_t)k + first, line = (size_t)j + first;
    const uint64_t edges = cwi_edge_vertices(g, axis, line, row, 0) >> first;
    const uint64_t ends = UINT64_C(1) | UINT64_C(1) << cells[0];
    const bool side = j == 0 || k == 0 || j == cells[1] || k == cells[2];
    const uint32_t number = w->plan.rows[row * g->rows_y + line].first[axis];
    for (uint64_t left = side ? edges : edges & ends; left; left &= left - 1) {
        const int i = __builtin_ctzll(left);
        const uint64_t before = edges & ((UINT64_C(1) << i) - 1);
        note_side(w, (int[3]){i, j, k}, axis, number + (uint32_t)__builtin_popcountll(before));
    }
}

static void note_sides(worker *w, size_t halo)
{
    const cwi_bit_grid *g = &w->plan.grid;
    w->seam_count = w->stranger_count = 0;
    for (int k = 0; k <= cells[2]; k++)
        for (int j = 0; j <= cells[1]; j++) {
            const cwi_row *row =
                &w->plan.rows[((size_t)k + halo + 1) * g->rows_y + (size_t)j + halo + 1];
            for (int axis = 0; axis < 3 && row[0].first[0] != row[1].first[0]; axis++)
                if (row->first[axis] != row->first[axis + 1])
                    note_row(w, halo, j, k, axis);
        }
}

/* Gathers a block, and counts the vertices and triangles of its cells. */
static cw_status look_at(const cwi_leaf_block *b, worker *w, cw_error *err)
{
    cwi_gather(&w->gathering, b, &w->plan.grid);
    cw_status st = cwi_plan_count(&w->plan, 1, &(cw_progress){0}, err);
    if (st == CW_OK)
        note_sides(w, w->gathering.halo);
    return st;
}

/* --- marching: each block by itself ------------------------------------------------------- */

static void *take_memory(char **memory, size_t count, size_t size)
{
    void *here = *memory;
    *memory += count * size;
    return here;
}

static cw_status alloc_piece(const worker *w, bool normals, cwi_block_mesh *piece,
                             cw_error *err)
{
    const size_t v = w->plan.counts.vertices, t = w->plan.counts.triangles,
                 strangers = w->stranger_count;
    char *memory = cwi_alloc_array(cwi_extract_mesh_bytes(&w->plan.counts, normals) +
                                       strangers * sizeof *piece->strangers,
                                   1);
    *piece = (cwi_block_mesh){
        .memory = memory, .vertex_count = v, .triangle_count = t, .stranger_count = strangers};
    if (!memory)
        return cwi_fail_memory(err);
    piece->positions = take_memory(&memory, v, 3 * sizeof *piece->positions);
    piece->normals = normals ? take_memory(&memory, v, 3 * sizeof *piece->normals) : NULL;
    piece->triangles = take_memory(&memory, t, 3 * sizeof *piece->triangles);
    piece->strangers = take_memory(&memory, strangers, sizeof *piece->strangers);
    memcpy(piece->strangers, w->strangers, strangers * sizeof *w->strangers);
    return CW_OK;
}

static cw_status keep_seam(const worker *w, cwi_leaf_block *b, cw_error *err)
{
    b->seam_count = w->seam_count;
    b->seam = cwi_alloc_array(w->seam_count, sizeof *b->seam);
    if (!b->seam)
        return cwi_fail_memory(err);
    memcpy(b->seam, w->seam, w->seam_count * sizeof *b->seam);
    return CW_OK;
}

static cw_status make_piece(const sparse_plan *p, cwi_leaf_block *b, worker *w, cw_error *err)
{
    const cwi_bit_grid *g = &w->plan.grid;
    cwi_vertex_sink sink = p->sink;
    cw_status st = alloc_piece(w, !p->desc->no_normals, &b->piece, err);
    if (st == CW_OK)
        st = keep_seam(w, b, err);
    if (st != CW_OK)
        return st;
    sink.positions = b->piece.positions;
    sink.normals = b->piece.normals;
    sink.grid = &g->volume;
    for (int a = 0; a < 3; a++)
        sink.centre[a] -= (double)cwi_first_sample(&w->gathering, b, a);
    const cwi_row_span all = {.end = g->rows_z, .cells = g->rows_z - 1, .row_end = g->rows_y};
    p->engine->write_span(g, &all, w->plan.rows, &p->emission, &sink, b->piece.triangles);
    w->missing = w->missing || sink.missing;
    return CW_OK;
}

static size_t bytes_of(const sparse_plan *p, const cwi_leaf_block *b)
{
    const cw_extract_counts c = {.vertices = b->vertices, .triangles = b->triangles};
    return cwi_extract_mesh_bytes(&c, !p->desc->no_normals);
}

/* Checks the limits as soon as a block is made, not when all are made. */
static cw_status check_made(sparse_plan *p, const cwi_leaf_block *b, cw_error *err)
{
    const cw_extract_desc *d = p->desc;
    const size_t made = __atomic_add_fetch(&p->made, b->triangles, __ATOMIC_RELAXED);
    size_t bytes = __atomic_add_fetch(&p->bytes, bytes_of(p, b), __ATOMIC_RELAXED);
    if (d->max_triangles && made > d->max_triangles)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "the surface has more triangles than the limit of %zu (desc->max_triangles)",
            d->max_triangles);
    bytes += d->extra_bytes * made;
    if (d->max_bytes && bytes > d->max_bytes) {
        char left[CWI_MEMORY_TEXT];
        cwi_print_memory(d->max_bytes, left);
        return cwi_fail(err, CW_ERR_LIMIT,
                        "extraction needs more than the %s that are left (desc->max_bytes)",
                        left);
    }
    return CW_OK;
}

static cw_status march_block(sparse_plan *p, cwi_leaf_block *b, worker *w, cw_error *err)
{
    cw_status st = look_at(b, w, err);
    if (st != CW_OK || !w->plan.counts.vertices)
        return st;
    b->vertices = w->plan.counts.vertices - w->stranger_count;
    b->triangles = w->plan.counts.triangles;
    if (p->predicting)
        return CW_OK;
    st = check_made(p, b, err);
    return st == CW_OK ? make_piece(p, b, w, err) : st;
}

/* --- joining ------------------------------------------------------------------------------ */

/* Finds the number in the mesh of another block's vertex. That block cuts the same edge, so it
 * was kept and has the key; only leaves that lie in each other are an exception. */
static bool find_stranger(const sparse_plan *p, const cwi_leaf_block *b, const cwi_stranger *s,
                          uint32_t *number)
{
    uint32_t at[3];
    for (int a = 0; a < 3; a++)
        at[a] = b->at[a] + (s->beyond >> a & 1);
    const cwi_leaf_block *owner = cwi_blocks_find(&p->blocks, at);
    size_t low = 0, high = owner ? owner->seam_count : 0;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (owner->seam[middle].key <= s->key)
            low = middle;
        else
            high = middle;
    }
    if (high == 0 || owner->seam[low].key != s->key)
        return false;
    *number = (uint32_t)owner->vertices + owner->seam[low].number;
    return true;
}

/* Copies a block's own vertices to the mesh, and finds the numbers of all its vertices
 * there. */
static bool place_vertices(const sparse_plan *p, const cwi_leaf_block *b, uint32_t *number)
{
    const cwi_block_mesh *piece = &b->piece;
    const cw_mesh *mesh = p->mesh;
    size_t from = 0, to = b->vertices;
    for (size_t n = 0; n <= piece->stranger_count; n++) {
        const bool last = n == piece->stranger_count;
        const size_t end = last ? piece->vertex_count : piece->strangers[n].vertex;
        const size_t bytes = (end - from) * 3 * sizeof(float);
        memcpy(mesh->positions + 3 * to, piece->positions + 3 * from, bytes);
        if (mesh->normals)
            memcpy(mesh->normals + 3 * to, piece->normals + 3 * from, bytes);
        while (from < end)
            number[from++] = (uint32_t)to++;
        if (!last && !find_stranger(p, b, &piece->strangers[n], &number[from++]))
            return false;
    }
    return true;
}

static cw_status join_block(sparse_plan *p, cwi_leaf_block *b, worker *w, cw_error *err)
{
    cwi_block_mesh *piece = &b->piece;
    if (!piece->memory)
        return CW_OK;
    if (piece->vertex_count > w->number_capacity) {
        cwi_free(w->number);
        w->number_capacity = 2 * piece->vertex_count;
        w->number = cwi_alloc_array(w->number_capacity, sizeof *w->number);
    }
    if (!w->number)
        return cwi_fail_memory(err);
    if (!place_vertices(p, b, w->number))
        return cwi_fail(err, CW_ERR_ARGUMENT, "leaves or tiles of the sparse grid overlap");
    uint32_t *to = p->mesh->triangles + 3 * b->triangles;
    for (size_t n = 0; n < 3 * piece->triangle_count; n++)
        to[n] = w->number[piece->triangles[n]];
    cwi_free(piece->memory);
    *piece = (cwi_block_mesh){0};
    return CW_OK;
}

/* --- all blocks --------------------------------------------------------------------------- */

/* Marks the cells that make triangles: those of the block itself, without the halo. */
static void set_live(cwi_bit_grid *g, size_t first)
{
    const uint64_t bits = ((UINT64_C(1) << cells[0]) - 1) << first;
    memset(g->live, 0, g->rows * sizeof *g->live);
    for (size_t k = first; k < first + (size_t)cells[2]; k++)
        for (size_t j = first; j < first + (size_t)cells[1]; j++)
            g->live[k * g->rows_y + j] = bits;
}

/* Sets the part of a block's planes that the extraction reads; it is the same for all
 * blocks. */
static cw_status set_window(cwi_bit_grid *g, size_t first, cw_error *err)
{
    uint64_t *window = cwi_alloc_array(4 * g->rows, sizeof *window);
    g->live = cwi_grid_plane(g);
    if (!g->live || !window) {
        cwi_free(window);
        return cwi_fail_memory(err);
    }
    set_live(g, first);
    cwi_find_window(g, window);
    g->window = window;
    return CW_OK;
}

/* Sets up a grid over the gathered samples. */
static cw_status init_grid(const sparse_plan *p, worker *w, cw_error *err)
{
    const cwi_gathering *from = &w->gathering;
    cwi_bit_grid *g = &w->plan.grid;
    cw_volume view = p->whole.volume;
    view.sparse = NULL;
    view.data = from->voxels;
    memcpy(view.dim, from->sample, sizeof view.dim);
    view.stride[0] = (ptrdiff_t)cw_type_size(view.type);
    view.stride[1] = view.stride[0] * CWI_PITCH;
    view.stride[2] = view.stride[1] * (ptrdiff_t)from->sample[1];
    w->plan.engine = p->engine;
    cw_status st = cwi_grid_init(g, &view, err);
    if (st == CW_OK)
        st = cwi_grid_set_level(g, p->desc, err);
    if (st != CW_OK)
        return st;
    g->all_classified = g->reads_whole_words = true;
    memset(g->inside, 0, g->rows * g->words * sizeof *g->inside);
    g->find_values = view.has_nodata;
    if (g->find_values && !(g->has = cwi_grid_plane(g)))
        return cwi_fail_memory(err);
    return set_window(g, from->halo + 1, err);
}

static cw_status init_worker(const sparse_plan *p, worker *w, cw_error *err)
{
    size_t capacity = 0; /* for edges in the sides: at most all of them */
    for (size_t n = 0; n < 3; n++)
        capacity += 6 * (size_t)(cells[n] + 1) * (size_t)(cells[(n + 1) % 3] + 1);
    w->seam = cwi_alloc_array(capacity, sizeof *w->seam);
    w->strangers = cwi_alloc_array(capacity, sizeof *w->strangers);
    if (!w->seam || !w->strangers)
        return cwi_fail_memory(err);
    cw_status st =
        cwi_gathering_init(&w->gathering, &p->blocks, p->engine, p->desc->cubic_placement, err);
    return st == CW_OK ? init_grid(p, w, err) : st;
}

static void free_worker(worker *w)
{
    cwi_plan_free(&w->plan);
    cwi_gathering_free(&w->gathering);
    cwi_free(w->seam);
    cwi_free(w->strangers);
    cwi_free(w->number);
}

static void free_sparse(sparse_plan *p)
{
    for (int n = 0; p->workers && n < p->threads; n++)
        free_worker(&p->workers[n]);
    cwi_free(p->workers);
    cwi_blocks_free(&p->blocks);
}

static cw_status init_workers(sparse_plan *p, cw_error *err)
{
    p->threads = cwi_threads(p->desc->threads);
    p->workers = cwi_alloc_zeroed((size_t)p->threads, sizeof *p->workers);
    if (!p->workers)
        return cwi_fail_memory(err);
    cw_status st = CW_OK;
    for (int n = 0; n < p->threads && st == CW_OK; n++)
        st = init_worker(p, &p->workers[n], err);
    return st;
}

enum { BLOCK = CWI_BLOCK_X * CWI_BLOCK_Y * CWI_BLOCK_Z * CWI_LEAF_VOXELS };

typedef struct turn {
    sparse_plan *plan;
    cw_status (*work)(sparse_plan *p, cwi_leaf_block *b, worker *w, cw_error *err);
} turn;

/* Processes a block, unless the thread failed before. */
static void do_block(void *context, size_t n)
{
    const turn *t = context;
    worker *w = &t->plan->workers[cwi_thread_number()];
    if (w->status == CW_OK)
        w->status = t->work(t->plan, &t->plan->blocks.block[n], w, &w->error);
}

static cw_status each_block(sparse_plan *p, const char *step,
                            cw_status (*work)(sparse_plan *, cwi_leaf_block *, worker *,
                                              cw_error *),
                            cw_error *err)
{
    turn t = {p, work};
    cw_status st = cwi_parallel_for(p->blocks.count, BLOCK, p->desc->threads,
                                    &p->desc->progress, step, do_block, &t, err);
    for (int n = 0; n < p->threads && st == CW_OK; n++)
        if (p->workers[n].status != CW_OK) {
            st = p->workers[n].status;
            cwi_fail(err, st, "%s", p->workers[n].error.message);
        }
    return st;
}

/* Turns counts into first numbers. */
static cw_status number_blocks(sparse_plan *p, cw_extract_counts *c, cw_error *err)
{
    size_t v = 0, t = 0, seam = 0;
    for (size_t n = 0; n < p->blocks.count; n++) {
        cwi_leaf_block *b = &p->blocks.block[n];
        const size_t vertices = b->vertices, triangles = b->triangles;
        b->vertices = v;
        b->triangles = t;
        v += vertices;
        t += triangles;
        seam += b->seam_count;
    }
    *c = (cw_extract_counts){.vertices = v, .triangles = t};
    c->bytes = 2 * cwi_extract_mesh_bytes(c, !p->desc->no_normals) + seam * sizeof(cwi_seam) +
               p->blocks.capacity * sizeof *p->blocks.block; /* as pieces, and joined */
    if (v > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the surface has %zu vertices; a mesh holds %u", v,
                        UINT32_MAX);
    return cwi_extract_check_limits(p->desc, c, err);
}

static cw_status join_blocks(sparse_plan *p, const cw_extract_counts *c, cw_mesh *mesh,
                             cw_error *err)
{
    const cw_volume *v = &p->whole.volume;
    bool missing = false;
    double origin[3];
    memcpy(origin, mesh->origin, sizeof origin);
    cw_status st = cwi_mesh_alloc(mesh, c->vertices, c->triangles, !p->desc->no_normals, err);
    if (st != CW_OK)
        return st;
    p->mesh = mesh;
    memcpy(mesh->origin, origin, sizeof origin);
    memcpy(mesh->affine, v->affine, sizeof mesh->affine);
    st = each_block(p, "joining", join_block, err);
    for (int n = 0; n < p->threads; n++)
        missing = missing || p->workers[n].missing;
    return st == CW_OK && missing ? cwi_repair_normals(mesh, cwi_voxel_scale(v), err) : st;
}

/* Makes the pieces of all blocks, without joining them. */
static cw_status march_blocks(sparse_plan *p, cw_mesh *mesh, cw_error *err)
{
    const cw_volume *v = &p->whole.volume;
    cw_status st = p->desc->snap == 0 ? cwi_extract_check_range(v, err)
                                      : cwi_volume_expect_even(v, "snap", err);
    if (st == CW_OK)
        st = cwi_grid_set_level(&p->whole, p->desc, err);
    if (st == CW_OK)
        st = cwi_blocks_init(&p->blocks, p->engine, &p->whole, p->desc, err);
    if (st == CW_OK)
        st = init_workers(p, err);
    if (st != CW_OK)
        return st;
    p->predicting = !mesh;
    p->sink = cwi_make_sink(v, p->whole.invert, mesh ? mesh : &(cw_mesh){0});
    p->emission = cwi_make_emission(v, p->desc->simple_topology);
    return each_block(p, "marching", march_block, err);
}

cw_status cwi_extract_sparse(const cwi_engine *engine, const cw_volume *volume,
                             const cw_extract_desc *desc, cw_mesh *mesh,
                             cw_extract_counts *counts, cw_error *err)
{
    sparse_plan p = {.engine = engine, .desc = desc, .whole = {.volume = *volume}};
    cw_status st = march_blocks(&p, mesh, err);
    if (st == CW_OK)
        st = number_blocks(&p, counts, err);
    if (st == CW_OK && mesh && counts->triangles)
        st = join_blocks(&p, counts, mesh, err);
    free_sparse(&p);
    return st;
}
