/* Leaves the components out of a spool that enclose too little. Three passes find the lowest
 * vertices that are still named, link vertices to later ones of their component, and give away
 * what is kept. In between, the links are followed from the last vertex to the first. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/base/unnamed_file.h"
#include "core/mesh/component_front.h"
#include "formats/mesh/mesh_spool.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* Elements of a piece, as in spools. */
enum { PIECE = CWI_SPOOL_PIECE, LINK_BYTES = sizeof(uint32_t) };

enum { PASSES = 4 };

typedef struct volume_pass {
    const cw_mesh_spool *spool;
    cw_spool_drop_desc desc;
    cw_chunk_sink kept;
    size_t vertices, triangles;
    size_t pieces;    /* of triangles */
    uint32_t *lowest; /* pieces + 1: the lowest vertex that a piece or a later one names */
    size_t span;      /* the most vertices between the lowest one and the highest one so far */
    int file;         /* links, then verdicts: 1 for vertices that are kept */
    cwi_component_front front;
    cw_drop_counts counts;
} volume_pass;

static cw_status report_pass(const volume_pass *p, int pass, size_t done, size_t all,
                             cw_error *err)
{
    const double part = all ? (double)done / (double)all : 1;
    return cwi_progress(&p->desc.progress, "components", (pass + part) / PASSES, err);
}

static cw_status check_bytes(const volume_pass *p, size_t bytes, cw_error *err)
{
    char needed[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
    if (!p->desc.max_bytes || bytes <= p->desc.max_bytes)
        return CW_OK;
    cwi_print_memory(bytes, needed);
    cwi_print_memory(p->desc.max_bytes, limit);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "the numbers of the surface's front need %s; the limit is %s", needed,
                    limit);
}

/* Returns the smallest power of two above a number. */
static size_t round_up(size_t number)
{
    size_t power = 1;
    while (power <= number)
        power *= 2;
    return power;
}

/* --- first pass: the front's ends ----------------------------------------------------------- */

static void scan_piece(const cwi_spool_reader *r, uint32_t *lowest, uint32_t *highest)
{
    uint32_t low = UINT32_MAX, high = *highest;
    const uint32_t *corners = r->mesh.triangles;
    for (size_t n = 0; n < 3 * r->count; n++) {
        low = corners[n] < low ? corners[n] : low;
        high = corners[n] > high ? corners[n] : high;
    }
    *lowest = low;
    *highest = high;
}

/* Finds the lowest and the highest vertices of pieces. */
static cw_status find_ends(volume_pass *p, uint32_t *highest, cw_error *err)
{
    cwi_spool_reader r;
    uint32_t high = 0;
    cw_status st = cwi_spool_open(&r, p->spool, CWI_TRIANGLES, err);
    for (size_t n = 0; n < p->pieces && st == CW_OK; n++) {
        st = cwi_spool_next(&r, err);
        if (st == CW_OK)
            scan_piece(&r, &p->lowest[n], &high);
        if (st == CW_OK)
            st = report_pass(p, 0, n, p->pieces, err);
        highest[n] = high;
    }
    cwi_spool_close(&r);
    return st;
}

static cw_status find_front(volume_pass *p, cw_error *err)
{
    uint32_t *highest = cwi_alloc_array(p->pieces, sizeof *highest);
    p->lowest = cwi_alloc_array(p->pieces + 1, sizeof *p->lowest);
    cw_status st = highest && p->lowest ? find_ends(p, highest, err) : cwi_fail_memory(err);
    for (size_t n = p->pieces; n-- > 0 && st == CW_OK;) {
        if (n + 1 < p->pieces && p->lowest[n + 1] < p->lowest[n])
            p->lowest[n] = p->lowest[n + 1];
        const size_t span = (size_t)highest[n] + 1 - p->lowest[n];
        p->span = span > p->span ? span : p->span;
    }
    if (st == CW_OK)
        p->lowest[p->pieces] = (uint32_t)p->vertices;
    cwi_free(highest);
    return st;
}

/* --- second pass: links --------------------------------------------------------------------- */

/* Writes the links of vertices that no later triangle names. */
static cw_status write_links(volume_pass *p, size_t final, cw_error *err)
{
    cwi_component_front *f = &p->front;
    if (final <= f->begin)
        return CW_OK;
    cwi_front_settle(f, final);
    cw_status st = cwi_unnamed_write(cwi_spool_folder(p->spool), p->file, f->begin * LINK_BYTES,
                                     f->sets, (final - f->begin) * LINK_BYTES, err);
    cwi_front_drop(f, final);
    return st;
}

