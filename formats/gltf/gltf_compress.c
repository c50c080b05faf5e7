/* Compresses the parts of a glTF file on one common grid that keeps the tolerance and the
 * shape. Everything compressed is decoded again and compared with the original. */
#include "core/geometry/box.h"
#include "formats/gltf/gltf_pack.h"

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/texture/split_seams.h"
#include "formats/codec/draco_pack.h"
#include "formats/codec/meshopt_wrap.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/gltf/gltf_scene.h"

#include <math.h>
#include <string.h>

cw_status cwi_gltf_prepare_codec(const cw_write_desc *desc, cw_error *err)
{
    const cwi_draco_functions *draco;
    const cwi_meshopt_functions *meshopt;
    const cw_compression kind = desc->compression;
    cw_status st = cwi_grid_check_bits(desc, err);
    if (st != CW_OK)
        return st;
    return kind == CW_COMPRESS_DRACO     ? cwi_draco_functions_load(&draco, err)
           : kind == CW_COMPRESS_MESHOPT ? cwi_meshopt_functions_load(&meshopt, err)
                                         : CW_OK;
}

/* --- one origin, arrays of our own -------------------------------------------------------- */

/* Copies a part and moves it to another origin: parts on one grid need a common one. Normals,
 * colours and texture coordinates stay the caller's arrays unless they are to be reordered. */
static cw_status copy_part(const cwi_part *part, const double origin[3], bool all, cw_mesh *own,
                           cw_error *err)
{
    const cw_mesh *m = &part->mesh;
    cw_status st =
        cwi_mesh_alloc(own, m->vertex_count, m->triangle_count, all && m->normals, err);
    cw_attribute *texture = NULL;
    if (st == CW_OK && all && m->colors && !(own->colors = cwi_alloc_array(m->vertex_count, 4)))
        st = cwi_fail_memory(err);
    if (st == CW_OK && all && part->texture)
        st = cw_mesh_attribute_add(own, part->texture, &texture, err);
    if (st != CW_OK)
        return st;
    for (size_t i = 0; i < 3 * m->vertex_count; i++)
        own->positions[i] = (float)(m->origin[i % 3] - origin[i % 3] + (double)m->positions[i]);
    memcpy(own->triangles, m->triangles, 3 * m->triangle_count * sizeof *m->triangles);
    if (own->normals)
        memcpy(own->normals, m->normals, 3 * m->vertex_count * sizeof *m->normals);
    if (own->colors)
        memcpy(own->colors, m->colors, 4 * m->vertex_count);
    if (texture)
        memcpy(texture->data, part->texture->data, 2 * m->vertex_count * sizeof(float));
    return CW_OK;
}

static bool same_origin(const cwi_parts *parts)
{
    for (size_t p = 1; p < parts->count; p++)
        if (memcmp(parts->items[p].mesh.origin, parts->items[0].mesh.origin,
                   sizeof parts->items[0].mesh.origin) != 0)
            return false;
    return true;
}

/* Replaces parts by copies where their arrays have to change, since these belong to the
 * caller. */
static cw_status own_parts(cwi_gltf_plan *plan, bool all, cw_error *err)
{
    cwi_part *items = plan->parts.items;
    double origin[3];
    memcpy(origin, items[0].mesh.origin, sizeof origin);
    plan->own = cwi_alloc_zeroed(plan->parts.count, sizeof *plan->own);
    if (!plan->own)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < plan->parts.count; p++) {
        cw_mesh *own = &plan->own[p], *m = &items[p].mesh;
        cw_status st = copy_part(&items[p], origin, all, own, err);
        if (st != CW_OK)
            return st;
        m->positions = own->positions;
        m->triangles = own->triangles;
        m->normals = own->normals ? own->normals : m->normals;
        m->colors = own->colors ? own->colors : m->colors;
        if (all && items[p].texture) {
            items[p].texture = cwi_texture_of(own);
            m->attributes = own->attributes;
            m->attribute_count = own->attribute_count;
        }
        memcpy(m->origin, origin, sizeof origin);
    }
    return CW_OK;
}

