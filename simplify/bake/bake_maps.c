/* Bakes maps: every texel asks the full surface. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/color/deep_image.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/texture/gather_meshes.h"
#include "core/texture/split_seams.h"
#include "core/texture/tangents.h"
#include "simplify/bake/bake_input.h"
#include "simplify/bake/bake_state.h"
#include "simplify/bake/texels.h"

#include <math.h>
#include <string.h>

enum {
    DEFAULT_SIZE = 2048,
    MIN_SIZE = 16,
    MAX_SIZE = 16384,
    DEFAULT_MARGIN = 2,
    MAX_MARGIN = 64,
    LEAST_COARSE = 16 /* texels along each side of a map of a fourth */
};

/* Shares of the diagonal of the mesh's box. */
static const double DEFAULT_RAY = 0.1, BIAS = 2e-4;

/* A map, and the function that makes its texels. */
static const struct map_kind {
    cwi_texel_shader *shade;
    uint32_t divisor; /* of the size: rays are dear, and what they find changes slowly */
    bool is_smoothed; /* over the texels around each */
} KINDS[CW_MAP_COUNT] = {
    [CW_MAP_NORMALS] = {cwi_shade_normal, 1, false},
    [CW_MAP_OCCLUSION] = {cwi_shade_occlusion, CW_OCCLUSION_DIVISOR, true},
    [CW_MAP_CURVATURE] = {cwi_shade_curvature, 1, false},
    [CW_MAP_THICKNESS] = {cwi_shade_thickness, CW_OCCLUSION_DIVISOR, true},
    [CW_MAP_COLORS] = {cwi_shade_color, 1, false},
};

const char *cw_map_name(cw_map map)
{
    static const char *const names[CW_MAP_COUNT] = {
#define CW_X(name, text) text,
        CW_MAP_TABLE(CW_X)
#undef CW_X
    };
    return (unsigned)map < CW_MAP_COUNT ? names[map] : NULL;
}

/* --- a pass --------------------------------------------------------------------------------- */

/* The maps of one size, which share the places of their texels. */
typedef struct pass {
    const cwi_baking *b;
    unsigned maps; /* a bit 1u << cw_map for each */
    uint32_t size;
    uint32_t *triangle; /* texels: the triangle that the middle lies in; CWI_NO_TEXEL: none */
    uint16_t *texels[CW_MAP_COUNT]; /* size x size x 3 */
    cwi_bake_row *rows;
} pass;

static void put_texel(const pass *p, size_t at, const cwi_texel_frame *f,
                      const cwi_texel_hit *hit)
{
    for (int m = 0; m < CW_MAP_COUNT; m++) {
        double color[3];
        if (!(p->maps >> m & 1))
            continue;
        KINDS[m].shade(p->b, f, hit, color);
        for (size_t k = 0; k < 3; k++)
            p->texels[m][3 * at + k] =
                (uint16_t)floor(fmax(0, fmin(1, color[k])) * UINT16_MAX + 0.5);
    }
}

/* Interpolates the frame at a texel; its place is relative to the origin of the full surface. */
static void find_frame(const pass *p, uint32_t triangle, uint32_t x, uint32_t y,
                       cwi_texel_frame *f)
{
    const cwi_baking *b = p->b;
    double weights[3];
    cwi_texel_weights(cwi_texture_of(&b->mesh)->data, b->mesh.triangles + 3 * (size_t)triangle,
                      p->size, x, y, weights);
    cwi_texel_frame_find(&b->mesh, (const float(*)[4])b->tangents, triangle, weights, f);
    for (int k = 0; k < 3; k++)
        f->point[k] += b->shift[k];
}

