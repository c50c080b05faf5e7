/* Encodes a mesh by Draco, decodes it again, and verifies the result. */
#include "formats/codec/draco_pack.h"

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/codec/verify_decoded.h"

#include <string.h>

/* A place in the texture is kept to 1 / 2^14 of its side: an eighth of a texel of 2048. */
enum { NORMAL_BITS = 10, TEXTURE_BITS = 14, TANGENT_BITS = 10, LEVEL = 7 };

static bool names_a_vertex_twice(const uint32_t *triangle)
{
    return triangle[0] == triangle[1] || triangle[1] == triangle[2] ||
           triangle[2] == triangle[0];
}

size_t cwi_draco_count_degenerate(const cw_mesh *mesh)
{
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        count += names_a_vertex_twice(mesh->triangles + 3 * t);
    return count;
}

void cwi_draco_drop_degenerate(cw_mesh *mesh)
{
    size_t kept = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (!names_a_vertex_twice(mesh->triangles + 3 * t))
            memmove(mesh->triangles + 3 * kept++, mesh->triangles + 3 * t,
                    3 * sizeof(uint32_t));
    mesh->triangle_count = kept;
}

void cwi_draco_packed_free(cwi_draco_packed *packed)
{
    cwi_free(packed->bytes);
    cwi_arrays_free(&packed->decoded);
    *packed = (cwi_draco_packed){0};
}

/* Fails where Draco's table of symbols, of 4 bytes for each number of these bits, exceeds the limit
 * of memory. */
static cw_status expect_memory(int bits, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    const size_t left = cwi_memory_left(), needed = sizeof(int32_t) << bits;
    int fitting = bits;
    if (needed <= left)
        return CW_OK;
    while (fitting > 0 && sizeof(int32_t) << fitting > left)
        fitting--;
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(left, left_text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "%d bits a coordinate take up to %s while Draco encodes, and "
                    "cw_memory_limit() leaves %s; %d bits fit",
                    bits, needed_text, left_text, fitting);
}

static cw_status verify_decoded(const cw_mesh *mesh, const float *texture,
                                const float (*tangents)[4], const cwi_quantization_grid *grid,
                                const cwi_arrays *a, double *normal_degrees, cw_error *err)
{
    const cwi_decoded decoded = {.vertex_count = a->vertex_count,
                                 .triangle_count = a->triangle_count,
                                 .positions = a->positions,
                                 .grid_points = a->grid_points,
                                 .normals = a->normals,
                                 .texture = a->texture,
                                 .texture_encoded = texture,
                                 .texture_bits = TEXTURE_BITS,
                                 .tangents = a->tangents,
                                 .tangents_encoded = (const float *)tangents,
                                 .triangles = a->triangles};
    return cwi_verify(mesh, grid, &decoded, normal_degrees, err);
}

cw_status cwi_draco_pack(const cw_mesh *mesh, const uint8_t *colors, const float *texture,
                         const float (*tangents)[4], const cwi_quantization_grid *grid,
                         const char *comment, const cw_write_desc *desc,
                         cwi_draco_packed *packed, cw_compressed *facts, cw_error *err)
{
    const cwi_draco_functions *draco;
    const cwi_arrays arrays = {.vertex_count = mesh->vertex_count,
                               .triangle_count = mesh->triangle_count,
                               .positions = mesh->positions,
                               .normals = mesh->normals,
                               .colors = (uint8_t *)(uintptr_t)colors,
                               .texture = (float *)(uintptr_t)texture,
                               .tangents = (float *)(uintptr_t)tangents,
                               .triangles = mesh->triangles};
    const cwi_draco_settings settings = {.grid = *grid,
                                         .normal_bits = NORMAL_BITS,
                                         .texture_bits = TEXTURE_BITS,
                                         .tangent_bits = TANGENT_BITS,
                                         .level = desc->level ? desc->level : LEVEL,
                                         .comment = comment};
    const double start = cwi_now_s();
    *packed = (cwi_draco_packed){0};
    cw_status st = cwi_draco_functions_load(&draco, err);
    if (st == CW_OK && grid->bits)
        st = expect_memory(grid->bits, err);
    if (st == CW_OK)
        st =
            draco->encode(&arrays, &settings, &packed->bytes, &packed->size, &packed->ids, err);
    const double encoded = cwi_now_s();
    if (st == CW_OK)
        st = draco->decode(packed->bytes, packed->size, &packed->ids, SIZE_MAX,
                           grid->bits ? grid : NULL, &packed->decoded, err);
    if (st == CW_OK)
        st = verify_decoded(mesh, texture, tangents, grid, &packed->decoded,
                            &facts->normal_degrees, err);
    facts->encode_s += encoded - start;
    facts->decode_s += cwi_now_s() - encoded;
    return st;
}

/* Copies positions as integers; NULL: no memory. */
static uint32_t *copy_integers(const float *positions, size_t vertex_count)
{
    uint32_t *integers = cwi_alloc_array(vertex_count, 3 * sizeof *integers);
    for (size_t i = 0; integers && i < 3 * vertex_count; i++)
        integers[i] = positions[i] > 0 ? (uint32_t)positions[i] : 0;
    return integers;
}

static cw_status verify_integers(const cw_mesh *mesh, int bits, cwi_arrays *decoded,
                                 cw_error *err)
{
    double no_normals = 0;
    const cwi_quantization_grid grid = {
        .range = (float)((1u << bits) - 1), .bits = bits, .step = 1};
    decoded->grid_points = copy_integers(decoded->positions, decoded->vertex_count);
    return decoded->grid_points
               ? verify_decoded(mesh, NULL, NULL, &grid, decoded, &no_normals, err)
               : cwi_fail_memory(err);
}

cw_status cwi_draco_pack_integers(const cw_mesh *mesh, int bits, const cw_write_desc *desc,
                                  cwi_draco_packed *packed, cw_compressed *facts, cw_error *err)
{
    const cwi_draco_functions *draco;
    const cwi_draco_settings settings = {.level = desc->level ? desc->level : LEVEL};
    const double start = cwi_now_s();
    *packed = (cwi_draco_packed){0};
    cw_status st = cwi_draco_functions_load(&draco, err);
    const cwi_arrays arrays = {.vertex_count = mesh->vertex_count,
                               .triangle_count = mesh->triangle_count,
                               .grid_points =
                                   copy_integers(mesh->positions, mesh->vertex_count),
                               .triangles = mesh->triangles};
    if (st == CW_OK && !arrays.grid_points)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st =
            draco->encode(&arrays, &settings, &packed->bytes, &packed->size, &packed->ids, err);
    cwi_free(arrays.grid_points);
    const double encoded = cwi_now_s();
    if (st == CW_OK)
        st = draco->decode(packed->bytes, packed->size, &packed->ids, SIZE_MAX, NULL,
                           &packed->decoded, err);
    if (st == CW_OK)
        st = verify_integers(mesh, bits, &packed->decoded, err);
    cwi_arrays_free(&packed->decoded);
    facts->encode_s += encoded - start;
    facts->decode_s += cwi_now_s() - encoded;
    return st;
}
