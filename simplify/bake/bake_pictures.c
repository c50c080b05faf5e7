/* Bakes the pictures of textured surfaces: every texel asks them. */
#include <cubewright/bake.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/point_triangle.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/texture/split_seams.h"
#include "core/texture/tangents.h"
#include "simplify/bake/bake_frame.h"
#include "simplify/bake/bake_input.h"
#include "simplify/bake/texels.h"

#include <math.h>
#include <string.h>

typedef struct carrying {
    cw_mesh mesh, full; /* copies, with vertices split at seams; full: all sources */
    float (*tangents)[4], (*full_tangents)[4];
    const cw_bake_source *sources;
    size_t *ends; /* of the triangles of each source in full */
    size_t count;
    cwi_boxes tree;
    uint32_t size, *triangle; /* as in cwi_texels_find() */
    double reach, shift[3];
    cw_image *pictures;
    cwi_bake_row *rows;
} carrying;

/* --- the sources -------------------------------------------------------------------------- */

/* Copies a source with its normals and the places of its corners alone; 0 where it has none. */
static cw_status copy_source(const cw_bake_source *s, cw_mesh *copy, cw_error *err)
{
    cw_mesh bare = *s->mesh;
    const cw_attribute *from = cwi_texture_of(s->mesh);
    float(*uv)[2];
    bare.scalars = NULL;
    bare.colors = NULL;
    bare.labels = NULL;
    bare.attributes = NULL;
    bare.attribute_count = 0;
    cw_status st = cwi_mesh_copy(&bare, copy, err);
    if (st == CW_OK && !copy->normals)
        st = cw_mesh_normals(copy, err);
    if (st == CW_OK)
        st = cwi_texture_add(copy, CW_ON_CORNERS, &uv, err);
    for (size_t c = 0; st == CW_OK && from && c < 3 * copy->triangle_count; c++)
        memcpy(uv[c],
               (const float *)from->data +
                   2 * (from->on == CW_ON_CORNERS ? c : copy->triangles[c]),
               sizeof *uv);
    return st;
}

static cw_status join_sources(carrying *b, cw_error *err)
{
    cw_mesh all = {0};
    cw_status st = CW_OK;
    for (size_t n = 0; n < b->count && st == CW_OK; n++) {
        cw_mesh copy = {0};
        st = copy_source(&b->sources[n], &copy, err);
        if (st == CW_OK && n == 0) {
            all = copy;
            b->ends[n] = all.triangle_count;
            continue;
        }
        if (st == CW_OK)
            st = cwi_mesh_append(&all, &copy, err);
        b->ends[n] = all.triangle_count;
        cw_mesh_free(&copy);
    }
    if (st == CW_OK)
        st = cwi_split_seams(&all, &b->full, err);
    cw_mesh_free(&all);
    return st;
}

static const cw_bake_source *source_of(const carrying *b, uint32_t triangle)
{
    size_t n = 0;
    while (triangle >= b->ends[n])
        n++;
    return &b->sources[n];
}

/* --- pixels ------------------------------------------------------------------------------- */

/* Returns the pixel that a coordinate lies in, of a row or column. */
static size_t wrap(double at, size_t size, bool repeats)
{
    const double last = (double)size - 1;
    if (repeats)
        return (size_t)fmin(fmax(at - floor(at / (double)size) * (double)size, 0), last);
    return (size_t)fmin(fmax(at, 0), last);
}

/* Interpolates between the middles of four pixels. */
static void sample(const cw_image *image, const double uv[2], bool repeats, double value[4])
{
    const double x = uv[0] * (double)image->width - 0.5,
                 y = uv[1] * (double)image->height - 0.5, fx = x - floor(x), fy = y - floor(y);
    memset(value, 0, 4 * sizeof *value);
    for (int corner = 0; corner < 4; corner++) {
        const int right = corner & 1, down = corner >> 1;
        const size_t column = wrap(floor(x) + right, image->width, repeats),
                     row = wrap(floor(y) + down, image->height, repeats);
        const double weight = (right ? fx : 1 - fx) * (down ? fy : 1 - fy);
        for (size_t c = 0; c < 4; c++)
            value[c] += weight * image->pixels[4 * (row * image->width + column) + c];
    }
}

/* Turns a pixel of a normal map into a direction. */
static void turn_normal(const cwi_texel_frame *f, const double value[4], double normal[3])
{
    for (int k = 0; k < 3; k++)
        normal[k] = (value[0] / 127.5 - 1) * f->tangent[k] +
                    (value[1] / 127.5 - 1) * f->bitangent[k] +
                    (value[2] / 127.5 - 1) * f->normal[k];
    cwi_normalise(normal);
}

