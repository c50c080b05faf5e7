/* Plans the arrays of a part for a glTF file, and puts their elements as bytes. */
#include "formats/bytes/little_endian.h"
#include "formats/gltf/gltf_pack.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/texture/tangents.h"

#include <math.h>
#include <string.h>

enum { BYTE = 5120, UNSIGNED_BYTE = 5121, UNSIGNED_SHORT = 5123, UNSIGNED_INT = 5125 };

/* --- arrays ------------------------------------------------------------------------------- */

/* Returns the type of indices. 65535 in 16 bits means "restart" and must not be an index. */
static int index_component(const cw_mesh *mesh)
{
    return mesh->vertex_count <= UINT16_MAX ? UNSIGNED_SHORT : UNSIGNED_INT;
}

static void add_array(cwi_gltf_piece *piece, cwi_gltf_array array)
{
    piece->arrays[piece->array_count++] = array;
}

/* Returns true if 8 bits of linear light hold all colours of the vertices. */
static bool fit_bytes(const cwi_gltf_plan *plan, const cw_mesh *mesh)
{
    for (size_t i = 0; i < 4 * mesh->vertex_count; i++)
        if (i % 4 != 3 && !plan->fits_byte[mesh->colors[i]])
            return false;
    return true;
}

void cwi_gltf_plan_arrays(const cwi_gltf_plan *plan, cwi_gltf_piece *piece)
{
    const cw_mesh *m = &piece->part->mesh;
    const bool rounded = plan->rounded, shorts = cwi_gltf_on_grid(plan) && !plan->grid.dyadic;
    const int index = index_component(m);
    piece->array_count = 0;
    add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_INDICES,
                                      .component = index,
                                      .numbers = 1,
                                      .count = 3 * m->triangle_count,
                                      .stride = index == UNSIGNED_SHORT ? 2 : 4});
    add_array(piece,
              (cwi_gltf_array){.use = CWI_GLTF_POSITION,
                               .component = shorts ? UNSIGNED_SHORT : CWI_GLTF_FLOAT,
                               .numbers = 3,
                               .exponential = cwi_gltf_on_grid(plan) && plan->grid.dyadic,
                               .count = m->vertex_count,
                               .stride = shorts ? 8 : 12});
    if (piece->part->arrays & CW_KEEPS_NORMALS)
        add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_NORMAL,
                                          .component = rounded ? BYTE : CWI_GLTF_FLOAT,
                                          .numbers = 3,
                                          .normalized = rounded,
                                          .count = m->vertex_count,
                                          .stride = rounded ? 4 : 12});
    if (piece->part->texture)
        add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_TEXTURE,
                                          .component = CWI_GLTF_FLOAT,
                                          .numbers = 2,
                                          .count = m->vertex_count,
                                          .stride = 8});
    if (piece->tangents)
        add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_TANGENT,
                                          .component = CWI_GLTF_FLOAT,
                                          .numbers = 4,
                                          .count = m->vertex_count,
                                          .stride = 16});
    if (!m->colors)
        return;
    const bool bytes = fit_bytes(plan, m);
    add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_COLOR,
                                      .component = bytes ? UNSIGNED_BYTE : UNSIGNED_SHORT,
                                      .numbers = 4,
                                      .normalized = true,
                                      .count = m->vertex_count,
                                      .stride = bytes ? 4 : 8});
}

cw_status cwi_gltf_add_tangents(cwi_gltf_piece *piece, cw_error *err)
{
    const cwi_part *part = piece->part;
    if (!piece->images[CWI_GLTF_NORMAL_PICTURE] || !part->texture || !part->mesh.normals)
        return CW_OK;
    piece->tangents = cwi_alloc_array(part->mesh.vertex_count, sizeof *piece->tangents);
    return piece->tangents ? cwi_tangents(&part->mesh, piece->tangents, err)
                           : cwi_fail_memory(err);
}

void cwi_gltf_use_bytes(cwi_gltf_array *colors)
{
    colors->component = UNSIGNED_BYTE;
    colors->stride = 4;
}

double cwi_gltf_stored(const cwi_gltf_plan *plan, float coordinate, int axis)
{
    const cwi_quantization_grid *g = &plan->grid;
    return !cwi_gltf_on_grid(plan) ? (double)coordinate
           : g->dyadic             ? cwi_grid_round_signed(g, coordinate, axis) * g->step
                                   : cwi_grid_round(g, coordinate, axis);
}

/* --- bytes -------------------------------------------------------------------------------- */

static void put_position(const cwi_gltf_plan *plan, const cwi_gltf_array *a, const float *p,
                         unsigned char *to)
{
    const cwi_quantization_grid *g = &plan->grid;
    if (a->exponential) { /* 24 bits of mantissa, 8 of exponent, both signed */
        for (int c = 0; c < 3; c++)
            to = cwi_put_u32(to, ((uint32_t)cwi_grid_round_signed(g, p[c], c) & 0xffffff) |
                                     (uint32_t)g->exponent << 24);
        return;
    }
    if (a->component == CWI_GLTF_FLOAT) {
        cwi_put_f32x3(to, p);
        return;
    }
    for (int c = 0; c < 3; c++)
        to = cwi_put_u16(to, (uint16_t)cwi_grid_round(g, p[c], c));
    cwi_put_u16(to, 0);
}