static void bake_row(void *context, size_t y)
{
    const pass *p = context;
    cwi_bake_row *facts = &p->rows[y];
    double last[3] = {0, 0, 0}, last_mm = INFINITY;
    for (uint32_t x = 0; x < p->size; x++) {
        const size_t at = y * p->size + x;
        cwi_texel_frame f = {0};
        cwi_texel_hit hit;
        if (p->triangle[at] == CWI_NO_TEXEL) {
            last_mm = INFINITY;
            put_texel(p, at, &f, NULL);
            continue;
        }
        find_frame(p, p->triangle[at], x, (uint32_t)y, &f);
        const double bound = (last_mm + cwi_distance(f.point, last)) * (1 + 1e-9);
        facts->texels++;
        if (!cwi_texel_hit_find(p->b, &f, bound, &hit)) {
            facts->missed++;
            last_mm = INFINITY;
            put_texel(p, at, &f, NULL);
            continue;
        }
        last_mm = hit.distance_mm;
        memcpy(last, f.point, sizeof last);
        put_texel(p, at, &f, &hit);
        facts->max_mm = fmax(facts->max_mm, last_mm);
        facts->sum_mm += last_mm;
        facts->sum_deg += acos(fmax(-1, fmin(1, cwi_dot(hit.normal, f.normal)))) * 180 / CWI_PI;
    }
}

void cwi_bake_sum(const cwi_bake_row *rows, uint32_t count, cw_bake_facts *facts)
{
    double mm = 0, deg = 0;
    *facts = (cw_bake_facts){0};
    for (uint32_t y = 0; y < count; y++) {
        facts->texels += rows[y].texels;
        facts->missed += rows[y].missed;
        facts->max_mm = fmax(facts->max_mm, rows[y].max_mm);
        mm += rows[y].sum_mm;
        deg += rows[y].sum_deg;
    }
    const size_t hit = facts->texels - facts->missed;
    facts->mean_mm = hit ? mm / (double)hit : 0;
    facts->mean_deg = hit ? deg / (double)hit : 0;
}

/* Turns texels to an image of 8 bits, and of 16 if it is asked for. */
static cw_status finish_image(const pass *p, int map, const cw_bake_desc *d, cw_image *image,
                              cw_error *err)
{
    const size_t count = (size_t)p->size * p->size;
    uint16_t *texels = p->texels[map];
    cw_status st =
        KINDS[map].is_smoothed ? cwi_texels_smooth(p->triangle, p->size, texels, err) : CW_OK;
    if (st == CW_OK)
        st = cwi_texels_spread(p->triangle, p->size, d->margin, texels, 3, err);
    if (st == CW_OK)
        st = cw_image_alloc(image, p->size, p->size, err);
    if (st == CW_OK && d->deep)
        st = cwi_image_deepen(image, err);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        for (size_t k = 0; k < 3; k++) {
            image->pixels[4 * n + k] = (uint8_t)((texels[3 * n + k] + 128u) / 257);
            if (image->deep)
                image->deep[4 * n + k] = texels[3 * n + k];
        }
        image->pixels[4 * n + 3] = UINT8_MAX;
        if (image->deep)
            image->deep[4 * n + 3] = UINT16_MAX;
    }
    return st;
}

/* Bakes the maps of one size. facts: NULL: not filled */
static cw_status run_pass(const cwi_baking *b, const cw_bake_desc *d, unsigned maps,
                          uint32_t size, cw_image *images, cw_bake_facts *facts, cw_error *err)
{
    const size_t count = (size_t)size * size;
    pass p = {.b = b, .maps = maps, .size = size};
    bool has_memory = true;
    p.triangle = cwi_alloc_array(count, sizeof *p.triangle);
    p.rows = cwi_alloc_zeroed(size, sizeof *p.rows);
    for (int m = 0; m < CW_MAP_COUNT; m++) {
        p.texels[m] = maps >> m & 1 ? cwi_alloc_array(count, 3 * sizeof(uint16_t)) : NULL;
        has_memory = has_memory && (p.texels[m] || !(maps >> m & 1));
    }
    cw_status st = has_memory && p.triangle && p.rows ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        cwi_texels_find(&b->mesh, size, p.triangle);
        st = cwi_parallel_for(size, size * (size_t)64, d->threads, &d->progress, "baking",
                              bake_row, &p, err);
    }
    for (int m = 0; m < CW_MAP_COUNT && st == CW_OK; m++)
        if (maps >> m & 1)
            st = finish_image(&p, m, d, &images[m], err);
    if (st == CW_OK && facts)
        cwi_bake_sum(p.rows, p.size, facts);
    for (int m = 0; m < CW_MAP_COUNT; m++)
        cwi_free(p.texels[m]);
    cwi_free(p.triangle);
    cwi_free(p.rows);
    return st;
}