/* Fills one texel of all pictures from the point of a triangle. */
static void fill_texel(const carrying *b, uint32_t found, const double point[3],
                       const cwi_texel_frame *frame, size_t texel)
{
    const cw_bake_source *s = source_of(b, found);
    const uint32_t *v = b->full.triangles + 3 * (size_t)found;
    const float *p = b->full.positions, *uv = cwi_texture_of(&b->full)->data;
    double weights[3], place[2] = {0, 0}, value[4];
    cwi_facet_nearest(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2], point,
                      weights);
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < 2; k++)
            place[k] += weights[c] * (double)uv[2 * (size_t)v[c] + k];
    for (int use = 0; use < CW_PICTURE_USES; use++) {
        uint8_t *pixel = b->pictures[use].pixels ? b->pictures[use].pixels + 4 * texel : NULL;
        if (!pixel || (use != CW_PICTURE_NORMAL && !s->pictures[use]))
            continue;
        if (s->pictures[use])
            sample(s->pictures[use], place, s->repeats, value);
        if (use == CW_PICTURE_NORMAL) {
            cwi_texel_frame full;
            cwi_texel_frame_find(&b->full, (const float(*)[4])b->full_tangents, found, weights,
                                 &full);
            if (s->pictures[use])
                turn_normal(&full, value, full.normal);
            cwi_texel_put_normal(frame, full.normal, pixel);
            continue;
        }
        for (int c = 0; c < 4; c++)
            pixel[c] = (uint8_t)floor(value[c] + 0.5);
    }
}

static void fill_row(void *context, size_t y)
{
    carrying *b = context;
    cwi_bake_row *facts = &b->rows[y];
    const float *uv = cwi_texture_of(&b->mesh)->data;
    double last[3] = {0, 0, 0}, last_mm = INFINITY;
    for (uint32_t x = 0; x < b->size; x++) {
        const size_t texel = y * b->size + x;
        const uint32_t triangle = b->triangle[texel];
        double point[3], weights[3], distance_sq;
        cwi_texel_frame f;
        if (triangle == CWI_NO_TEXEL) {
            last_mm = INFINITY;
            continue;
        }
        cwi_texel_weights(uv, b->mesh.triangles + 3 * (size_t)triangle, b->size, x, (uint32_t)y,
                          weights);
        cwi_texel_frame_find(&b->mesh, (const float(*)[4])b->tangents, triangle, weights, &f);
        for (int k = 0; k < 3; k++)
            point[k] = f.point[k] + b->shift[k];
        const double bound = (last_mm + cwi_distance(point, last)) * (1 + 1e-9);
        const uint32_t found =
            cwi_facing_find(&b->full, &b->tree, point, f.normal, bound, b->reach, &distance_sq);
        facts->texels++;
        last_mm = found == CWI_NO_TEXEL ? INFINITY : sqrt(distance_sq);
        memcpy(last, point, sizeof last);
        facts->missed += found == CWI_NO_TEXEL;
        if (found == CWI_NO_TEXEL)
            continue;
        fill_texel(b, found, point, &f, texel);
        facts->max_mm = fmax(facts->max_mm, last_mm);
        facts->sum_mm += last_mm;
    }
}

/* --- the whole ---------------------------------------------------------------------------- */

static cw_status make_pictures(carrying *b, cw_error *err)
{
    static const uint8_t white[4] = {255, 255, 255, 255}, flat[4] = {128, 128, 255, 255};
    cw_status st = CW_OK;
    for (int use = 0; use < CW_PICTURE_USES && st == CW_OK; use++) {
        bool is_there = false;
        for (size_t n = 0; n < b->count; n++)
            is_there = is_there || b->sources[n].pictures[use];
        if (!is_there)
            continue;
        st = cw_image_alloc(&b->pictures[use], b->size, b->size, err);
        for (size_t n = 0; st == CW_OK && n < (size_t)b->size * b->size; n++)
            memcpy(b->pictures[use].pixels + 4 * n, use == CW_PICTURE_NORMAL ? flat : white, 4);
    }
    return st;
}