/* --- blocks ------------------------------------------------------------------------------- */

/* Takes over bytes as a block; blocks begin at multiples of 8. */
static cw_status add_block(cwi_gltf_plan *plan, unsigned char *bytes, size_t size, uint64_t *at,
                           cw_error *err)
{
    if (plan->block_count == plan->block_capacity) {
        const size_t capacity = plan->block_capacity ? 2 * plan->block_capacity : 8;
        cwi_gltf_block *blocks = cwi_realloc_array(plan->blocks, capacity, sizeof *blocks);
        if (!blocks) {
            cwi_free(bytes);
            return cwi_fail_memory(err);
        }
        plan->blocks = blocks;
        plan->block_capacity = capacity;
    }
    plan->blocks[plan->block_count++] = (cwi_gltf_block){bytes, size};
    *at = plan->document.bytes;
    plan->document.bytes += (size + 7) / 8 * 8;
    return CW_OK;
}

/* --- Draco -------------------------------------------------------------------------------- */

static void describe_draco(cwi_gltf_piece *piece, const cwi_quantization_grid *grid,
                           const cwi_arrays *decoded)
{
    cwi_box_clear(piece->low, piece->high);
    for (size_t i = 0; i < 3 * decoded->vertex_count; i++) {
        const double at = grid->bits
                              ? cwi_grid_decode(grid, decoded->grid_points[i], (int)(i % 3))
                              : (double)decoded->positions[i];
        piece->low[i % 3] = fmin(piece->low[i % 3], at);
        piece->high[i % 3] = fmax(piece->high[i % 3], at);
    }
    for (size_t n = 0; n < piece->array_count; n++)
        if (piece->arrays[n].use != CWI_GLTF_INDICES)
            piece->arrays[n].count = decoded->vertex_count;
}

static cw_status compress_draco(cwi_gltf_plan *plan, cwi_gltf_piece *piece,
                                const cw_write_desc *desc, cw_compressed *facts, cw_error *err)
{
    const size_t count = piece->part->mesh.vertex_count;
    unsigned char *colors = NULL;
    cwi_draco_packed packed = {0};
    cw_status st = cwi_gltf_add_tangents(piece, err);
    if (st != CW_OK)
        return st;
    cwi_gltf_plan_arrays(plan, piece);
    if (piece->part->mesh.colors && !(colors = cwi_alloc_array(count, 4)))
        return cwi_fail_memory(err);
    for (size_t n = 0; n < piece->array_count; n++) {
        cwi_gltf_array *a = &piece->arrays[n];
        if (a->use == CWI_GLTF_COLOR)
            cwi_gltf_use_bytes(a);
        for (size_t i = 0; a->use == CWI_GLTF_COLOR && i < count; i++)
            cwi_gltf_put(plan, piece, a, i, colors + 4 * i);
    }
    const cw_attribute *texture = piece->part->texture;
    st = cwi_draco_pack(&piece->part->mesh, colors, texture ? texture->data : NULL,
                        (const float(*)[4])piece->tangents, &plan->grid, NULL, desc, &packed,
                        facts, err);
    cwi_free(colors);
    if (st == CW_OK) {
        describe_draco(piece, &plan->grid, &packed.decoded);
        piece->ids = packed.ids;
        piece->draco = packed.size;
        st = add_block(plan, packed.bytes, packed.size, &piece->draco_at, err);
        packed.bytes = NULL; /* taken over */
    }
    cwi_draco_packed_free(&packed);
    return st;
}

/* --- meshopt ------------------------------------------------------------------------------ */

/* Checks that the filter decodes the bytes to the numbers that their accessor states. */
static bool are_stored(const cwi_meshopt_functions *meshopt, const cwi_gltf_plan *plan,
                       const float *positions, unsigned char *bytes, size_t count)
{
    meshopt->filter(bytes, count, 12, CWI_MESHOPT_EXPONENTIAL);
    for (size_t i = 0; i < 3 * count; i++) {
        float is;
        memcpy(&is, bytes + 4 * i, sizeof is);
        if ((double)is != cwi_gltf_stored(plan, positions[i], (int)(i % 3)))
            return false;
    }
    return true;
}

