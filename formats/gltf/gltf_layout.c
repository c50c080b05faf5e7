/* Lays out the arrays of a glTF file: accessors, their bytes, bounds and places in the
 * buffer. */
#include "core/geometry/box.h"
#include "formats/gltf/gltf_pack.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

enum {
    BYTE = 5120,
    UNSIGNED_BYTE = 5121,
    UNSIGNED_SHORT = 5123,
    UNSIGNED_INT = 5125,
    FLOAT = 5126
};

/* The maximum of a buffer: GLB states lengths in 32 bits, and the JSON takes a part of that. */
static const uint64_t MAX_BYTES = UINT32_MAX - (1 << 20);

void cwi_gltf_plan_free(cwi_gltf_plan *plan)
{
    for (size_t i = 0; i < plan->block_count; i++)
        cwi_free(plan->blocks[i].bytes);
    for (size_t i = 0; plan->own && i < plan->parts.count; i++)
        cw_mesh_free(&plan->own[i]);
    cwi_free(plan->blocks);
    cwi_free(plan->keys);
    cwi_free(plan->own);
    cwi_free(plan->pieces);
    cwi_free(plan->parts.items);
    *plan = (cwi_gltf_plan){0};
}

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

static bool on_grid(const cwi_gltf_plan *plan)
{
    return plan->rounded && plan->grid.bits;
}

void cwi_gltf_plan_arrays(const cwi_gltf_plan *plan, cwi_gltf_piece *piece)
{
    const cw_mesh *m = &piece->part->mesh;
    const bool rounded = plan->rounded, shorts = on_grid(plan) && !plan->grid.dyadic;
    const int index = index_component(m);
    piece->array_count = 0;
    add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_INDICES,
                                      .component = index,
                                      .numbers = 1,
                                      .count = 3 * m->triangle_count,
                                      .stride = index == UNSIGNED_SHORT ? 2 : 4});
    add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_POSITION,
                                      .component = shorts ? UNSIGNED_SHORT : FLOAT,
                                      .numbers = 3,
                                      .exponential = on_grid(plan) && plan->grid.dyadic,
                                      .count = m->vertex_count,
                                      .stride = shorts ? 8 : 12});
    if (piece->part->arrays & CW_KEEPS_NORMALS)
        add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_NORMAL,
                                          .component = rounded ? BYTE : FLOAT,
                                          .numbers = 3,
                                          .normalized = rounded,
                                          .count = m->vertex_count,
                                          .stride = rounded ? 4 : 12});
    if (m->colors)
        add_array(piece, (cwi_gltf_array){.use = CWI_GLTF_COLOR,
                                          .component = UNSIGNED_BYTE,
                                          .numbers = 4,
                                          .normalized = true,
                                          .count = m->vertex_count,
                                          .stride = 4});
}

double cwi_gltf_stored(const cwi_gltf_plan *plan, float coordinate, int axis)
{
    const cwi_quantization_grid *g = &plan->grid;
    return !on_grid(plan) ? (double)coordinate
           : g->dyadic    ? cwi_grid_round_signed(g, coordinate, axis) * g->step
                          : cwi_grid_round(g, coordinate, axis);
}

/* Finds the box of the stored positions, exact to the bit in single precision. */
static void find_bounds(const cwi_gltf_plan *plan, cwi_gltf_piece *piece)
{
    const cw_mesh *m = &piece->part->mesh;
    cwi_box_clear(piece->low, piece->high);
    if (piece->part->spool) {
        cwi_spool_range(piece->part->spool, piece->low, piece->high);
        return;
    }
    for (size_t i = 0; i < 3 * m->vertex_count; i++) {
        const int a = (int)(i % 3);
        const double x = cwi_gltf_stored(plan, m->positions[i], a);
        piece->low[a] = x < piece->low[a] ? x : piece->low[a];
        piece->high[a] = x > piece->high[a] ? x : piece->high[a];
    }
}

/* Sets the node's translation: the place of the stored positions. */
static void place_piece(const cwi_gltf_plan *plan, cwi_gltf_piece *piece)
{
    const cwi_quantization_grid *g = &plan->grid;
    piece->step = on_grid(plan) && !g->dyadic ? g->step : 1;
    for (int a = 0; a < 3; a++) {
        piece->translation[a] = piece->part->mesh.origin[a];
        if (on_grid(plan))
            piece->translation[a] += g->dyadic ? cwi_grid_middle(g, a) : (double)g->origin[a];
    }
}

static bool is_translucent(const cw_mesh *mesh)
{
    for (size_t v = 0; mesh->colors && v < mesh->vertex_count; v++)
        if (mesh->colors[4 * v + 3] != 255)
            return true;
    return false;
}

/* --- bytes -------------------------------------------------------------------------------- */

/* Fills the table from sRGB to linear colours, which glTF has; alpha is already linear. */
static void fill_linear(unsigned char linear[256])
{
    for (int i = 0; i < 256; i++) {
        const double c = i / 255.0;
        linear[i] = (unsigned char)lround(
            255 * (c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4)));
    }
}

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
    if (a->component == FLOAT) {
        cwi_put_f32x3(to, p);
        return;
    }
    for (int c = 0; c < 3; c++)
        to = cwi_put_u16(to, (uint16_t)cwi_grid_round(g, p[c], c));
    cwi_put_u16(to, 0);
}