/* Appends vertices to the front up to the one before `end`. */
static cw_status extend_front(volume_pass *p, cwi_spool_reader *r, size_t end, size_t final,
                              cw_error *err)
{
    cwi_component_front *f = &p->front;
    cw_status st = CW_OK;
    while (f->end < end && st == CW_OK) {
        st = cwi_spool_next(r, err);
        if (st == CW_OK && cwi_front_is_full(f, r->count)) {
            st = write_links(p, final < f->end ? final : f->end, err);
            if (st == CW_OK)
                st = cwi_front_reserve(f, r->count, err);
        }
        if (st == CW_OK)
            st = cwi_front_append(f, r->mesh.positions, r->count, err);
    }
    return st;
}

static cw_status join_piece(volume_pass *p, const cwi_spool_reader *r, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t t = 0; t < r->count && st == CW_OK; t++)
        st = cwi_front_join(&p->front, r->mesh.triangles + 3 * t, err);
    return st;
}

static size_t find_end(const cwi_spool_reader *r)
{
    uint32_t high = 0;
    for (size_t n = 0; n < 3 * r->count; n++)
        high = r->mesh.triangles[n] > high ? r->mesh.triangles[n] : high;
    return (size_t)high + 1;
}

static cw_status link_vertices(volume_pass *p, cw_error *err)
{
    cwi_spool_reader vertices = {0}, triangles = {0};
    cw_status st = cwi_spool_open(&vertices, p->spool, CWI_VERTICES, err);
    if (st == CW_OK)
        st = cwi_spool_open(&triangles, p->spool, CWI_TRIANGLES, err);
    for (size_t n = 0; n < p->pieces && st == CW_OK; n++) {
        st = cwi_spool_next(&triangles, err);
        if (st == CW_OK)
            st = extend_front(p, &vertices, find_end(&triangles), p->lowest[n], err);
        if (st == CW_OK)
            st = join_piece(p, &triangles, err);
        if (st == CW_OK)
            st = report_pass(p, 1, n, p->pieces, err);
    }
    if (st == CW_OK) /* vertices that no triangle names */
        st = extend_front(p, &vertices, p->vertices, p->vertices, err);
    if (st == CW_OK)
        st = write_links(p, p->vertices, err);
    cwi_spool_close(&vertices);
    cwi_spool_close(&triangles);
    p->counts = p->front.counts;
    p->counts.dropped_mm3 = cwi_volume_mm3(&p->front.unit, p->front.dropped);
    cwi_front_free(&p->front);
    return st;
}

/* --- backward: verdicts --------------------------------------------------------------------- */

/* Replaces links by verdicts. Later verdicts are in a ring that the longest link fits into. */
static void follow_links(uint32_t *links, size_t first, size_t count, uint8_t *ring,
                         size_t mask)
{
    for (size_t n = count; n-- > 0;) {
        const size_t v = first + n;
        const uint32_t link = links[n];
        const uint8_t verdict =
            link == CWI_LINK_KEPT || (link != CWI_LINK_DROPPED && ring[(v + link) & mask]);
        ring[v & mask] = verdict;
        links[n] = verdict;
    }
}

static cw_status judge_vertices(volume_pass *p, cw_error *err)
{
    const size_t size = round_up(p->front.farthest);
    cw_status st = check_bytes(p, size, err);
    if (st != CW_OK)
        return st;
    uint8_t *ring = cwi_alloc_zeroed(size, 1);
    uint32_t *links = cwi_alloc_array(PIECE, LINK_BYTES);
    if (!ring || !links)
        st = cwi_fail_memory(err);
    for (size_t end = p->vertices, count; end && st == CW_OK; end -= count) {
        count = (end - 1) % PIECE + 1;
        const size_t at = (end - count) * LINK_BYTES;
        st = cwi_unnamed_read(p->file, at, links, count * LINK_BYTES, err);
        if (st != CW_OK)
            break;
        follow_links(links, end - count, count, ring, size - 1);
        st = cwi_unnamed_write(cwi_spool_folder(p->spool), p->file, at, links,
                               count * LINK_BYTES, err);
        if (st == CW_OK)
            st = report_pass(p, 2, p->vertices - end, p->vertices, err);
    }
    cwi_free(ring);
    cwi_free(links);
    return st;
}

