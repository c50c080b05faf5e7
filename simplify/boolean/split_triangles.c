/* Splits all triangles that have seams: a chunk of them at a time, in any order, with the same result. */
#include "simplify/boolean/planar_split.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"

#include <stdlib.h>

enum { CHUNK = 64 }; /* triangles with seams */

/* The parts of a chunk of triangles. Points that were found there are numbered from the sign bit. */
typedef struct chunk {
    size_t part_count, part_capacity, point_count, point_capacity;
    cwi_triangle_part *parts;
    cwi_exact_point *points;
    bool failed, is_lost; /* no memory; a line could not be added */
} chunk;

#define NEW_POINT (UINT32_C(1) << 31)

/* The triangle of seams first[n] to first[n + 1]. */
typedef struct splitting {
    const cwi_soup *s;
    const cwi_seams *seams;
    size_t *first, count;
    chunk *chunks;
    size_t chunk_count;
} splitting;

static bool keep_point(chunk *to, const cwi_exact_point *p)
{
    cwi_exact_point *points =
        cwi_grow_array(to->points, to->point_count, &to->point_capacity, sizeof *points);
    if (!points)
        return false;
    to->points = points;
    to->points[to->point_count++] = *p;
    return true;
}

static bool keep_parts(chunk *to, cwi_split *split)
{
    if (to->part_capacity - to->part_count < split->face_count) {
        const size_t capacity = 2 * (to->part_count + split->face_count);
        cwi_triangle_part *parts = cwi_realloc_array(to->parts, capacity, sizeof *parts);
        if (!parts)
            return false;
        to->parts = parts;
        to->part_capacity = capacity;
    }
    for (size_t n = 0; n < split->point_count; n++)
        if (split->numbers[n] == CWI_NOTHING) {
            split->numbers[n] = NEW_POINT | (uint32_t)to->point_count;
            if (!keep_point(to, &split->points[n]))
                return false;
        }
    for (size_t f = 0; f < split->face_count; f++) {
        const cwi_split_face *face = &split->faces[f];
        cwi_triangle_part *part = &to->parts[to->part_count++];
        *part = (cwi_triangle_part){.source = split->triangle};
        for (int k = 0; k < 3; k++) {
            part->corners[k] = split->numbers[face->corners[k]];
            part->seams |= (uint8_t)((face->line[k] != CWI_NOTHING) << k);
        }
    }
    return true;
}

static const cwi_exact_point *find_point(const splitting *s, uint32_t number,
                                         cwi_exact_point *vertex)
{
    if (number >= s->s->vertex_count)
        return &s->seams->points[number - s->s->vertex_count];
    *vertex = cwi_point_vertex(s->s, number);
    return vertex;
}

/* Points before lines: a line then finds all points that it passes. */
static bool add_seams(const splitting *s, size_t n, cwi_split *split, uint32_t *ends)
{
    const cwi_triangle_seam *seams = s->seams->seams + s->first[n];
    const size_t count = s->first[n + 1] - s->first[n];
    cwi_exact_point vertex;
    for (size_t i = 0; i < 2 * count; i++) {
        const uint32_t number = i % 2 ? seams[i / 2].q : seams[i / 2].p;
        if (i % 2 && seams[i / 2].p == number)
            ends[i] = ends[i - 1];
        else if (!cwi_split_add_point(split, find_point(s, number, &vertex), number, &ends[i]))
            return false;
    }
    for (size_t i = 0; i < count; i++)
        if (!cwi_split_add_line(split, ends[2 * i], ends[2 * i + 1],
                                (cwi_split_line){{seams[i].on[0], seams[i].on[1]}}))
            return false;
    return true;
}

