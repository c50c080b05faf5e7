/* Reads VTK's lists of data sets: nested blocks, partitions, and the files of each. */
#include "formats/vtk/vtk_blocks.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_xml.h"

#include <stdio.h>
#include <string.h>

enum { MAX_ELEMENTS = 200000, PATH_BYTES = 1024, MAX_DEPTH = 64 };

typedef struct parsing {
    cwi_vtk_blocks *blocks;
    char path[PATH_BYTES];  /* of the element at hand */
    size_t ends[MAX_DEPTH]; /* length of the path around each open element */
    size_t depth,
        numbers[MAX_DEPTH + 1]; /* elements begun at each depth, for those without a name */
    bool joins;                 /* data sets at hand are pieces of one block */
    bool begun;                 /* ... which has one already */
} parsing;

static const char *const kinds[][2] = {
    {"vtkMultiBlockDataSet", "a list of blocks"},
    {"vtkPartitionedDataSetCollection", "a list of blocks"},
    {"vtkPartitionedDataSet", "a list of blocks"},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

bool cwi_vtk_blocks_sniff(const unsigned char *head, size_t size)
{
    for (int k = 0; k < KINDS; k++)
        if (cwi_vtk_xml_sniff(head, size, kinds[k][0]))
            return true;
    return false;
}

/* --- elements ---------------------------------------------------------------------------- */

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vtk_xml file = {0};
    const char *type = cwi_attribute(a, "type");
    int kind = 0;
    (void)user, (void)x;
    for (int k = 0; k < KINDS && type; k++)
        if (strcmp(type, kinds[k][0]) == 0)
            kind = k;
    return cwi_vtk_xml_file(&file, a, kinds[kind], err);
}

/* Appends the name of an element to the path: the one that it states, or else its number. */
static void enter(parsing *p, cwi_attributes a)
{
    const char *name = cwi_attribute(a, "name"), *index = cwi_attribute(a, "index");
    char number[24];
    const size_t used = strlen(p->path);
    snprintf(number, sizeof number, "%zu", p->numbers[p->depth]++);
    if (!name || !*name)
        name = index && *index ? index : number;
    p->ends[p->depth++] = used; /* the XML reader limits the depth */
    p->numbers[p->depth] = 0;
    snprintf(p->path + used, sizeof p->path - used, "%s%s", used ? "/" : "", name);
}

static void leave(parsing *p)
{
    p->path[p->ends[--p->depth]] = '\0';
}

static cw_status start_block(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)err;
    enter(user, a);
    return CW_OK;
}

static cw_status end_block(void *user, cwi_xml *x, cw_error *err)
{
    (void)x, (void)err;
    leave(user);
    return CW_OK;
}

/* Starts a block whose data sets are its pieces. */
static cw_status start_pieces(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    enter(p, a);
    p->joins = true;
    p->begun = false;
    return CW_OK;
}

static cw_status end_pieces(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    leave(p);
    p->joins = false;
    return CW_OK;
}

static cw_status start_root_pieces(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const name[] = {"name", "data", NULL};
    (void)a;
    return start_pieces(user, x, name, err);
}

/* Adds a file to the block at hand, or as a block of its own. One without a file is empty. */
static cw_status start_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    cwi_vtk_blocks *b = p->blocks;
    const char *file = cwi_attribute(a, "file");
    cw_status st = CW_OK;
    (void)x;
    if (!p->joins)
        enter(p, a);
    if (file && *file && !(p->joins && p->begun)) {
        void *items = cwi_grow_array(b->items, b->count, &b->capacity, sizeof *b->items);
        if (!items)
            return cwi_fail_memory(err);
        b->items = items;
        st = cwi_names_add(&b->paths, p->path, err);
        if (st == CW_OK)
            b->items[b->count++] = (cwi_vtk_block){.first = b->files.count};
        p->begun = true;
    }
    if (file && *file && st == CW_OK)
        st = cwi_vtk_sides_name(&b->files, "DataSet", "file", a, err);
    if (file && *file && st == CW_OK)
        b->items[b->count - 1].count++;
    return st;
}

static cw_status end_data(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    if (!p->joins)
        leave(p);
    return CW_OK;
}

