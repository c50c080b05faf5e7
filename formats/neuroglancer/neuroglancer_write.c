/* Writes multi-resolution meshes of Neuroglancer: for each segment a manifest and the fragments
 * of its octree, which are Draco meshes with integer positions. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/lattice_map.h"
#include "formats/codec/draco_pack.h"
#include "formats/neuroglancer/neuroglancer_format.h"
#include "formats/neuroglancer/segment_store.h"

#include <math.h>
#include <string.h>

/* A node of a level, with the bytes of its fragment; 0: it only leads to finer nodes. */
typedef struct node_entry {
    uint32_t code, bytes;
} node_entry;

/* The nodes of a level, in rising order of codes. */
typedef struct level_nodes {
    node_entry *items;
    size_t count;
    double scale_mm; /* the length that viewers compare with a pixel */
} level_nodes;

typedef struct writer {
    const cwi_parts *parts;
    cwi_mesh_output *out;
    cwi_segment_store store;
    cwi_lod_grid grid;
    cw_compressed facts;
    uint64_t done; /* triangles, for progress */
} writer;

/* --- fragments --------------------------------------------------------------------------- */

/* Gives the corners of a node's triangles numbers of lattice points, counted from the node's corner. */
static cw_status number_corners(const writer *w, const cwi_lod_level *level, size_t first,
                                cwi_lattice_map *points, cw_mesh *mesh, cw_error *err)
{
    uint32_t node[3], at[3];
    cwi_lod_node(level->pieces[first].node, node);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const uint32_t vertex = level->pieces[first + i / 3].vertex[i % 3];
        for (int a = 0; a < 3; a++)
            at[a] = level->positions[3 * (size_t)vertex + (size_t)a] -
                    node[a] * cwi_lod_steps(&w->grid);
        mesh->triangles[i] = cwi_lattice_add(points, cwi_lattice_key(at));
        if (mesh->triangles[i] == CWI_NO_LATTICE_POINT)
            return cwi_fail_memory(err);
    }
    return CW_OK;
}

/* Copies the points that triangles name as positions, and numbers them in the order in which
 * triangles name them. */
static cw_status place_vertices(const cwi_lattice_map *points, cw_mesh *mesh, cw_error *err)
{
    cwi_lattice_map used = {0};
    uint32_t at[3];
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        mesh->triangles[i] = cwi_lattice_add(&used, points->keys[mesh->triangles[i]]);
        if (mesh->triangles[i] == CWI_NO_LATTICE_POINT) {
            cwi_lattice_free(&used);
            return cwi_fail_memory(err);
        }
    }
    mesh->vertex_count = used.count;
    mesh->positions = cwi_alloc_array(used.count, 3 * sizeof *mesh->positions);
    for (size_t v = 0; v < used.count && mesh->positions; v++) {
        cwi_lattice_point(used.keys[v], at);
        for (size_t a = 0; a < 3; a++)
            mesh->positions[3 * v + a] = (float)at[a];
    }
    cwi_lattice_free(&used);
    return mesh->positions ? CW_OK : cwi_fail_memory(err);
}

/* Makes the mesh of the pieces of one node. It has no triangles if all of them cancel out. */
static cw_status make_fragment(const writer *w, const cwi_lod_level *level, size_t first,
                               size_t count, cw_mesh *mesh, cw_error *err)
{
    cwi_lattice_map points = {0};
    mesh->triangle_count = count;
    mesh->triangles = cwi_alloc_array(count, 3 * sizeof *mesh->triangles);
    cw_status st = mesh->triangles ? number_corners(w, level, first, &points, mesh, err)
                                   : cwi_fail_memory(err);
    if (st == CW_OK && !cwi_lod_cancel(mesh, points.keys))
        st = cwi_fail_memory(err);
    if (st == CW_OK && mesh->triangle_count)
        st = place_vertices(&points, mesh, err);
    cwi_lattice_free(&points);
    return st;
}

/* Appends the fragment of one node to the segment; *bytes is 0 if nothing is left of
 * it. */