/* Decodes packed data again, which must be the same to the byte. Indices must give the same
 * triangles, since their codec may rotate them. */
static cw_status check_packed(const cwi_meshopt_functions *meshopt, const cwi_gltf_plan *plan,
                              const cwi_gltf_piece *piece, const cwi_gltf_array *a,
                              const unsigned char *raw, const cwi_gltf_block *b, cw_error *err)
{
    const float *positions = piece->part->mesh.positions;
    unsigned char *back = cwi_alloc_array((size_t)a->count, (size_t)a->stride);
    if (!back)
        return cwi_fail_memory(err);
    cw_status st = meshopt->decode_vertices(back, (size_t)a->count, (size_t)a->stride, b->bytes,
                                            b->size, err);
    bool same = st == CW_OK && memcmp(raw, back, (size_t)(a->count * a->stride)) == 0;
    if (same && a->exponential)
        same = are_stored(meshopt, plan, positions, back, (size_t)a->count);
    if (st == CW_OK && !same)
        st = cwi_fail(err, CW_ERR_CHECK, "the decoded vertices are not those encoded");
    cwi_free(back);
    return st;
}

static cw_status check_triangles(const cwi_meshopt_functions *meshopt, const cw_mesh *m,
                                 const cwi_gltf_block *b, cw_error *err)
{
    const size_t count = 3 * m->triangle_count;
    uint32_t *back = cwi_alloc_array(count, sizeof *back);
    if (!back)
        return cwi_fail_memory(err);
    cw_status st = meshopt->decode_triangles(back, count, 4, b->bytes, b->size, err);
    for (size_t t = 0; st == CW_OK && t < count; t += 3) {
        const uint32_t *was = m->triangles + t;
        int k = 0;
        while (k < 3 && (back[t] != was[k] || back[t + 1] != was[(k + 1) % 3] ||
                         back[t + 2] != was[(k + 2) % 3]))
            k++;
        if (k == 3)
            st = cwi_fail(err, CW_ERR_CHECK, "decoded triangle %zu is not the one encoded",
                          t / 3);
    }
    cwi_free(back);
    return st;
}

static cw_status pack_array(cwi_gltf_plan *plan, cwi_gltf_piece *piece, cwi_gltf_array *a,
                            const cwi_meshopt_functions *meshopt, cw_error *err)
{
    const cw_mesh *m = &piece->part->mesh;
    const bool indices = a->use == CWI_GLTF_INDICES;
    cwi_gltf_block b = {0};
    unsigned char *raw = NULL;
    cw_status st = CW_OK;
    if (indices) {
        st = meshopt->encode_triangles(m->triangles, m->triangle_count, m->vertex_count,
                                       &b.bytes, &b.size, err);
    } else {
        raw = cwi_alloc_array((size_t)a->count, (size_t)a->stride);
        st = raw ? CW_OK : cwi_fail_memory(err);
        for (size_t i = 0; raw && i < a->count; i++)
            cwi_gltf_put(plan, piece, a, i, raw + i * a->stride);
        if (st == CW_OK)
            st = meshopt->encode_vertices(raw, (size_t)a->count, (size_t)a->stride, &b.bytes,
                                          &b.size, err);
    }
    if (st == CW_OK)
        st = indices ? check_triangles(meshopt, m, &b, err)
                     : check_packed(meshopt, plan, piece, a, raw, &b, err);
    cwi_free(raw);
    if (st != CW_OK) {
        cwi_free(b.bytes);
        return st;
    }
    a->packed = b.size;
    return add_block(plan, b.bytes, b.size, &a->packed_at, err);
}

static cw_status compress_meshopt(cwi_gltf_plan *plan, size_t p,
                                  const cwi_meshopt_functions *meshopt, cw_error *err)
{
    cwi_gltf_piece *piece = &plan->pieces[p];
    cw_status st = cwi_mesh_reorder(&plan->own[p], meshopt, false, err);
    if (st == CW_OK)
        st = cwi_gltf_add_tangents(piece, err);
    if (st == CW_OK)
        cwi_gltf_plan_arrays(plan, piece);
    for (size_t n = 0; st == CW_OK && n < piece->array_count; n++)
        st = pack_array(plan, piece, &piece->arrays[n], meshopt, err);
    plan->document.unpacked = 1; /* its size is counted later */
    return st;
}