/* --- last pass: the surface that is kept ------------------------------------------------------ */

/* A vertex that is not kept. */
#define NO_NUMBER UINT32_MAX

/* Copying of what is kept. */
typedef struct copying {
    cwi_spool_reader vertices, triangles;
    size_t next;       /* the first vertex that was not given away */
    uint32_t *numbers; /* ring of new numbers, from `next` on */
    size_t mask;
    size_t numbered;    /* vertices that were numbered */
    uint32_t count;     /* of them those that are kept */
    uint32_t *verdicts; /* PIECE of them */
    cw_mesh_chunk chunk;
} copying;

/* Numbers vertices by their verdicts, up to the one before `end`. */
static cw_status number_vertices(const volume_pass *p, copying *c, size_t end, cw_error *err)
{
    while (c->numbered < end) {
        const size_t left = p->vertices - c->numbered, count = left < PIECE ? left : PIECE;
        cw_status st = cwi_unnamed_read(p->file, c->numbered * LINK_BYTES, c->verdicts,
                                        count * LINK_BYTES, err);
        if (st != CW_OK)
            return st;
        for (size_t n = 0; n < count; n++)
            c->numbers[(c->numbered + n) & c->mask] = c->verdicts[n] ? c->count++ : NO_NUMBER;
        c->numbered += count;
    }
    return CW_OK;
}

/* Moves the kept vertices up to `end` into the chunk, but those of one piece alone. */
static cw_status gather_vertices(const volume_pass *p, copying *c, size_t end, cw_error *err)
{
    cwi_spool_reader *r = &c->vertices;
    cw_mesh *m = &c->chunk.mesh;
    m->vertex_count = 0;
    if (c->next == end)
        return CW_OK;
    if (c->next == r->first + r->count) {
        cw_status st = cwi_spool_next(r, err);
        if (st != CW_OK)
            return st;
    }
    const size_t last = r->first + r->count < end ? r->first + r->count : end;
    cw_status st = number_vertices(p, c, last, err);
    for (; c->next < last && st == CW_OK; c->next++) {
        const size_t from = 3 * (c->next - r->first), to = 3 * m->vertex_count;
        if (c->numbers[c->next & c->mask] == NO_NUMBER)
            continue;
        memcpy(m->positions + to, r->mesh.positions + from, 3 * sizeof *m->positions);
        if (m->normals)
            memcpy(m->normals + to, r->mesh.normals + from, 3 * sizeof *m->normals);
        m->vertex_count++;
    }
    return st;
}

/* Moves the kept triangles of a piece into the chunk, with new numbers. */
static void gather_triangles(volume_pass *p, copying *c)
{
    cw_mesh *m = &c->chunk.mesh;
    const uint32_t *from = c->triangles.mesh.triangles;
    m->triangle_count = 0;
    for (size_t t = 0; t < c->triangles.count; t++, from += 3) {
        if (c->numbers[from[0] & c->mask] == NO_NUMBER)
            continue;
        for (size_t n = 0; n < 3; n++)
            m->triangles[3 * m->triangle_count + n] = c->numbers[from[n] & c->mask];
        m->triangle_count++;
    }
    p->counts.triangles += c->triangles.count - m->triangle_count;
}

static cw_status send_chunk(const volume_pass *p, copying *c, cw_error *err)
{
    cw_mesh_chunk *chunk = &c->chunk;
    if (!chunk->mesh.vertex_count && !chunk->mesh.triangle_count)
        return CW_OK;
    cw_status st = p->kept.take(p->kept.user, chunk, err);
    chunk->first_vertex += chunk->mesh.vertex_count;
    chunk->first_triangle += chunk->mesh.triangle_count;
    chunk->mesh.triangle_count = 0;
    return st;
}

/* Gives away the triangles of the chunk, and the vertices up to the one before `end`. */
static cw_status give_vertices(const volume_pass *p, copying *c, size_t end, cw_error *err)
{
    cw_status st;
    do {
        st = gather_vertices(p, c, end, err);
        if (st == CW_OK)
            st = send_chunk(p, c, err);
    } while (st == CW_OK && c->next < end);
    return st;
}

/* Gives away a piece of triangles, and the vertices that no later triangle names. */
static cw_status copy_piece(volume_pass *p, copying *c, size_t final, cw_error *err)
{
    cw_status st = cwi_spool_next(&c->triangles, err);
    if (st == CW_OK)
        st = number_vertices(p, c, find_end(&c->triangles), err);
    if (st != CW_OK)
        return st;
    gather_triangles(p, c);
    return give_vertices(p, c, final, err);
}

