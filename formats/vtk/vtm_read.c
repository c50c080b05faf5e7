/* Reads VTK's lists of data sets (.vtm): surfaces as parts of a mesh, or one of the volumes. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/volume/named_arrays.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/vtk_blocks.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtp.h"

#include <stdio.h>
#include <string.h>

bool cwi_vtm_sniff(const unsigned char *head, size_t size)
{
    return cwi_vtk_blocks_sniff(head, size);
}

bool cwi_vtm_mesh_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return cwi_vtk_blocks_sniff(head, size);
}

/* --- surfaces ---------------------------------------------------------------------------- */

/* Says that blocks which are volumes are left out. */
static void tell_volumes(const cwi_vtk_blocks *b, cw_mesh_file *metadata)
{
    const size_t count = cwi_vtk_blocks_count(b, false);
    char text[100];
    size_t n = 0;
    while (n < b->count && b->items[n].kind == CWI_VTK_BLOCK_SURFACE)
        n++;
    if (count)
        snprintf(text, sizeof text, "blocks that are volumes: %zu, such as '%.40s'", count,
                 b->paths.items[n]);
    cwi_say_left_out(metadata, count > 0, text);
}

/* Parses the files of all surfaces. The pieces of a block are one group. */
static cw_status parse_surfaces(cwi_vtk_blocks *b, cwi_vtp *v, cw_error *err)
{
    const cwi_input *in;
    cw_status st = CW_OK;
    v->is_side = true;
    for (size_t n = 0; n < b->count && st == CW_OK; n++)
        for (size_t k = 0;
             b->items[n].kind == CWI_VTK_BLOCK_SURFACE && k < b->items[n].count && st == CW_OK;
             k++) {
            const size_t file = b->items[n].first + k;
            st = cwi_vtk_sides_open(&b->sides, file, &in, err);
            if (st != CW_OK)
                break;
            st = cwi_vtp_parse(v, in, file, (uint32_t)n, err);
            st = st == CW_OK ? st : cwi_fail_in(err, st, b->files.items[file]);
        }
    return st;
}

cw_status cwi_vtm_read_mesh(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                            cw_error *err)
{
    cwi_vtk_blocks b = {0};
    cwi_vtp v = {0};
    cw_status st = cwi_vtk_blocks_read(&in->file, &b, err);
    if (st == CW_OK && !cwi_vtk_blocks_count(&b, true))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "its blocks are volumes, such as '%.100s'; 'extract' makes a mesh of one",
                      b.paths.items[0]);
    if (st == CW_OK)
        st = parse_surfaces(&b, &v, err);
    if (st == CW_OK)
        st = cwi_vtp_load(&v, &b.sides, b.bytes, &b.paths, in, mesh, metadata, err);
    if (st == CW_OK)
        tell_volumes(&b, metadata);
    cwi_vtp_free(&v);
    cwi_vtk_blocks_free(&b);
    return st;
}

/* --- volumes ----------------------------------------------------------------------------- */

static bool is_volume(const cwi_vtk_block *block)
{
    return block->kind != CWI_VTK_BLOCK_SURFACE;
}

/* Lists the volumes for a message: "'a', 'b/c'". */
static void list_volumes(const cwi_vtk_blocks *b, char *text, size_t size)
{
    size_t used = 0;
    *text = '\0';
    for (size_t n = 0; n < b->count && used < size; n++)
        if (is_volume(&b->items[n]))
            used += (size_t)snprintf(text + used, size - used, "%s'%s'", used ? ", " : "",
                                     b->paths.items[n]);
}

/* Finds the block that a name begins with. Sets *array to what follows it, the name of an array, or to NULL.
 * The longest path counts. Returns the number of blocks if no name fits. */
static size_t find_block(const cwi_vtk_blocks *b, const char *name, const char **array)
{
    size_t found = b->count, longest = 0;
    for (size_t n = 0; n < b->count; n++) {
        const size_t length = strlen(b->paths.items[n]);
        if (!is_volume(&b->items[n]) || length <= longest ||
            strncmp(name, b->paths.items[n], length) != 0 ||
            (name[length] != '\0' && name[length] != '/'))
            continue;
        found = n;
        longest = length;
        *array = name[length] ? name + length + 1 : NULL;
    }
    return found;
}