/* Measures the error of normals in bytes: besides positions, only they are moved by
 * quantising. */
static void measure_normals(const cwi_gltf_plan *plan, cw_compressed *facts)
{
    for (size_t p = 0; p < plan->parts.count; p++) {
        const cw_mesh *m = &plan->parts.items[p].mesh;
        for (size_t v = 0; m->normals && v < m->vertex_count; v++) {
            double is[3], was[3], cosine = 0, lengths[2] = {0, 0};
            for (int a = 0; a < 3; a++) {
                was[a] = (double)m->normals[3 * v + (size_t)a];
                is[a] = rint(127 * fmax(-1, fmin(1, was[a])));
                cosine += was[a] * is[a];
                lengths[0] += was[a] * was[a];
                lengths[1] += is[a] * is[a];
            }
            const double c = cosine / sqrt(lengths[0] * lengths[1]);
            facts->normal_degrees =
                fmax(facts->normal_degrees, c < 1 ? acos(c) * 180 / CWI_PI : 0);
        }
    }
}

/* --- all ---------------------------------------------------------------------------------- */

static cw_status compress_pieces(cwi_gltf_plan *plan, const cw_write_desc *desc,
                                 cw_compressed *facts, cw_error *err)
{
    const bool draco = desc->compression == CW_COMPRESS_DRACO;
    const cwi_meshopt_functions *by_meshopt = NULL;
    const double start = cwi_now_s();
    cw_status st = draco ? CW_OK : cwi_meshopt_functions_load(&by_meshopt, err);
    for (size_t p = 0; st == CW_OK && p < plan->parts.count; p++)
        st = draco ? compress_draco(plan, &plan->pieces[p], desc, facts, err)
                   : compress_meshopt(plan, p, by_meshopt, err);
    if (!draco)
        facts->encode_s = cwi_now_s() - start;
    facts->bytes = plan->document.bytes;
    return st;
}

/* Keeps moved positions in the arrays of parts that are copies, which are put in another order together. */
static void own_positions(cwi_gltf_plan *plan)
{
    for (size_t p = 0; plan->settled && plan->own && p < plan->parts.count; p++) {
        cw_mesh *m = &plan->parts.items[p].mesh;
        memcpy(plan->own[p].positions, m->positions,
               3 * m->vertex_count * sizeof *m->positions);
        m->positions = plan->own[p].positions;
    }
}

cw_status cwi_gltf_compress(cwi_gltf_plan *plan, const cw_write_desc *desc, cw_error *err)
{
    const bool meshopt = desc->compression == CW_COMPRESS_MESHOPT;
    cw_compressed facts = {0};
    cw_status st = CW_OK;
    for (size_t p = 0; desc->compression == CW_COMPRESS_DRACO && p < plan->parts.count; p++)
        facts.dropped += cwi_draco_count_degenerate(&plan->parts.items[p].mesh);
    if (meshopt || facts.dropped || !same_origin(&plan->parts))
        st = own_parts(plan, meshopt, err);
    for (size_t p = 0; st == CW_OK && facts.dropped && p < plan->parts.count; p++)
        cwi_draco_drop_degenerate(&plan->parts.items[p].mesh);
    if (st == CW_OK)
        st = cwi_grid_choose(&plan->grid, &plan->parts, desc, &plan->settled, &facts, err);
    if (st != CW_OK)
        return st;
    own_positions(plan);
    plan->rounded = desc->compression != CW_COMPRESS_DRACO;
    if (plan->rounded)
        measure_normals(plan, &facts);
    if (desc->compression != CW_COMPRESS_QUANTIZE)
        st = compress_pieces(plan, desc, &facts, err);
    if (st == CW_OK && desc->compressed)
        *desc->compressed = facts;
    return st;
}