static cw_status write_fragment(writer *w, const cwi_lod_level *level, size_t first,
                                size_t count, uint32_t *bytes, cw_error *err)
{
    cw_mesh mesh = {0};
    cwi_draco_packed packed = {0};
    cw_status st = cwi_progress(w->out->progress, "writing",
                                (double)w->done / (double)w->parts->triangles, err);
    if (st == CW_OK)
        st = make_fragment(w, level, first, count, &mesh, err);
    if (st == CW_OK && mesh.triangle_count)
        st =
            cwi_draco_pack_integers(&mesh, w->grid.bits, w->out->desc, &packed, &w->facts, err);
    if (st == CW_OK && packed.size > UINT32_MAX)
        st = cwi_fail(err, CW_ERR_LIMIT, "a fragment has more than 4 GiB");
    if (st == CW_OK && packed.size)
        st = cwi_segment_append(&w->store, packed.bytes, packed.size, err);
    *bytes = (uint32_t)packed.size;
    w->facts.fragments += packed.size > 0;
    cwi_draco_packed_free(&packed);
    cw_mesh_free(&mesh);
    return st;
}

/* --- levels ------------------------------------------------------------------------------ */

static size_t count_nodes(const cwi_lod_level *level)
{
    size_t count = 0;
    for (size_t i = 0; i < level->piece_count; i++)
        count += i == 0 || level->pieces[i].node != level->pieces[i - 1].node;
    return count;
}

/* Writes the fragments of a level. */
static cw_status write_nodes(writer *w, const cwi_lod_level *level, const cwi_part *part,
                             level_nodes *nodes, cw_error *err)
{
    cw_status st = CW_OK;
    nodes->items = cwi_alloc_array(count_nodes(level), sizeof *nodes->items);
    if (!nodes->items)
        return cwi_fail_memory(err);
    const uint64_t before = w->done;
    for (size_t i = 0, end; i < level->piece_count && st == CW_OK; i = end) {
        node_entry *entry = &nodes->items[nodes->count];
        entry->code = level->pieces[i].node;
        for (end = i + 1; end < level->piece_count && level->pieces[end].node == entry->code;)
            end++;
        st = write_fragment(w, level, i, end - i, &entry->bytes, err);
        nodes->count += entry->bytes > 0;
        w->done = before + (uint64_t)((double)end / (double)level->piece_count *
                                      (double)part->mesh.triangle_count);
    }
    return st;
}

/* Adds nodes without a fragment above finer nodes that have none: viewers descend from parents
 * alone. Simplified surfaces may leave a node that finer levels touch. */