/* --- the whole ---------------------------------------------------------------------------- */

static cw_status prepare(cwi_baking *b, const cw_mesh *mesh, const cw_mesh *full,
                         const cw_bake_desc *d, cw_error *err)
{
    double low[3], high[3];
    const double diagonal = cw_mesh_bounds(mesh, low, high) ? cwi_distance(low, high) : 0;
    const bool at_corners = cwi_has_seams(mesh);
    cw_status st =
        at_corners ? cwi_split_seams(mesh, &b->mesh, err) : cwi_mesh_copy(mesh, &b->mesh, err);
    b->full = full->normals ? full : &b->own;
    if (st == CW_OK && !full->normals)
        st = cwi_mesh_copy(full, &b->own, err);
    if (st == CW_OK && !full->normals)
        st = cw_mesh_normals(&b->own, err);
    if (st == CW_OK)
        st = cwi_closest_build(b->full, &b->tree, err);
    if (st != CW_OK)
        return st;
    b->reach = d->reach_mm > 0 ? d->reach_mm : CWI_BAKE_REACH * diagonal;
    b->occlusion_mm = d->occlusion_mm > 0 ? d->occlusion_mm : DEFAULT_RAY * diagonal;
    b->thickness_mm = d->thickness_mm > 0 ? d->thickness_mm : DEFAULT_RAY * diagonal;
    b->curvature_max = d->curvature_max;
    b->bias = BIAS * diagonal;
    for (int k = 0; k < 3; k++)
        b->shift[k] = mesh->origin[k] - full->origin[k];
    b->tangents = cwi_alloc_array(b->mesh.vertex_count, sizeof *b->tangents);
    if (!b->tangents)
        return cwi_fail_memory(err);
    st = cwi_tangents(&b->mesh, b->tangents, err);
    return st == CW_OK && d->maps >> CW_MAP_CURVATURE & 1 ? cwi_curvature_find(b, err) : st;
}

/* Bakes the maps pass by pass: those of the full size, then the others. */
static cw_status bake(cwi_baking *b, const cw_bake_desc *d, cw_image *images,
                      cw_bake_facts *facts, cw_error *err)
{
    static const uint32_t divisors[] = {1, CW_OCCLUSION_DIVISOR};
    cw_status st = CW_OK;
    for (size_t n = 0; n < sizeof divisors / sizeof *divisors && st == CW_OK; n++) {
        unsigned maps = 0;
        const uint32_t size =
            d->size / divisors[n] < LEAST_COARSE ? LEAST_COARSE : d->size / divisors[n];
        for (int m = 0; m < CW_MAP_COUNT; m++)
            maps |= KINDS[m].divisor == divisors[n] ? d->maps & 1u << m : 0;
        if (maps)
            st = run_pass(b, d, maps, size, images, facts->texels ? NULL : facts, err);
    }
    facts->reach_mm = b->reach;
    facts->occlusion_mm = b->occlusion_mm;
    facts->thickness_mm = b->thickness_mm;
    facts->curvature_max = b->curvature_max;
    return st;
}

static cw_status check_settings(const cw_bake_desc *d, cw_error *err)
{
    const struct {
        const char *name;
        double value;
    } lengths[] = {{"reach_mm", d->reach_mm},
                   {"occlusion_mm", d->occlusion_mm},
                   {"thickness_mm", d->thickness_mm},
                   {"curvature_max", d->curvature_max}};
    if (d->size < MIN_SIZE || d->size > MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->size %u: expected %d to %d", d->size,
                        MIN_SIZE, MAX_SIZE);
    if (d->margin > MAX_MARGIN)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->margin %u: expected 1 to %d", d->margin,
                        MAX_MARGIN);
    if (d->maps >> CW_MAP_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "desc->maps 0x%x: expected bits of %d maps",
                        d->maps, CW_MAP_COUNT);
    for (size_t n = 0; n < sizeof lengths / sizeof *lengths; n++)
        if (!(lengths[n].value >= 0) || isinf(lengths[n].value))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "desc->%s %g: expected a positive, finite number", lengths[n].name,
                            lengths[n].value);
    return CW_OK;
}