enum {
    E_FILE,
    E_BLOCKS,
    E_COLLECTION,
    E_PARTITIONED,
    E_BLOCK,
    E_TOP_BLOCK,
    E_PIECES,
    E_TOP_PIECES,
    E_PARTITIONS,
    E_BLOCKS_DATA,
    E_BLOCK_DATA,
    E_TOP_BLOCK_DATA,
    E_PIECES_DATA,
    E_TOP_PIECES_DATA,
    E_PARTITIONS_DATA,
    E_PARTITIONED_DATA,
    E_TOP_BLOCK_PIECES,
    E_TOP_BLOCK_PIECES_DATA,
    ELEMENT_COUNT
};

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_FILE] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    [E_BLOCKS] = {"vtkMultiBlockDataSet", E_FILE, NULL, NULL},
    [E_COLLECTION] = {"vtkPartitionedDataSetCollection", E_FILE, NULL, NULL},
    [E_PARTITIONED] = {"vtkPartitionedDataSet", E_FILE, start_root_pieces, end_pieces},
    [E_TOP_BLOCK] = {"Block", E_BLOCKS, start_block, end_block},
    [E_BLOCK] = {"Block", E_TOP_BLOCK, start_block, end_block}, /* and in itself */
    [E_TOP_PIECES] = {"Piece", E_BLOCKS, start_pieces, end_pieces},
    [E_TOP_BLOCK_PIECES] = {"Piece", E_TOP_BLOCK, start_pieces, end_pieces},
    [E_PIECES] = {"Piece", E_BLOCK, start_pieces, end_pieces},
    [E_PARTITIONS] = {"Partitions", E_COLLECTION, start_pieces, end_pieces},
    [E_BLOCKS_DATA] = {"DataSet", E_BLOCKS, start_data, end_data},
    [E_TOP_BLOCK_DATA] = {"DataSet", E_TOP_BLOCK, start_data, end_data},
    [E_BLOCK_DATA] = {"DataSet", E_BLOCK, start_data, end_data},
    [E_TOP_PIECES_DATA] = {"DataSet", E_TOP_PIECES, start_data, end_data},
    [E_TOP_BLOCK_PIECES_DATA] = {"DataSet", E_TOP_BLOCK_PIECES, start_data, end_data},
    [E_PIECES_DATA] = {"DataSet", E_PIECES, start_data, end_data},
    [E_PARTITIONS_DATA] = {"DataSet", E_PARTITIONS, start_data, end_data},
    [E_PARTITIONED_DATA] = {"DataSet", E_PARTITIONED, start_data, end_data},
};

static const cwi_xml_rules rules = {.elements = elements,
                                    .element_count = ELEMENT_COUNT,
                                    .max_elements = MAX_ELEMENTS,
                                    .nests = E_BLOCK};

/* --- files ------------------------------------------------------------------------------- */

static cwi_vtk_block_kind kind_of(const unsigned char *head, size_t size)
{
    if (cwi_vtk_blocks_sniff(head, size))
        return CWI_VTK_BLOCK_OTHER;
    if (cwi_vtp_sniff(head, size, 0))
        return CWI_VTK_BLOCK_SURFACE;
    if (cwi_vtu_sniff(head, size))
        return CWI_VTK_BLOCK_CELLS;
    return cwi_vtk_xml_sniff(head, size, "ImageData") ||
                   cwi_vtk_xml_sniff(head, size, "RectilinearGrid")
               ? CWI_VTK_BLOCK_IMAGE
               : CWI_VTK_BLOCK_OTHER;
}

static cw_status find_kind(cwi_vtk_blocks *b, size_t n, cw_error *err)
{
    unsigned char head[CWI_SNIFF_BYTES];
    const cwi_input *in;
    size_t size = 0;
    cw_status st = cwi_vtk_sides_open(&b->sides, b->items[n].first, &in, err);
    if (st == CW_OK)
        st = cwi_input_read_at(in->fd, 0, head, sizeof head, &size, err);
    if (st == CW_OK)
        b->items[n].kind = kind_of(head, size);
    if (st == CW_OK && b->items[n].kind == CWI_VTK_BLOCK_OTHER)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the file '%.100s' of block '%.100s' is none of PolyData, ImageData, "
                        "RectilinearGrid, StructuredGrid and UnstructuredGrid as XML",
                        in->path, b->paths.items[n]);
    return st;
}

cw_status cwi_vtk_blocks_read(const cwi_input *list, cwi_vtk_blocks *b, cw_error *err)
{
    parsing p = {.blocks = b};
    b->sides = (cwi_vtk_sides){.list = list, .names = &b->files};
    cw_status st = cwi_xml_read_file(&rules, &p, list, err);
    if (st == CW_OK && b->count == 0)
        st = cwi_fail(err, CW_ERR_FORMAT, "none of its blocks names a file");
    if (st == CW_OK)
        st = cwi_vtk_sides_check(&b->sides, &b->bytes, err);
    for (size_t n = 0; n < b->count && st == CW_OK; n++)
        st = find_kind(b, n, err);
    return st;
}

void cwi_vtk_blocks_free(cwi_vtk_blocks *b)
{
    cwi_vtk_sides_close(&b->sides);
    cwi_names_free(&b->paths);
    cwi_names_free(&b->files);
    cwi_free(b->items);
    *b = (cwi_vtk_blocks){0};
}

size_t cwi_vtk_blocks_count(const cwi_vtk_blocks *b, bool surfaces)
{
    size_t count = 0;
    for (size_t n = 0; n < b->count; n++)
        count += (b->items[n].kind == CWI_VTK_BLOCK_SURFACE) == surfaces;
    return count;
}