static cw_status add_parents(const level_nodes *finer, level_nodes *nodes, cw_error *err)
{
    size_t count = 0, own = 0;
    node_entry *all = cwi_alloc_array(finer->count + nodes->count, sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    for (size_t i = 0; i < finer->count; i++) {
        const uint32_t parent = finer->items[i].code >> 3;
        while (own < nodes->count && nodes->items[own].code <= parent)
            all[count++] = nodes->items[own++];
        if (count == 0 || all[count - 1].code != parent)
            all[count++] = (node_entry){.code = parent};
    }
    while (own < nodes->count)
        all[count++] = nodes->items[own++];
    cwi_free(nodes->items);
    nodes->items = all;
    nodes->count = count;
    return CW_OK;
}

static void tell_finest(writer *w, const cwi_lod_level *level)
{
    const double cut_mm =
        level->is_cut ? (CWI_LOD_ERROR_STEPS - sqrt(3) / 2) * w->grid.step_mm : 0;
    w->facts.dropped += level->collapsed;
    w->facts.error_mm = fmax(w->facts.error_mm, level->move_mm + cut_mm);
}

/* Writes a level. Its nodes stay empty if the lattice leaves no triangle of it. */
static cw_status write_level(writer *w, const cwi_part *part, const level_nodes *finer,
                             level_nodes *nodes, cw_error *err)
{
    cwi_lod_level level;
    cw_status st = cwi_lod_cut(&w->grid, part, &level, err);
    if (st != CW_OK)
        return st;
    if (part->level == 0)
        tell_finest(w, &level);
    if (st == CW_OK && level.piece_count)
        st = write_nodes(w, &level, part, nodes, err);
    if (st == CW_OK && part->level == 0 && !nodes->count)
        st = cwi_fail(err, CW_ERR_CHECK,
                      "'%s' is smaller than the steps of %.3g mm; a smaller tolerance keeps it",
                      part->name, w->grid.step_mm);
    nodes->scale_mm = fmax(cwi_mean_edge(part), ldexp(w->grid.step_mm, (int)part->level));
    if (finer)
        nodes->scale_mm = fmax(nodes->scale_mm, finer->scale_mm);
    if (st == CW_OK && finer && nodes->count)
        st = add_parents(finer, nodes, err);
    cwi_lod_free(&level);
    return st;
}

/* --- manifests --------------------------------------------------------------------------- */

static unsigned char *put_nodes(unsigned char *to, const level_nodes *nodes)
{
    for (size_t a = 0; a < 3; a++)
        for (size_t n = 0; n < nodes->count; n++) {
            uint32_t at[3];
            cwi_lod_node(nodes->items[n].code, at);
            to = cwi_put_u32(to, at[a]);
        }
    for (size_t n = 0; n < nodes->count; n++)
        to = cwi_put_u32(to, nodes->items[n].bytes);
    return to;
}

/* Ends a segment with its manifest. */
static cw_status write_manifest(writer *w, uint64_t id, const level_nodes *levels, size_t count,
                                cw_error *err)
{
    static const float zeros[3] = {0};
    const float edge = (float)(w->grid.step_mm * cwi_lod_steps(&w->grid));
    const float shape[3] = {edge, edge, edge};
    size_t words = 7 + 5 * count;
    for (size_t l = 0; l < count; l++)
        words += 4 * levels[l].count;
    unsigned char *bytes = cwi_alloc_array(words, 4), *to = bytes;
    if (!bytes)
        return cwi_fail_memory(err);
    to = cwi_put_f32x3(to, shape);
    to = cwi_put_f32x3(to, zeros); /* the origin is in the transform, in double precision */
    to = cwi_put_u32(to, (uint32_t)count);
    for (size_t l = 0; l < count; l++)
        to = cwi_put_f32(to, (float)levels[l].scale_mm);
    for (size_t l = 0; l < count; l++)
        to = cwi_put_f32x3(to, zeros);
    for (size_t l = 0; l < count; l++)
        to = cwi_put_u32(to, (uint32_t)levels[l].count);
    for (size_t l = 0; l < count; l++)
        to = put_nodes(to, &levels[l]);
    cw_status st = cwi_segment_end(&w->store, id, bytes, (size_t)(to - bytes), err);
    cwi_free(bytes);
    return st;
}

/* Writes a segment. Levels from the first one on that the lattice leaves nothing of are left
 * out. */
static cw_status write_segment(writer *w, const cwi_segment *segment, cw_error *err)
{
    size_t count = 0;
    level_nodes *levels = cwi_alloc_zeroed(segment->level_count, sizeof *levels);
    if (!levels)
        return cwi_fail_memory(err);
    cw_status st = cwi_segment_begin(&w->store, segment->id, err);
    for (size_t l = 0; l < segment->level_count && st == CW_OK && count == l; l++) {
        st = write_level(w, &segment->levels[l], l ? &levels[l - 1] : NULL, &levels[l], err);
        count += levels[l].count > 0;
    }
    if (st == CW_OK)
        st = write_manifest(w, segment->id, levels, count, err);
    for (size_t l = 0; l < segment->level_count; l++)
        cwi_free(levels[l].items);
    cwi_free(levels);
    return st;
}

cw_status cwi_neuroglancer_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    writer w = {.parts = parts, .out = out};
    cwi_segments segments = {0};
    size_t *order = NULL;
    cw_status st = cwi_segments_list(parts, &segments, err);
    if (st == CW_OK)
        st = cwi_lod_choose(&w.grid, parts, segments.max_levels, out->desc, err);
    w.facts.bits = w.grid.bits;
    w.facts.step_mm = w.grid.step_mm;
    if (st == CW_OK)
        st = cwi_segment_store_open(&w.store, out->folder, &segments, parts->triangles, &order,
                                    err);
    for (size_t n = 0; n < segments.count && st == CW_OK; n++)
        st = write_segment(&w, &segments.items[order[n]], err);
    if (st == CW_OK)
        st = cwi_segment_store_finish(&w.store, err);
    if (st == CW_OK)
        st = cwi_segment_properties_write(out->folder, &segments, err);
    if (st == CW_OK)
        st = cwi_mesh_info_write(out->folder, &w.grid, &w.store.bits, err);
    cwi_segment_store_close(&w.store);
    cwi_free(order);
    cwi_segments_free(&segments);
    w.facts.bytes = out->folder ? cwi_outfolder_size(out->folder) : 0;
    if (st == CW_OK && out->desc->compressed)
        *out->desc->compressed = w.facts;
    return st;
}
