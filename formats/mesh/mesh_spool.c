/* Spools: appends chunks of a surface to temporary files, and reads them back in pieces. */
#include "formats/mesh/mesh_spool.h"

#include <cubewright/formats.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/unnamed_file.h"
#include "core/geometry/box.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* Elements of a piece. */
enum { PIECE = CWI_SPOOL_PIECE };

/* --- writing -------------------------------------------------------------------------------- */

cw_status cw_mesh_spool_new(const char *path, cw_mesh_spool **out, cw_error *err)
{
    CWI_REQUIRE(err, path, out);
    cw_mesh_spool *s = *out = cwi_alloc_zeroed(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    cw_status st = CW_OK;
    s->segments = &s->mine;
    s->segment_count = 1;
    s->folder = cwi_folder_of(path);
    for (int n = 0; n < CWI_SPOOL_FILES; n++)
        s->mine.files[n] = -1;
    if (!s->folder)
        st = cwi_fail_memory(err);
    for (int n = 0; n < CWI_SPOOL_FILES && st == CW_OK; n++)
        st = cwi_unnamed_open(s->folder, &s->mine.files[n], err);
    cwi_box_clear(s->low, s->high);
    if (st != CW_OK) {
        cw_mesh_spool_free(s);
        *out = NULL;
    }
    return st;
}

void cw_mesh_spool_free(cw_mesh_spool *s)
{
    if (!s)
        return;
    for (size_t k = 0; k < s->segment_count; k++)
        for (int n = 0; n < CWI_SPOOL_FILES; n++)
            if (s->segments[k].files[n] >= 0)
                close(s->segments[k].files[n]);
    if (s->segments != &s->mine)
        cwi_free(s->segments);
    cwi_free(s->folder);
    cwi_free(s);
}

cw_status cwi_write_elements(const char *folder, int file, size_t first, const void *from,
                             size_t count, cw_error *err)
{
    return cwi_unnamed_write(folder, file, first * CWI_SPOOL_ELEMENT, from,
                             count * CWI_SPOOL_ELEMENT, err);
}

static cw_status take_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    cw_mesh_spool *s = user;
    cw_mesh *all = &s->frame;
    const cw_mesh *m = &chunk->mesh;
    const bool is_first = !all->vertex_count && !all->triangle_count;
    if (s->team)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a chunk for a surface that a team shares");
    if (chunk->first_vertex != all->vertex_count ||
        chunk->first_triangle != all->triangle_count ||
        (!is_first && m->vertex_count && all->vertex_count &&
         s->has_normals != (m->normals != NULL)))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a chunk from vertex %zu and triangle %zu on, where %zu and %zu follow",
                        chunk->first_vertex, chunk->first_triangle, all->vertex_count,
                        all->triangle_count);
    if (m->vertex_count)
        s->has_normals = m->normals != NULL;
    memcpy(all->origin, m->origin, sizeof all->origin);
    memcpy(all->affine, m->affine, sizeof all->affine);
    cwi_box_add_points(s->low, s->high, m->positions, m->vertex_count);
    cw_status st = cwi_write_elements(s->folder, s->mine.files[CWI_SPOOL_POSITIONS],
                                      all->vertex_count, m->positions, m->vertex_count, err);
    if (st == CW_OK && m->normals)
        st = cwi_write_elements(s->folder, s->mine.files[CWI_SPOOL_NORMALS], all->vertex_count,
                                m->normals, m->vertex_count, err);
    if (st == CW_OK)
        st = cwi_write_elements(s->folder, s->mine.files[CWI_SPOOL_TRIANGLES],
                                all->triangle_count, m->triangles, m->triangle_count, err);
    s->mine.vertices = all->vertex_count += m->vertex_count;
    s->mine.triangles = all->triangle_count += m->triangle_count;
    return st;
}

cw_chunk_sink cw_mesh_spool_sink(cw_mesh_spool *spool)
{
    return (cw_chunk_sink){.take = take_chunk, .user = spool};
}

const cw_mesh *cw_mesh_spool_frame(const cw_mesh_spool *spool)
{
    if (!spool)
        return NULL;
    return &spool->frame;
}

bool cw_mesh_spool_bounds(const cw_mesh_spool *s, double min[3], double max[3])
{
    if (!s || !min || !max)
        return false;
    const bool any = s->frame.vertex_count > 0;
    for (int a = 0; a < 3; a++) {
        min[a] = any ? s->frame.origin[a] + s->low[a] : 0;
        max[a] = any ? s->frame.origin[a] + s->high[a] : 0;
    }
    return any;
}

void cwi_spool_range(const cw_mesh_spool *s, double low[3], double high[3])
{
    memcpy(low, s->low, sizeof s->low);
    memcpy(high, s->high, sizeof s->high);
}

const char *cwi_spool_folder(const cw_mesh_spool *s)
{
    return s->folder;
}

unsigned cwi_spool_arrays(const cw_mesh_spool *s)
{
    unsigned has = s->has_normals ? CW_KEEPS_NORMALS : 0u;
    for (int i = 0; i < 12; i++)
        has |= s->frame.affine[i / 4][i % 4] != 0 ? CW_KEEPS_AFFINE : 0u;
    return has;
}

/* --- reading -------------------------------------------------------------------------------- */

cw_status cwi_read_elements(int file, size_t first, size_t count, void *to, cw_error *err)
{
    return cwi_unnamed_read(file, first * CWI_SPOOL_ELEMENT, to, count * CWI_SPOOL_ELEMENT,
                            err);
}

