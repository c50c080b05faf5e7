/* Reads OpenVDB files: level sets, fog volumes and other grids of one number per voxel, as
 * sparse grids. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "formats/vdb/vdb.h"
#include "formats/vdb/vdb_format.h"
#include "formats/volume/named_arrays.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool cwi_vdb_sniff(const unsigned char *head, size_t size)
{
    return size >= 8 && memcmp(head, " BDV\0\0\0\0", 8) == 0;
}

/* --- the grid ----------------------------------------------------------------------------- */

/* Makes untrusted text printable. */
static void clean_text(char *text, size_t capacity)
{
    text[capacity - 1] = '\0';
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < ' ' || (unsigned char)*c == 127)
            *c = '?';
}

static cw_status take_facts(cwi_planes *planes, const cwi_input *in, cwi_vdb_facts *facts,
                            cw_error *err)
{
    const void *shared;
    cw_status st = cwi_planes_facts(planes, in->fd, in->size, &shared, err);
    if (st != CW_OK)
        return st;
    memcpy(facts, shared, sizeof *facts);
    if (facts->grid_count > CWI_VDB_MAX_GRIDS)
        return cwi_fail(err, CW_ERR_LIMIT, "it has %u grids; at most %d were expected",
                        facts->grid_count, CWI_VDB_MAX_GRIDS);
    for (cwi_vdb_grid *g = facts->grid; g < facts->grid + facts->grid_count; g++) {
        clean_text(g->name, sizeof g->name);
        clean_text(g->kind, sizeof g->kind);
        clean_text(g->refusal, sizeof g->refusal);
    }
    return CW_OK;
}

/* Lists the names of grids, as far as they fit: "'density', 'temperature'". */
static const char *list_names(const cwi_vdb_facts *f, char text[256])
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t n = 0; n < f->grid_count && used < 256; n++)
        used +=
            (size_t)snprintf(text + used, 256 - used, "%s'%s'", n ? ", " : "", f->grid[n].name);
    return text;
}

/* Chooses the grid of a name, or the first level set, else the first that can be read. */
static cw_status choose_grid(const cwi_vdb_facts *f, const char *name, size_t *chosen,
                             cw_error *err)
{
    char names[256];
    size_t best = f->grid_count;
    for (size_t n = 0; n < f->grid_count; n++) {
        const cwi_vdb_grid *g = &f->grid[n];
        if (name ? strcmp(g->name, name) == 0
                 : !g->refusal[0] &&
                       (best == f->grid_count || (g->level_set && !f->grid[best].level_set))) {
            best = n;
            if (name)
                break;
        }
    }
    *chosen = best;
    if (best < f->grid_count && f->grid[best].refusal[0])
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "grid '%s': %s", f->grid[best].name,
                        f->grid[best].refusal);
    if (best < f->grid_count)
        return CW_OK;
    if (!name && f->grid_count == 1)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "grid '%s': %s", f->grid[0].name,
                        f->grid[0].refusal);
    return name ? cwi_fail(err, CW_ERR_ARGUMENT, "there is no grid '%s'; there are %s", name,
                           list_names(f, names))
                : cwi_fail(err, CW_ERR_FORMAT, "none of its grids can be read: %s",
                           f->grid_count ? list_names(f, names) : "it has none");
}

static void list_grids(const cwi_vdb_facts *f, size_t chosen, cwi_array_list *list)
{
    for (size_t n = 0; n < f->grid_count; n++) {
        const cwi_vdb_grid *g = &f->grid[n];
        cwi_array_list_add(list, g->name, g->refusal[0] ? "" : cw_type_name(g->type), 1, false,
                           !g->refusal[0]);
    }
    cwi_array_list_choose(list, f->grid[chosen].name, false);
}

static void tell_choice(const cw_read_desc *desc, const cwi_vdb_facts *f, const cwi_vdb_grid *g)
{
    char names[256];
    cwi_note(desc,
             "grid '%s'%s%s%s: %llu active voxels in %llu leaves and %llu tiles, background %g",
             g->name, g->kind[0] ? ", " : "", g->kind, g->half ? ", of half floats" : "",
             (unsigned long long)g->active, (unsigned long long)g->leaf_count,
             (unsigned long long)g->tile_count, g->background);
    if (f->grid_count > 1)
        cwi_note(desc, "it has %u grids: %s (desc->array names one)", f->grid_count,
                 list_names(f, names));
}