static cw_status prepare(carrying *b, const cw_mesh *mesh, const cw_bake_desc *d, cw_error *err)
{
    const bool at_corners = cwi_has_seams(mesh);
    double low[3], high[3];
    b->size = d->size;
    b->ends = cwi_alloc_array(b->count, sizeof *b->ends);
    cw_status st = b->ends ? join_sources(b, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = at_corners ? cwi_split_seams(mesh, &b->mesh, err)
                        : cwi_mesh_copy(mesh, &b->mesh, err);
    if (st == CW_OK)
        st = cwi_closest_build(&b->full, &b->tree, err);
    if (st != CW_OK)
        return st;
    cw_mesh_bounds(mesh, low, high);
    b->reach = d->reach_mm > 0 ? d->reach_mm : CWI_BAKE_REACH * cwi_distance(low, high);
    for (int k = 0; k < 3; k++)
        b->shift[k] = mesh->origin[k] - b->full.origin[k];
    b->tangents = cwi_alloc_array(b->mesh.vertex_count, sizeof *b->tangents);
    b->full_tangents = cwi_alloc_array(b->full.vertex_count, sizeof *b->full_tangents);
    b->triangle = cwi_alloc_array((size_t)d->size * d->size, sizeof *b->triangle);
    b->rows = cwi_alloc_zeroed(d->size, sizeof *b->rows);
    if (!b->tangents || !b->full_tangents || !b->triangle || !b->rows)
        return cwi_fail_memory(err);
    st = cwi_tangents(&b->mesh, b->tangents, err);
    return st == CW_OK ? cwi_tangents(&b->full, b->full_tangents, err) : st;
}

/* Gives pixels beside charts the mean of those in them. */
static cw_status spread_pixels(const carrying *b, uint32_t margin, uint8_t *pixels,
                               cw_error *err)
{
    const size_t count = 4 * (size_t)b->size * b->size;
    uint16_t *texels = cwi_alloc_array(count, sizeof *texels);
    if (!texels)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        texels[n] = pixels[n];
    cw_status st = cwi_texels_spread(b->triangle, b->size, margin, texels, 4, err);
    for (size_t n = 0; n < count; n++)
        pixels[n] = (uint8_t)texels[n];
    cwi_free(texels);
    return st;
}

static cw_status fill_pictures(carrying *b, const cw_bake_desc *d, cw_error *err)
{
    cwi_texels_find(&b->mesh, d->size, b->triangle);
    cw_status st = make_pictures(b, err);
    if (st == CW_OK)
        st = cwi_parallel_for(d->size, d->size * (size_t)64, d->threads, &d->progress,
                              "baking pictures", fill_row, b, err);
    for (int use = 0; use < CW_PICTURE_USES && st == CW_OK; use++)
        if (b->pictures[use].pixels)
            st = spread_pixels(b, d->margin, b->pictures[use].pixels, err);
    return st;
}

static cw_status check_sources(const cw_mesh *mesh, const cw_bake_source *sources, size_t count,
                               const cw_bake_desc *d, cw_error *err)
{
    cw_status st = count ? CW_OK : cwi_fail(err, CW_ERR_ARGUMENT, "there are no sources");
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        bool has_pictures = false;
        if (!sources[n].mesh)
            return cwi_fail(err, CW_ERR_ARGUMENT, "sources[%zu].mesh is NULL", n);
        st = cwi_bake_check(mesh, sources[n].mesh, d, err);
        for (int use = 0; use < CW_PICTURE_USES; use++)
            has_pictures = has_pictures || sources[n].pictures[use];
        if (st == CW_OK && has_pictures && !cwi_texture_of(sources[n].mesh))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "sources[%zu] has pictures, but no texture coordinates", n);
    }
    return st;
}

cw_status cw_bake_pictures(const cw_mesh *mesh, const cw_bake_source *sources, size_t count,
                           const cw_bake_desc *desc, cw_image *pictures, cw_bake_facts *facts,
                           cw_error *err)
{
    CWI_REQUIRE(err, mesh, pictures);
    CWI_REQUIRE_ARRAY(err, sources, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_bake_desc d = cwi_bake_defaults(desc);
    carrying b = {.sources = sources, .count = count, .pictures = pictures};
    memset(pictures, 0, CW_PICTURE_USES * sizeof *pictures);
    cw_status st = check_sources(mesh, sources, count, &d, err);
    if (st == CW_OK)
        st = prepare(&b, mesh, &d, err);
    if (st == CW_OK)
        st = fill_pictures(&b, &d, err);
    for (int use = 0; use < CW_PICTURE_USES && st != CW_OK; use++)
        cw_image_free(&pictures[use]);
    if (st == CW_OK && facts) {
        cwi_bake_sum(b.rows, b.size, facts);
        facts->reach_mm = b.reach;
    }
    cw_mesh_free(&b.mesh);
    cw_mesh_free(&b.full);
    cwi_boxes_free(&b.tree);
    cwi_free(b.ends);
    cwi_free(b.tangents);
    cwi_free(b.full_tangents);
    cwi_free(b.triangle);
    cwi_free(b.rows);
    return st;
}
