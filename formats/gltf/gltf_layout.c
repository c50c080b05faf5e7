/* Lays out the arrays of a glTF file: accessors, their bytes, bounds and places in the
 * buffer. */
#include "core/geometry/box.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/gltf/gltf_pack.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/texture/split_seams.h"

#include <math.h>
#include <string.h>

/* The maximum of a buffer: GLB states lengths in 32 bits, and the JSON takes a part of that. */
static const uint64_t MAX_BYTES = UINT32_MAX - (1 << 20);

void cwi_gltf_plan_free(cwi_gltf_plan *plan)
{
    for (size_t i = 0; i < plan->block_count; i++)
        cwi_free(plan->blocks[i].bytes);
    for (size_t i = 0; plan->own && i < plan->parts.count; i++)
        cw_mesh_free(&plan->own[i]);
    for (size_t i = 0; plan->split && i < plan->parts.count; i++)
        cw_mesh_free(&plan->split[i]);
    for (size_t i = 0; plan->seamed && i < plan->parts.count; i++)
        cw_mesh_free(&plan->seamed[i]);
    for (size_t i = 0; plan->pieces && i < plan->parts.count; i++) {
        cwi_color_groups_free(&plan->pieces[i].groups);
        cwi_free(plan->pieces[i].tangents);
    }
    cwi_free(plan->document.images);
    cwi_free(plan->blocks);
    cwi_free(plan->keys);
    cwi_free(plan->own);
    cwi_free(plan->split);
    cwi_free(plan->settled);
    cwi_free(plan->seamed);
    cwi_free(plan->pieces);
    cwi_free(plan->parts.items);
    *plan = (cwi_gltf_plan){0};
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
    piece->step = cwi_gltf_on_grid(plan) && !g->dyadic ? g->step : 1;
    for (int a = 0; a < 3; a++) {
        piece->translation[a] = piece->part->mesh.origin[a];
        if (cwi_gltf_on_grid(plan))
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

/* --- colours -------------------------------------------------------------------------------- */

static double to_linear(double c)
{
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double to_srgb(double c)
{
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

/* Fills the tables from sRGB to linear colours, which glTF has; alpha is already linear. */
static void fill_linear(cwi_gltf_plan *plan)
{
    for (int i = 0; i < 256; i++) {
        const double linear = to_linear(i / 255.0), byte = (double)lround(255 * linear) / 255;
        plan->linear[i] = (uint16_t)lround(65535 * linear);
        plan->fits_byte[i] = lround(255 * to_srgb(byte)) == i;
    }
}

/* Returns true if colours of vertices must stand for those of triangles: where they are many, and where
 * a codec puts triangles in an order of its own. All of them white are vertices too, as a white
 * material is no colour to readers. */
static bool needs_split(const cwi_part *part, const cw_write_desc *desc)
{
    static const uint8_t white[4] = {255, 255, 255, 255};
    const size_t count = cwi_count_face_colors(part);
    if (count == 1)
        return memcmp(part->face_colors, white, sizeof white) == 0;
    return count > CWI_MAX_COLOR_GROUPS || desc->compression == CW_COMPRESS_DRACO ||
           desc->compression == CW_COMPRESS_MESHOPT;
}

/* Lets a part have the arrays of a mesh whose vertices are split, as far as it had them. */
static void take_arrays(cwi_part *part, const cw_mesh *split)
{
    cw_mesh *m = &part->mesh;
    m->vertex_count = split->vertex_count;
    m->positions = split->positions;
    m->triangles = split->triangles;
    m->normals = m->normals ? split->normals : NULL;
    m->colors = split->colors;
    m->attributes = split->attributes;
    m->attribute_count = split->attribute_count;
    part->texture = part->texture ? cwi_texture_of(split) : NULL;
}

/* Splits vertices at the seams of textures, and at creases. */
static cw_status split_at_seams(cwi_gltf_plan *plan, cw_error *err)
{
    cw_status st = CW_OK;
    plan->seamed = cwi_alloc_zeroed(plan->parts.count, sizeof *plan->seamed);
    if (!plan->seamed)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < plan->parts.count && st == CW_OK; p++) {
        cwi_part *part = &plan->parts.items[p];
        if (!part->corner_normals && !(part->texture && part->texture->on == CW_ON_CORNERS))
            continue;
        st = cwi_split_seams(&part->mesh, &plan->seamed[p], err);
        if (st == CW_OK)
            take_arrays(part, &plan->seamed[p]);
    }
    return st;
}

/* Splits vertices by colour. */
static cw_status split_part(cwi_part *part, cw_mesh *split, cw_error *err)
{
    cw_status st = cwi_split_by_color(part, split, err);
    if (st == CW_OK)
        take_arrays(part, split);
    return st;
}

/* Plans colours of triangles: as that of the part, as groups, or as colours of split vertices. */
static cw_status plan_colors(cwi_gltf_plan *plan, const cw_write_desc *desc, cw_error *err)
{
    cw_status st = CW_OK;
    plan->split = cwi_alloc_zeroed(plan->parts.count, sizeof *plan->split);
    if (!plan->split)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < plan->parts.count && st == CW_OK; p++) {
        cwi_part *part = &plan->parts.items[p];
        cwi_color_groups *groups = &plan->pieces[p].groups;
        if (!part->face_colors)
            continue;
        part->has_color = false;
        part->mesh.colors = NULL;
        if (needs_split(part, desc)) {
            st = split_part(part, &plan->split[p], err);
            continue;
        }
        st = cwi_group_faces(part, groups, err);
        if (st == CW_OK && groups->count == 1) {
            part->has_color = true;
            memcpy(part->color, groups->items->color, sizeof part->color);
            cwi_color_groups_free(groups);
        }
    }
    return st;
}

cw_status cwi_gltf_count_split(const cwi_parts *parts, const cw_write_desc *desc, size_t *added,
                               cw_error *err)
{
    cw_status st = CW_OK;
    *added = 0;
    for (size_t p = 0; p < parts->count && st == CW_OK; p++) {
        size_t more = 0;
        if (parts->items[p].face_colors && needs_split(&parts->items[p], desc))
            st = cwi_count_split(&parts->items[p], &more, err);
        *added += more;
    }
    return st;
}

/* --- pictures ------------------------------------------------------------------------------ */

/* Finds a picture among those of the document, or adds it. Returns its number, from 1 on; 0: there is none. */
static size_t find_image(cwi_gltf_document *d, const cw_texture *picture)
{
    size_t n = 0;
    if (!picture->bytes)
        return 0;
    while (n < d->image_count && d->images[n].file.bytes != picture->bytes)
        n++;
    if (n == d->image_count)
        d->images[d->image_count++].file = *picture;
    return n + 1;
}

/* Lists the pictures of materials, each once. */
static cw_status list_images(cwi_gltf_plan *plan, cw_error *err)
{
    cwi_gltf_document *d = &plan->document;
    d->images = cwi_alloc_zeroed(CWI_GLTF_PICTURES * plan->parts.count, sizeof *d->images);
    if (!d->images)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < plan->parts.count; p++) {
        const cw_textures *set = plan->parts.items[p].textures;
        cwi_gltf_piece *piece = &plan->pieces[p];
        if (!set)
            continue;
        const cw_texture *const pictures[CWI_GLTF_PICTURES] = {&set->normal, &set->color,
                                                               &set->metallic_roughness,
                                                               &set->occlusion, &set->emissive};
        for (int n = 0; n < CWI_GLTF_PICTURES; n++) {
            piece->images[n] = find_image(d, pictures[n]);
            piece->has_pictures = piece->has_pictures || piece->images[n];
        }
    }
    return CW_OK;
}

/* Places pictures behind everything else. */
static cw_status place_images(cwi_gltf_plan *plan, cw_error *err)
{
    cwi_gltf_document *d = &plan->document;
    for (size_t n = 0; n < d->image_count; n++) {
        d->images[n].at = d->bytes;
        d->bytes += (d->images[n].file.size + 3) / 4 * 4;
    }
    return d->bytes <= MAX_BYTES
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT, "glTF holds at most 4 GiB, with its pictures");
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
        if ((a->use == CWI_GLTF_POSITION || a->use == CWI_GLTF_NORMAL) &&
            a->component != CWI_GLTF_FLOAT)
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
    cw_status st = make_pieces(plan, parts, err);
    if (st == CW_OK)
        st = split_at_seams(plan, err);
    if (st == CW_OK)
        st = plan_colors(plan, out->desc, err);
    if (st == CW_OK)
        st = list_images(plan, err);
    if (st == CW_OK)
        st = check_vertices(&plan->parts, err);
    if (st != CW_OK)
        return st;
    fill_linear(plan);
    d->local_origin = out->local_origin;
    d->provenance = out->desc->provenance;
    d->provenance_count = out->desc->provenance_count;
    if (out->desc->compression != CW_COMPRESS_NONE)
        st = cwi_gltf_compress(plan, out->desc, err);
    for (size_t p = 0; st == CW_OK && p < parts->count; p++)
        if (!plan->pieces[p].array_count) { /* compressed pieces have theirs already */
            st = cwi_gltf_add_tangents(&plan->pieces[p], err);
            cwi_gltf_plan_arrays(plan, &plan->pieces[p]);
        }
    if (st == CW_OK)
        st = lay_out(plan, err);
    if (st == CW_OK)
        st = cwi_gltf_plan_animation(plan, err);
    if (st == CW_OK)
        st = place_images(plan, err);
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