/* --- the volume --------------------------------------------------------------------------- */

/* Checks the counts. Each leaf has a mask of 64 bytes in the file, even if its voxels are well
 * compressed. */
static cw_status check_counts(const cwi_vdb_grid *g, uint64_t file_bytes,
                              const cw_read_desc *desc, cw_error *err)
{
    const uint64_t leaf = CWI_LEAF_VOXELS * cw_type_size(g->type);
    if (g->type != CW_F32 && g->type != CW_F64 && g->type != CW_I32 && g->type != CW_U8)
        return cwi_fail(err, CW_ERR_FORMAT, "grid '%s' is of an unknown type", g->name);
    if (g->leaf_count > file_bytes / 64 || g->tile_count > file_bytes * 64)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "grid '%s' has %llu leaves and %llu tiles, more than %llu bytes hold",
                        g->name, (unsigned long long)g->leaf_count,
                        (unsigned long long)g->tile_count, (unsigned long long)file_bytes);
    const uint64_t bytes = g->leaf_count * (leaf + 12) + g->tile_count * sizeof(cw_tile);
    if (desc->max_voxels && g->leaf_count * CWI_LEAF_VOXELS > desc->max_voxels)
        return cwi_fail(err, CW_ERR_LIMIT, "grid '%s' keeps %llu voxels; the limit is %llu",
                        g->name, (unsigned long long)(g->leaf_count * CWI_LEAF_VOXELS),
                        (unsigned long long)desc->max_voxels);
    if (desc->max_bytes && bytes > desc->max_bytes) {
        char needed[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
        cwi_print_memory(bytes, needed);
        cwi_print_memory(desc->max_bytes, limit);
        return cwi_fail(err, CW_ERR_LIMIT,
                        "grid '%s' needs %s; the limit is %s (desc->max_bytes)", g->name,
                        needed, limit);
    }
    return CW_OK;
}

/* Sets the shape of the volume. Voxel 0 is the first of the first leaf. */
static cw_status set_shape(const cwi_vdb_grid *g, const cw_read_desc *desc, cw_volume *v,
                           cw_error *err)
{
    *v = (cw_volume){.type = g->type, .components = 1, .steps = 1, .slope = 1};
    double first[3], corner[3];
    for (int a = 0; a < 3; a++) {
        const int64_t n = g->high[a] - g->low[a] + 1;
        if (n > 0 && (g->low[a] < INT32_MIN / 8 || g->high[a] > INT32_MAX / 8))
            return cwi_fail(err, CW_ERR_FORMAT, "grid '%s' reaches beyond index %d", g->name,
                            INT32_MAX);
        v->dim[a] = CWI_LEAF * (size_t)(n > 0 ? n : 1);
        first[a] = (double)(n > 0 ? g->low[a] * CWI_LEAF : 0);
    }
    memcpy(v->affine, g->affine, sizeof v->affine);
    cwi_affine_apply(g->affine[0], first, corner);
    for (int r = 0; r < 3; r++)
        v->affine[r][3] = corner[r];
    v->known = g->level_set ? CW_KNOWN_LEVEL_SET : 0;
    cw_status st = cwi_check_frame(v, "transform", err);
    if (st == CW_OK)
        cwi_set_spacing(v, desc);
    return st;
}

/* Allocates the description of the grid as the volume's own memory; for a header only the
 * counts. */
static cw_status make_grid(const cwi_vdb_grid *g, bool header, cw_volume *v, cw_error *err)
{
    const size_t leaves = header ? 0 : g->leaf_count, tiles = header ? 0 : g->tile_count;
    char *memory = cwi_alloc_array(
        sizeof(cw_sparse) + tiles * sizeof(cw_tile) + leaves * sizeof(uint32_t[3]), 1);
    v->owned_grid = memory;
    if (!memory)
        return cwi_fail_memory(err);
    cw_sparse *s = v->owned_grid;
    s->leaf_count = g->leaf_count;
    s->tile_count = g->tile_count;
    s->background = g->background;
    s->tiles = header ? NULL : (cw_tile *)(void *)(s + 1);
    s->leaves = header ? NULL : (const uint32_t(*)[3])(const void *)(s->tiles + tiles);
    v->sparse = s;
    return CW_OK;
}