static void put_normal(const cwi_gltf_array *a, const float *n, unsigned char *to)
{
    if (a->component == FLOAT) {
        cwi_put_f32x3(to, n);
        return;
    }
    for (int c = 0; c < 3; c++)
        to[c] = (unsigned char)lrint(127 * fmax(-1, fmin(1, (double)n[c])));
    to[3] = 0;
}

void cwi_gltf_put(const cwi_gltf_plan *plan, const cwi_gltf_piece *piece,
                  const cwi_gltf_array *a, size_t i, unsigned char *to)
{
    const cw_mesh *m = &piece->part->mesh;
    switch (a->use) {
    case CWI_GLTF_INDICES:
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
    default:
        for (size_t c = 0; c < 4; c++)
            to[c] = c < 3 ? plan->linear[m->colors[4 * i + c]] : m->colors[4 * i + c];
    }
}

/* --- the file ----------------------------------------------------------------------------- */

/* Places the arrays one after another, each at a multiple of 4 bytes, as accessors require. */
static cw_status lay_out(cwi_gltf_plan *plan, cw_error *err)
{
    cwi_gltf_document *d = &plan->document;
    uint64_t at = 0;
    for (size_t p = 0; p < plan->parts.count; p++)
        for (size_t n = 0; !plan->pieces[p].draco && n < plan->pieces[p].array_count; n++) {
            cwi_gltf_array *a = &plan->pieces[p].arrays[n];
            a->at = at;
            at += (a->count * a->stride + 3) / 4 * 4; /* below 2^36 for each */
        }
    if (plan->blocks)
        d->unpacked = d->unpacked ? at : 0;
    else
        d->bytes = at;
    return d->bytes <= MAX_BYTES ? CW_OK
                                 : cwi_fail(err, CW_ERR_LIMIT,
                                            "glTF holds at most 4 GiB; the mesh needs %.1f GiB",
                                            (double)d->bytes / 1073741824.0);
}

/* Returns true if positions or normals are integers; glTF without extensions requires
 * floats. */
static bool is_quantized(const cwi_gltf_piece *piece)
{
    for (size_t n = 0; n < piece->array_count; n++) {
        const cwi_gltf_array *a = &piece->arrays[n];
        if ((a->use == CWI_GLTF_POSITION || a->use == CWI_GLTF_NORMAL) && a->component != FLOAT)
            return true;
    }
    return false;
}

/* Makes the pieces, and copies the list of parts, since compression may replace them. */
static cw_status make_pieces(cwi_gltf_plan *plan, const cwi_parts *parts, cw_error *err)
{
    plan->pieces = cwi_alloc_zeroed(parts->count, sizeof *plan->pieces);
    plan->parts = *parts;
    plan->parts.items = cwi_alloc_array(parts->count, sizeof *parts->items);
    if (!plan->pieces || !plan->parts.items)
        return cwi_fail_memory(err);
    memcpy(plan->parts.items, parts->items, parts->count * sizeof *parts->items);
    for (size_t p = 0; p < parts->count; p++)
        plan->pieces[p].part = &plan->parts.items[p];
    plan->document.pieces = plan->pieces;
    plan->document.count = parts->count;
    return CW_OK;
}

static cw_status check_vertices(const cwi_parts *parts, cw_error *err)
{
    for (size_t p = 0; p < parts->count; p++)
        if (parts->items[p].mesh.vertex_count >= UINT32_MAX)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "glTF holds at most 4294967294 vertices in a mesh; this has %zu",
                            parts->items[p].mesh.vertex_count);
    return CW_OK;
}

cw_status cwi_gltf_plan_make(cwi_gltf_plan *plan, const cwi_parts *parts,
                             const cwi_mesh_output *out, cw_error *err)
{
    cwi_gltf_document *d = &plan->document;
    cw_status st = check_vertices(parts, err);
    if (st == CW_OK)
        st = make_pieces(plan, parts, err);
    if (st != CW_OK)
        return st;
    fill_linear(plan->linear);
    d->local_origin = out->local_origin;
    d->provenance = out->desc->provenance;
    d->provenance_count = out->desc->provenance_count;
    if (out->desc->compression != CW_COMPRESS_NONE)
        st = cwi_gltf_compress(plan, out->desc, err);
    for (size_t p = 0; st == CW_OK && p < parts->count; p++)
        if (!plan->pieces[p].array_count) /* compressed pieces have theirs already */
            cwi_gltf_plan_arrays(plan, &plan->pieces[p]);
    if (st == CW_OK)
        st = lay_out(plan, err);
    if (st == CW_OK)
        st = cwi_gltf_plan_animation(plan, err);
    for (size_t p = 0; st == CW_OK && p < parts->count; p++) {
        cwi_gltf_piece *piece = &plan->pieces[p];
        if (!piece->draco)
            find_bounds(plan, piece);
        place_piece(plan, piece);
        d->quantized = d->quantized || is_quantized(piece);
        piece->translucent = is_translucent(&piece->part->mesh);
    }
    return st;
}