static void put_normal(const cwi_gltf_array *a, const float *n, unsigned char *to)
{
    if (a->component == CWI_GLTF_FLOAT) {
        cwi_put_f32x3(to, n);
        return;
    }
    for (int c = 0; c < 3; c++)
        to[c] = (unsigned char)lrint(127 * fmax(-1, fmin(1, (double)n[c])));
    to[3] = 0;
}

/* Rounds 16 bits to 8, which are 257 times as coarse. */
static void put_color(const cwi_gltf_plan *plan, const cwi_gltf_array *a, const uint8_t *color,
                      unsigned char *to)
{
    for (size_t c = 0; c < 4; c++) {
        const unsigned fine = c < 3 ? plan->linear[color[c]] : 257u * color[c];
        if (a->component == UNSIGNED_SHORT)
            to = cwi_put_u16(to, (uint16_t)fine);
        else
            *to++ = (unsigned char)((fine + 128) / 257);
    }
}

void cwi_gltf_put(const cwi_gltf_plan *plan, const cwi_gltf_piece *piece,
                  const cwi_gltf_array *a, size_t i, unsigned char *to)
{
    const cw_mesh *m = &piece->part->mesh;
    switch (a->use) {
    case CWI_GLTF_INDICES:
        i = piece->groups.order ? 3 * (size_t)piece->groups.order[i / 3] + i % 3 : i;
        if (a->component == UNSIGNED_SHORT)
            cwi_put_u16(to, (uint16_t)m->triangles[i]);
        else
            cwi_put_u32(to, m->triangles[i]);
        break;
    case CWI_GLTF_POSITION:
        put_position(plan, a, m->positions + 3 * i, to);
        break;
    case CWI_GLTF_NORMAL:
        put_normal(a, m->normals + 3 * i, to);
        break;
    case CWI_GLTF_TANGENT:
        for (size_t c = 0; c < 4; c++)
            to = cwi_put_f32(to, piece->tangents[i][c]);
        break;
    case CWI_GLTF_TEXTURE:
        for (size_t c = 0; c < 2; c++)
            to = cwi_put_f32(to, ((const float *)piece->part->texture->data)[2 * i + c]);
        break;
    default:
        put_color(plan, a, m->colors + 4 * i, to);
    }
}

/* --- the animation that shows one piece after another ------------------------------------- */

/* The scales of a node in time. A row is: hidden, shown, hidden, hidden to the end; the last
 * piece has: hidden, shown, shown to the end. A piece that is shown from the start omits the
 * first of its row. */
enum { LAST_ROW = 4, ROWS = 7 };
static const float scales[ROWS] = {0, 1, 0, 0, 0, 1, 1};
enum { SCALE_BYTES = 12, VALUES_BYTES = ROWS * SCALE_BYTES };

static void add_key(cwi_gltf_piece *piece, double time_s)
{
    piece->times[piece->time_count++] = (float)time_s;
}

/* Sets the times of a piece. Every piece has a key at the end, so all samplers end together. */
static void set_keys(cwi_gltf_piece *piece, double end_s)
{
    const cwi_part *part = piece->part;
    const bool first = part->from_s == 0, last = part->until_s == end_s;
    if (!first)
        add_key(piece, 0);
    add_key(piece, part->from_s);
    if (!last)
        add_key(piece, part->until_s);
    add_key(piece, end_s);
    piece->first_scale = (last ? LAST_ROW : 0) + (first ? 1 : 0);
}

static unsigned char *put_single(unsigned char *to, float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    return cwi_put_u32(to, bits);
}

static void put_keys(const cwi_gltf_plan *plan, unsigned char *to)
{
    for (size_t i = 0; i < ROWS * 3; i++)
        to = put_single(to, scales[i / 3]);
    for (size_t p = 0; p < plan->parts.count; p++)
        for (size_t n = 0; n < plan->pieces[p].time_count; n++)
            to = put_single(to, plan->pieces[p].times[n]);
}

cw_status cwi_gltf_plan_animation(cwi_gltf_plan *plan, cw_error *err)
{
    cwi_gltf_document *d = &plan->document;
    size_t times = 0;
    d->end_s = plan->parts.end_s;
    if (d->end_s == 0)
        return CW_OK;
    for (size_t p = 0; p < plan->parts.count; p++) {
        set_keys(&plan->pieces[p], d->end_s);
        times += plan->pieces[p].time_count;
    }
    d->scale_count = ROWS;
    d->keys_at = d->bytes;
    plan->keys_size = VALUES_BYTES + 4 * times;
    plan->keys = cwi_alloc_array(plan->keys_size, 1);
    if (!plan->keys)
        return cwi_fail_memory(err);
    put_keys(plan, plan->keys);
    d->bytes += plan->keys_size;
    return CW_OK;
}