static cw_status read_grid(cwi_planes *planes, uint32_t plane, cw_volume *v, cw_error *err)
{
    const cw_sparse *s = v->sparse;
    cw_status st = cwi_planes_read(planes, plane + CWI_VDB_LEAVES, 0, s->leaf_count,
                                   sizeof *s->leaves, (void *)(uintptr_t)s->leaves, err);
    return st == CW_OK ? cwi_planes_read(planes, plane + CWI_VDB_TILES, 0, s->tile_count,
                                         sizeof *s->tiles, (void *)(uintptr_t)s->tiles, err)
                       : st;
}

static cw_status read_voxels(cwi_planes *planes, uint32_t plane, cw_volume *v, cw_error *err)
{
    const size_t count = v->sparse->leaf_count, leaf = CWI_LEAF_VOXELS * cw_type_size(v->type);
    v->data = v->owned = cwi_alloc_large(count, leaf);
    return v->owned
               ? cwi_planes_read(planes, plane + CWI_VDB_VOXELS, 0, count, leaf, v->owned, err)
               : cwi_fail_memory(err);
}

static cw_status read_chosen(cwi_planes *planes, const cwi_input *in, const cwi_vdb_facts *f,
                             const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    size_t number = 0;
    cw_volume v = {0};
    cw_status st = choose_grid(f, desc->array, &number, err);
    const cwi_vdb_grid *g = &f->grid[number];
    const uint32_t plane = (uint32_t)number * CWI_VDB_PLANES;
    if (st == CW_OK)
        st = check_counts(g, in->size, desc, err);
    if (st == CW_OK)
        st = set_shape(g, desc, &v, err);
    if (st == CW_OK && in->arrays)
        list_grids(f, number, in->arrays);
    if (st == CW_OK)
        tell_choice(desc, f, g);
    if (st == CW_OK)
        st = make_grid(g, desc->header_only, &v, err);
    if (st == CW_OK && desc->region)
        st = cwi_volume_expect_dense(&v, "a crop", err);
    if (st == CW_OK && !desc->header_only)
        st = read_grid(planes, plane, &v, err);
    if (st == CW_OK && !desc->header_only)
        st = read_voxels(planes, plane, &v, err);
    if (st == CW_OK)
        *volume = v;
    else
        cw_volume_free(&v);
    return st;
}

/* Returns the maximum memory that the library may allocate for a file, whatever its numbers
 * claim. A leaf has a mask of 64 bytes in the file and up to 4,200 bytes in memory. A node has
 * masks of 8 KiB, and up to 32,768 tiles of 40 bytes, kept twice while they grow. */
static uint64_t max_memory(uint64_t file_bytes)
{
    const uint64_t BASE_BYTES = (uint64_t)128 << 20, BYTES_PER_FILE_BYTE = 512;
    return file_bytes < (UINT64_MAX - BASE_BYTES) / BYTES_PER_FILE_BYTE
               ? BASE_BYTES + BYTES_PER_FILE_BYTE * file_bytes
               : UINT64_MAX;
}

/* Reports a damaged file if the memory ran out only because of that limit. */
static cw_status judge_memory(cw_status st, uint64_t limit, uint64_t file_bytes, cw_error *err)
{
    if (st != CW_ERR_NO_MEMORY || limit != max_memory(file_bytes) || cwi_memory_is_limited())
        return st;
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "it asks OpenVDB for more than %llu MB of memory, which no file of %llu bytes "
        "needs; it is damaged or hostile",
        (unsigned long long)(limit >> 20), (unsigned long long)file_bytes);
}

cw_status cwi_vdb_read(const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                       cw_error *err)
{
    cwi_planes planes = {0};
    cwi_vdb_facts *facts = cwi_alloc_array(1, sizeof *facts);
    const uint64_t stated = desc->max_bytes ? desc->max_bytes : CWI_SANDBOX_MEMORY;
    const uint64_t max = max_memory(in->size);
    cw_read_desc boxed = *desc;
    boxed.max_bytes = max < stated ? max : stated;
    cw_status st = facts ? cwi_planes_open(&planes, "openvdb", "OpenVDB", &boxed, err)
                         : cwi_fail_memory(err);
    if (st == CW_OK)
        st = judge_memory(take_facts(&planes, in, facts, err), boxed.max_bytes, in->size, err);
    if (st == CW_OK)
        st = read_chosen(&planes, in, facts, desc, volume, err);
    cwi_planes_close(&planes);
    cwi_free(facts);
    return st;
}