static cw_status choose_block(const cwi_vtk_blocks *b, const cwi_input *in, size_t *chosen,
                              const char **array, cw_error *err)
{
    const size_t volumes = cwi_vtk_blocks_count(b, false);
    size_t n = 0;
    char names[300];
    if (volumes == 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "its blocks are surfaces, not volumes; use check, convert or simplify");
    while (!is_volume(&b->items[n]))
        n++;
    *array = in->array;
    *chosen = in->array ? find_block(b, in->array, array) : n;
    if (*chosen == b->count && volumes == 1)
        *chosen = n; /* the name is that of an array in it */
    list_volumes(b, names, sizeof names);
    return *chosen < b->count
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "no block is called '%.100s'; those with volumes are %s", in->array,
                          names);
}

static cw_status read_image(const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                            cw_error *err)
{
    cwi_source src = {0};
    bool is_grid;
    cw_status st = cwi_vti_read_pieces(in, desc, &is_grid, volume, err);
    if (st != CW_OK || is_grid)
        return st;
    st = cwi_vti_parse(in, &src, err);
    if (st == CW_OK && *src.note)
        cwi_note(desc, "%s", src.note);
    src.may_widen = true;
    if (st == CW_OK)
        st = cwi_check_frame(&src.shape, src.frame_field, err);
    if (st == CW_OK)
        cwi_set_spacing(&src.shape, desc);
    if (st == CW_OK)
        st = cwi_source_load(&src, in, desc, volume, err);
    cwi_source_free(&src);
    return st;
}

static cw_status read_block(cwi_vtk_blocks *b, size_t n, const cwi_input *list,
                            const char *array, const cw_read_desc *desc, cw_volume *volume,
                            cw_error *err)
{
    const cwi_vtk_block *block = &b->items[n];
    const cwi_input *side;
    cwi_input in = *list;
    in.array = array;
    if (cwi_vtk_blocks_count(b, false) > 1)
        in.arrays = NULL; /* it has the blocks */
    if (block->kind == CWI_VTK_BLOCK_CELLS)
        return cwi_vtu_read_sides(
            &in, &(cwi_names){b->files.items + block->first, block->count}, desc, volume, err);
    if (block->count > 1)
        return cwi_fail(
            err, CW_ERR_UNSUPPORTED,
            "block '%.100s' has %zu pieces of image data; those of a .pvti are joined",
            b->paths.items[n], block->count);
    cw_status st = cwi_vtk_sides_open(&b->sides, block->first, &side, err);
    if (st != CW_OK)
        return st;
    in.fd = side->fd;
    in.size = side->size;
    in.path = side->path;
    st = read_image(&in, desc, volume, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, in.path);
}

/* Lists the blocks to choose from as arrays are listed. */
static void list_blocks(const cwi_vtk_blocks *b, size_t chosen, cwi_array_list *arrays)
{
    for (size_t n = 0; n < b->count; n++)
        if (is_volume(&b->items[n]))
            cwi_array_list_add(arrays, b->paths.items[n], "block", 1, false, true);
    cwi_array_list_choose(arrays, b->paths.items[chosen], false);
}

cw_status cwi_vtm_read_volume(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                              cw_volume *volume, cw_error *err)
{
    cwi_vtk_blocks b = {0};
    const char *array = NULL;
    size_t chosen = 0;
    *is_grid = true;
    cw_status st = cwi_vtk_blocks_read(in, &b, err);
    if (st == CW_OK)
        st = choose_block(&b, in, &chosen, &array, err);
    if (st == CW_OK && cwi_vtk_blocks_count(&b, false) > 1)
        list_blocks(&b, chosen, in->arrays);
    if (st == CW_OK)
        st = read_block(&b, chosen, in, array, desc, volume, err);
    if (st == CW_OK && cwi_vtk_blocks_count(&b, true))
        cwi_note(desc, "%zu blocks that are surfaces are left out",
                 cwi_vtk_blocks_count(&b, true));
    cwi_vtk_blocks_free(&b);
    return st;
}