static cw_status begin_copying(const volume_pass *p, copying *c, cw_error *err)
{
    const size_t size = round_up(p->span + PIECE); /* numbers come in pieces */
    cw_mesh *m = &c->chunk.mesh;
    *m = *cw_mesh_spool_frame(p->spool);
    m->triangle_count = 0;
    cw_status st = check_bytes(p, size * sizeof *c->numbers, err);
    if (st == CW_OK)
        st = cwi_spool_open(&c->vertices, p->spool, CWI_VERTICES, err);
    if (st == CW_OK)
        st = cwi_spool_open(&c->triangles, p->spool, CWI_TRIANGLES, err);
    if (st != CW_OK)
        return st;
    c->mask = size - 1;
    c->numbers = cwi_alloc_array(size, sizeof *c->numbers);
    c->verdicts = cwi_alloc_array(PIECE, LINK_BYTES);
    m->positions = cwi_alloc_array(PIECE, 3 * sizeof *m->positions);
    m->normals =
        c->vertices.mesh.normals ? cwi_alloc_array(PIECE, 3 * sizeof *m->normals) : NULL;
    m->triangles = cwi_alloc_array(PIECE, 3 * sizeof *m->triangles);
    return c->numbers && c->verdicts && m->positions && m->triangles &&
                   (m->normals || !c->vertices.mesh.normals)
               ? CW_OK
               : cwi_fail_memory(err);
}

static cw_status copy_kept(volume_pass *p, cw_error *err)
{
    copying c = {0};
    cw_status st = begin_copying(p, &c, err);
    if (st == CW_OK) /* none of these is kept */
        st = give_vertices(p, &c, p->lowest[0], err);
    for (size_t n = 0; n < p->pieces && st == CW_OK; n++) {
        st = copy_piece(p, &c, p->lowest[n + 1], err);
        if (st == CW_OK)
            st = report_pass(p, 3, n, p->pieces, err);
    }
    cwi_spool_close(&c.vertices);
    cwi_spool_close(&c.triangles);
    cwi_free(c.numbers);
    cwi_free(c.verdicts);
    cwi_free(c.chunk.mesh.positions);
    cwi_free(c.chunk.mesh.normals);
    cwi_free(c.chunk.mesh.triangles);
    return st;
}

/* --- public --------------------------------------------------------------------------------- */

static float find_largest(const cw_mesh_spool *spool)
{
    double low[3], high[3], largest = 0;
    cwi_spool_range(spool, low, high);
    for (int a = 0; a < 3 && cw_mesh_spool_frame(spool)->vertex_count; a++) {
        largest = fmax(largest, fabs(low[a]));
        largest = fmax(largest, fabs(high[a]));
    }
    return (float)largest;
}

cw_status cw_mesh_spool_drop_volumes(const cw_mesh_spool *spool, const cw_spool_drop_desc *desc,
                                     cw_chunk_sink kept, cw_drop_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, spool);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    volume_pass p = {.spool = spool,
                     .desc = desc ? *desc : (cw_spool_drop_desc){0},
                     .kept = kept,
                     .vertices = frame->vertex_count,
                     .triangles = frame->triangle_count,
                     .pieces = (frame->triangle_count + CWI_SPOOL_PIECE - 1) / CWI_SPOOL_PIECE,
                     .file = -1};
    cw_status st = CW_OK;
    if (!(p.desc.least_mm3 >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "least_mm3 is %g; it must be 0 or more",
                      p.desc.least_mm3);
    if (st == CW_OK)
        st = cwi_unnamed_open(cwi_spool_folder(spool), &p.file, err);
    if (st == CW_OK)
        st = find_front(&p, err);
    p.front = (cwi_component_front){.least_mm3 = p.desc.least_mm3,
                                    .max_bytes = p.desc.max_bytes,
                                    .unit = cwi_volume_unit_for(find_largest(spool))};
    if (st == CW_OK)
        st = link_vertices(&p, err);
    if (st == CW_OK)
        st = judge_vertices(&p, err);
    if (st == CW_OK)
        st = copy_kept(&p, err);
    if (counts)
        *counts = st == CW_OK ? p.counts : (cw_drop_counts){0};
    cwi_free(p.lowest);
    if (p.file >= 0)
        close(p.file);
    return st;
}