static void split_chunk(void *context, size_t k)
{
    const splitting *s = context;
    chunk *to = &s->chunks[k];
    cwi_split split = {0};
    size_t longest = 0;
    const size_t end = (k + 1) * CHUNK < s->count ? (k + 1) * CHUNK : s->count;
    for (size_t n = k * CHUNK; n < end; n++)
        longest =
            s->first[n + 1] - s->first[n] > longest ? s->first[n + 1] - s->first[n] : longest;
    uint32_t *ends = cwi_alloc_array(2 * longest, sizeof *ends);
    to->failed = !ends;
    for (size_t n = k * CHUNK; n < end && !to->failed && !to->is_lost; n++) {
        const bool done =
            cwi_split_begin(&split, s->s, s->seams->seams[s->first[n]].triangle) &&
            add_seams(s, n, &split, ends);
        to->failed = split.no_memory || (done && !keep_parts(to, &split));
        to->is_lost = !done && !split.no_memory;
    }
    cwi_free(ends);
    cwi_split_free(&split);
}

/* Lists where the seams of each triangle begin. */
static bool list_triangles(splitting *s)
{
    const cwi_seams *seams = s->seams;
    for (size_t i = 0; i < seams->count; i++)
        s->count += i == 0 || seams->seams[i].triangle != seams->seams[i - 1].triangle;
    s->first = cwi_alloc_array(s->count + 1, sizeof *s->first);
    s->chunk_count = (s->count + CHUNK - 1) / CHUNK;
    s->chunks = cwi_alloc_zeroed(s->chunk_count, sizeof *s->chunks);
    if (!s->first || !s->chunks)
        return false;
    size_t n = 0;
    for (size_t i = 0; i < seams->count; i++)
        if (i == 0 || seams->seams[i].triangle != seams->seams[i - 1].triangle)
            s->first[n++] = i;
    s->first[n] = seams->count;
    return true;
}

static cw_status collect_parts(const splitting *s, cwi_seams *seams, cwi_triangle_parts *out,
                               cw_error *err)
{
    size_t points = seams->point_count;
    for (size_t k = 0; k < s->chunk_count; k++) {
        const chunk *c = &s->chunks[k];
        if (c->is_lost)
            return cwi_fail(err, CW_ERR_CHECK, "a triangle could not be split along a line");
        if (c->failed)
            return cwi_fail_memory(err);
        out->count += c->part_count;
        points += c->point_count;
    }
    if (points + s->s->vertex_count >= NEW_POINT)
        return cwi_fail(err, CW_ERR_LIMIT, "the meshes meet in more than 2^31 points");
    out->parts = cwi_alloc_array(out->count, sizeof *out->parts);
    out->points = cwi_realloc_array(seams->points, points, sizeof *out->points);
    if (!out->parts || !out->points)
        return cwi_fail_memory(err);
    seams->points = NULL;
    out->point_count = seams->point_count;
    size_t n = 0;
    for (size_t k = 0; k < s->chunk_count; k++) {
        const chunk *c = &s->chunks[k];
        const uint32_t base = (uint32_t)(s->s->vertex_count + out->point_count);
        for (size_t i = 0; i < c->part_count; i++) {
            out->parts[n] = c->parts[i];
            for (int j = 0; j < 3; j++)
                if (out->parts[n].corners[j] & NEW_POINT)
                    out->parts[n].corners[j] = base + (out->parts[n].corners[j] & ~NEW_POINT);
            n++;
        }
        for (size_t i = 0; i < c->point_count; i++)
            out->points[out->point_count++] = c->points[i];
    }
    return CW_OK;
}

cw_status cwi_split_triangles(const cwi_soup *s, cwi_seams *seams, int threads,
                              const cw_progress *progress, cwi_triangle_parts *out,
                              cw_error *err)
{
    splitting w = {.s = s, .seams = seams};
    cw_status st = list_triangles(&w)
                       ? cwi_parallel_for(w.chunk_count, CHUNK * 4096, threads, progress,
                                          "splitting", split_chunk, &w, err)
                       : cwi_fail_memory(err);
    if (st == CW_OK)
        st = collect_parts(&w, seams, out, err);
    for (size_t k = 0; k < w.chunk_count && w.chunks; k++) {
        cwi_free(w.chunks[k].parts);
        cwi_free(w.chunks[k].points);
    }
    cwi_free(w.chunks);
    cwi_free(w.first);
    return st;
}