cw_status cwi_spool_read(const cw_mesh_spool *s, int array, size_t first, size_t count,
                         void *to, cw_error *err)
{
    const bool triangles = array == CWI_SPOOL_TRIANGLES;
    cw_status st = CW_OK;
    for (size_t k = 0; k < s->segment_count && count && st == CW_OK; k++) {
        const cwi_spool_segment *g = s->segments + k;
        const size_t begin = triangles ? g->first_triangle : g->first_vertex,
                     end = begin + (triangles ? g->triangles : g->vertices);
        if (first >= end)
            continue;
        const size_t here = end - first < count ? end - first : count;
        st = cwi_read_elements(g->files[array], first - begin, here, to, err);
        for (size_t n = 0; triangles && g->first_vertex && n < 3 * here; n++)
            ((uint32_t *)to)[n] += (uint32_t)g->first_vertex;
        to = (char *)to + here * CWI_SPOOL_ELEMENT;
        first += here;
        count -= here;
    }
    return st;
}

/* Positions of vertices that triangles name. They are near each other: in a few rows of two
 * layers. */
enum { BLOCK = 1024, BLOCKS = 512 };

struct cwi_block_cache {
    size_t block[BLOCKS]; /* number of the block that is held, plus 1; 0: none */
    float positions[BLOCKS][3 * BLOCK];
};

static cw_status fetch_position(cwi_spool_reader *r, size_t vertex, float to[3], cw_error *err)
{
    const size_t block = vertex / BLOCK, slot = block % BLOCKS;
    struct cwi_block_cache *c = r->cache;
    if (c->block[slot] != block + 1) {
        const size_t first = block * BLOCK, left = r->spool->frame.vertex_count - first;
        c->block[slot] = 0;
        cw_status st = cwi_spool_read(r->spool, CWI_SPOOL_POSITIONS, first,
                                      left < BLOCK ? left : BLOCK, c->positions[slot], err);
        if (st != CW_OK)
            return st;
        c->block[slot] = block + 1;
    }
    memcpy(to, c->positions[slot] + 3 * (vertex % BLOCK), 3 * sizeof *to);
    return CW_OK;
}

/* Gives each corner of a piece a vertex of its own. */
static cw_status fetch_corners(cwi_spool_reader *r, cw_error *err)
{
    cw_mesh *m = &r->mesh;
    cw_status st = CW_OK;
    for (size_t n = 0; n < 3 * r->count && st == CW_OK; n++) {
        st = fetch_position(r, m->triangles[n], m->positions + 3 * n, err);
        m->triangles[n] = (uint32_t)n;
    }
    m->vertex_count = 3 * r->count;
    return st;
}

cw_status cwi_spool_open(cwi_spool_reader *r, const cw_mesh_spool *spool, cwi_elements elements,
                         cw_error *err)
{
    const bool vertices = elements == CWI_VERTICES, facets = elements == CWI_FACETS;
    *r = (cwi_spool_reader){.spool = spool, .elements = elements, .mesh = spool->frame};
    cw_mesh *m = &r->mesh;
    r->end = vertices ? m->vertex_count : m->triangle_count;
    if (vertices || facets)
        m->positions = cwi_alloc_array((size_t)(facets ? 3 : 1) * PIECE, CWI_SPOOL_ELEMENT);
    if (vertices && spool->has_normals)
        m->normals = cwi_alloc_array(PIECE, CWI_SPOOL_ELEMENT);
    if (!vertices)
        m->triangles = cwi_alloc_array(PIECE, CWI_SPOOL_ELEMENT);
    if (facets)
        r->cache = cwi_alloc_zeroed(1, sizeof *r->cache);
    const bool ok = (m->positions || !(vertices || facets)) && (m->triangles || vertices) &&
                    (m->normals || !(vertices && spool->has_normals)) && (r->cache || !facets);
    return ok ? CW_OK : cwi_fail_memory(err);
}

void cwi_spool_read_own(cwi_spool_reader *r)
{
    const cwi_spool_segment *g = r->spool->segments + r->spool->own;
    const bool vertices = r->elements == CWI_VERTICES;
    r->first = vertices ? g->first_vertex : g->first_triangle;
    r->end = r->first + (vertices ? g->vertices : g->triangles);
}

/* Fails for a triangle that names a vertex that is not there. */
static cw_status check_corners(const cwi_spool_reader *r, cw_error *err)
{
    const size_t vertices = r->spool->frame.vertex_count;
    for (size_t n = 0; n < 3 * r->count && !r->is_part; n++)
        if (r->mesh.triangles[n] >= vertices)
            return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %u of %zu",
                            r->first + n / 3, r->mesh.triangles[n], vertices);
    return CW_OK;
}

cw_status cwi_spool_next(cwi_spool_reader *r, cw_error *err)
{
    const cw_mesh_spool *s = r->spool;
    cw_mesh *m = &r->mesh;
    r->first += r->count;
    r->count = r->end - r->first < PIECE ? r->end - r->first : PIECE;
    if (r->elements != CWI_VERTICES) {
        cw_status st =
            cwi_spool_read(s, CWI_SPOOL_TRIANGLES, r->first, r->count, m->triangles, err);
        if (st == CW_OK)
            st = check_corners(r, err);
        return st == CW_OK && r->elements == CWI_FACETS ? fetch_corners(r, err) : st;
    }
    cw_status st =
        cwi_spool_read(s, CWI_SPOOL_POSITIONS, r->first, r->count, m->positions, err);
    return st == CW_OK && m->normals
               ? cwi_spool_read(s, CWI_SPOOL_NORMALS, r->first, r->count, m->normals, err)
               : st;
}

void cwi_spool_close(cwi_spool_reader *r)
{
    cwi_free(r->mesh.positions);
    cwi_free(r->mesh.normals);
    cwi_free(r->mesh.triangles);
    cwi_free(r->cache);
    *r = (cwi_spool_reader){0};
}