cw_bake_desc cwi_bake_defaults(const cw_bake_desc *desc)
{
    cw_bake_desc d = desc ? *desc : (cw_bake_desc){0};
    d.size = d.size ? d.size : DEFAULT_SIZE;
    d.margin = d.margin ? d.margin : DEFAULT_MARGIN;
    d.maps = d.maps ? d.maps : 1u << CW_MAP_NORMALS;
    return d;
}

cw_status cwi_bake_check(const cw_mesh *mesh, const cw_mesh *full, const cw_bake_desc *d,
                         cw_error *err)
{
    cw_status st = check_settings(d, err);
    if (st == CW_OK)
        st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = cw_mesh_check(full, err);
    if (st != CW_OK)
        return st;
    if (!cwi_texture_of(mesh))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no texture coordinates");
    if (!mesh->normals)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no normals");
    if (d->maps >> CW_MAP_COLORS & 1 && !full->colors)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the full mesh has no colours of vertices for the map \"colors\"");
    return full->triangle_count ? CW_OK
                                : cwi_fail(err, CW_ERR_ARGUMENT, "the full mesh is empty");
}

cw_status cw_bake_maps(const cw_mesh *mesh, const cw_mesh *full, const cw_bake_desc *desc,
                       cw_image *images, cw_bake_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, full, images);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_bake_desc d = cwi_bake_defaults(desc);
    cw_bake_facts found = {0};
    cwi_baking b = {0};
    memset(images, 0, CW_MAP_COUNT * sizeof *images);
    cw_status st = cwi_bake_check(mesh, full, &d, err);
    if (st == CW_OK)
        st = prepare(&b, mesh, full, &d, err);
    if (st == CW_OK)
        st = bake(&b, &d, images, &found, err);
    if (st == CW_OK && facts)
        *facts = found;
    for (int m = 0; m < CW_MAP_COUNT && st != CW_OK; m++)
        cw_image_free(&images[m]);
    cw_mesh_free(&b.mesh);
    cw_mesh_free(&b.own);
    cwi_boxes_free(&b.tree);
    cwi_free(b.tangents);
    cwi_free(b.curvature);
    return st;
}

/* Fails if a mesh lacks what all need. */
static cw_status check_meshes(const cw_mesh *const *meshes, size_t count, cw_error *err)
{
    cw_status st =
        count ? CW_OK : cwi_fail(err, CW_ERR_ARGUMENT, "count is 0: expected meshes");
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        st = cw_mesh_check(meshes[n], err);
        if (st == CW_OK && !cwi_texture_of(meshes[n]))
            st = cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no texture coordinates");
        if (st == CW_OK && !meshes[n]->normals)
            st = cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no normals");
    }
    return st;
}

cw_status cw_bake_meshes(const cw_mesh *const *meshes, size_t count, const cw_mesh *full,
                         const cw_bake_desc *desc, cw_image *images, cw_bake_facts *facts,
                         cw_error *err)
{
    CWI_REQUIRE(err, meshes, full, images);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_mesh all = {0};
    memset(images, 0, CW_MAP_COUNT * sizeof *images);
    cw_status st = check_meshes(meshes, count, err);
    if (st == CW_OK && count == 1)
        return cw_bake_maps(meshes[0], full, desc, images, facts, err);
    if (st == CW_OK)
        st = cwi_gather_meshes(meshes, NULL, count, true, true, &all, err);
    if (st == CW_OK)
        st = cw_bake_maps(&all, full, desc, images, facts, err);
    cw_mesh_free(&all);
    return st;
}

cw_status cw_bake_normals(const cw_mesh *mesh, const cw_mesh *full, const cw_bake_desc *desc,
                          cw_image *image, cw_bake_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, image);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_bake_desc d = desc ? *desc : (cw_bake_desc){0};
    cw_image images[CW_MAP_COUNT];
    d.maps = 1u << CW_MAP_NORMALS;
    *image = (cw_image){0};
    cw_status st = cw_bake_maps(mesh, full, &d, images, facts, err);
    if (st == CW_OK)
        *image = images[CW_MAP_NORMALS];
    return st;
}
