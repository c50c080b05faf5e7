/* Writes the elements of VTK's XML that stand for a VTKHDF file: an image, a grid in partitions, or a
 * surface in partitions. Of several time steps it takes the first. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/byte_order.h"
#include "formats/vtkhdf/vtkhdf_file.h"

#include <inttypes.h>
#include <string.h>

/* Elements that the readers of XML take. */
enum { MAX_ELEMENTS = 90000, PIECE_ELEMENTS = 20 };

static const char *const data_names[2] = {"PointData", "CellData"};

/* --- text --------------------------------------------------------------------------------- */

static void put_text(FILE *to, const char *text)
{
    for (; *text; text++)
        if (strchr("<>&\"'", *text))
            fprintf(to, "&#%d;", *text);
        else
            fputc(*text, to);
}

static void put_numbers(FILE *to, const char *name, const double *numbers, size_t count)
{
    fprintf(to, " %s=\"", name);
    for (size_t n = 0; n < count; n++)
        fprintf(to, "%s%.17g", n ? " " : "", numbers[n]);
    fputc('"', to);
}

static cw_status start_file(cwi_vtkhdf *h, cw_error *err)
{
    h->xml = cwi_text_open(&h->text, &h->text_size);
    if (!h->xml)
        return cwi_fail_memory(err);
    fprintf(h->xml, "<VTKFile type=\"%s\" byte_order=\"%sEndian\" header_type=\"UInt64\"><%s",
            h->facts.type, cwi_machine_is_big_endian() ? "Big" : "Little", h->facts.type);
    return CW_OK;
}

static void end_file(cwi_vtkhdf *h)
{
    fprintf(h->xml, "</%s>", h->facts.type);
}

/* --- arrays ------------------------------------------------------------------------------- */

cw_status cwi_vtkhdf_put_array(cwi_vtkhdf *h, const cwi_vtkhdf_array *a, const char *name,
                               uint64_t components, uint64_t first, uint64_t count,
                               cw_error *err)
{
    static const char *const types[CWI_VTKHDF_NUMBERS] = {
        "",       "Int8",  "UInt8",  "Int16",   "UInt16", "Int32",
        "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    if (first > a->dim[0] || count > a->dim[0] - first)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' has %" PRIu64 " rows; rows %" PRIu64 " to %" PRIu64
                        " were expected",
                        a->name, a->dim[0], first, first + count);
    cwi_vtkhdf_item *items =
        cwi_grow_array(h->items, h->item_count, &h->item_capacity, sizeof *items);
    if (!items)
        return cwi_fail_memory(err);
    h->items = items;
    cwi_vtkhdf_item *item = &items[h->item_count++];
    *item = (cwi_vtkhdf_item){
        .array = a,
        .first = first,
        .count = count,
        .at = h->appended_bytes,
        .bytes = count * cwi_vtkhdf_row_bytes(a),
        .is_value = (cwi_vtkhdf_value_name(a, false) || cwi_vtkhdf_value_name(a, true)) &&
                    strncmp(name, "vtkGhost", 8) != 0};
    h->appended_bytes += sizeof(uint64_t) + item->bytes;
    fprintf(h->xml, "<DataArray type=\"%s\" Name=\"", types[a->number]);
    put_text(h->xml, name);
    fprintf(h->xml,
            "\" NumberOfComponents=\"%" PRIu64 "\" format=\"appended\" offset=\"%" PRIu64
            "\"/>",
            components, item->at);
    return CW_OK;
}

const char *cwi_vtkhdf_value_name(const cwi_vtkhdf_array *a, bool of_cells)
{
    const char *group = data_names[of_cells];
    const size_t length = strlen(group);
    return strncmp(a->name, group, length) == 0 && a->name[length] == '/' ? a->name + length + 1
                                                                          : NULL;
}

void cwi_vtkhdf_put_data(cwi_vtkhdf *h, bool of_cells, bool opens)
{
    static const char *const names[CWI_VTKHDF_ATTRIBUTES] = {"Scalars", "Normals", "GlobalIds"};
    fprintf(h->xml, opens ? "<%s" : "</%s", data_names[of_cells]);
    for (int k = 0; k < CWI_VTKHDF_ATTRIBUTES && opens; k++)
        if (*h->facts.names[of_cells][k]) {
            fprintf(h->xml, " %s=\"", names[k]);
            put_text(h->xml, h->facts.names[of_cells][k]);
            fputc('"', h->xml);
        }
    fputc('>', h->xml);
}

/* --- images ------------------------------------------------------------------------------- */

/* Returns true if dimensions are those of x, y, z, the slowest first; those of 1 may be left out. */
static bool are_sizes(const uint64_t *dim, uint32_t rank, const uint64_t size[3])
{
    uint32_t n = 0;
    for (int axis = 3; axis-- > 0;) {
        while (n < rank && dim[n] == 1)
            n++;
        if (size[axis] != 1 && (n == rank || dim[n++] != size[axis]))
            return false;
    }
    while (n < rank && dim[n] == 1)
        n++;
    return n == rank;
}

/* Returns the number of components of an array with these sizes, behind `skip` dimensions; 0: it has
 * others. */
static uint64_t find_components(const cwi_vtkhdf_array *a, uint32_t skip,
                                const uint64_t size[3])
{
    if (a->rank < skip)
        return 0;
    const uint32_t rank = a->rank - skip;
    if (are_sizes(a->dim + skip, rank, size))
        return 1;
    return rank > 0 && are_sizes(a->dim + skip, rank - 1, size) ? a->dim[a->rank - 1] : 0;
}

static cw_status put_image_array(cwi_vtkhdf *h, cwi_vtkhdf_array *a, bool of_cells,
                                 const uint64_t size[3], cw_error *err)
{
    const char *name = cwi_vtkhdf_value_name(a, of_cells);
    const bool steps = h->facts.has_steps && find_components(a, 1, size);
    const uint64_t components = find_components(a, steps, size);
    char start[CWI_VTKHDF_NAME + 32];
    uint64_t first = 0;
    if (!components || components > INT32_MAX) {
        snprintf(a->refusal, sizeof a->refusal,
                 "its shape is not %" PRIu64 " x %" PRIu64 " x %" PRIu64
                 ", as 'WholeExtent' states",
                 size[2], size[1], size[0]);
        return CW_OK;
    }
    snprintf(start, sizeof start, "Steps/%sOffsets/%s", data_names[of_cells], name);
    cw_status st = steps ? cwi_vtkhdf_start(h, start, 0, &first, err) : CW_OK;
    return st == CW_OK
               ? cwi_vtkhdf_put_array(h, a, name, components, first, steps ? 1 : a->dim[0], err)
               : st;
}

cw_status cwi_vtkhdf_put_image(cwi_vtkhdf *h, cw_error *err)
{
    cwi_vtkhdf_facts *f = &h->facts;
    const int64_t *e = f->extent;
    if (!f->has_extent)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the group VTKHDF has no attribute 'WholeExtent'; six whole numbers were "
            "expected");
    for (int n = 0; n < 6; n++)
        if (e[n] > INT32_MAX || e[n] < INT32_MIN || (n % 2 && e[n] < e[n - 1]))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'WholeExtent' goes from %" PRId64 " to %" PRId64
                            " along %c; whole numbers of 32 bits that rise were expected",
                            e[n / 2 * 2], e[n / 2 * 2 + 1], "xyz"[n / 2]);
    cw_status st = start_file(h, err);
    if (st != CW_OK)
        return st;
    void *before = cwi_locale_c();
    put_numbers(h->xml, "Origin", f->origin, 3);
    put_numbers(h->xml, "Spacing", f->spacing, 3);
    put_numbers(h->xml, "Direction", f->direction, 9);
    cwi_locale_restore(before);
    fprintf(h->xml, "><Piece Extent=\"");
    for (int n = 0; n < 6; n++)
        fprintf(h->xml, "%s%" PRId64, n ? " " : "", e[n]);
    fprintf(h->xml, "\">");
    for (int cells = 0; cells < 2 && st == CW_OK; cells++) {
        uint64_t size[3];
        for (int n = 0; n < 3; n++) {
            size[n] = (uint64_t)(e[2 * n + 1] - e[2 * n] + 1);
            size[n] -= cells && size[n] > 1; /* a flat image has flat cells */
        }
        cwi_vtkhdf_put_data(h, cells, true);
        for (uint32_t n = 0; n < f->array_count && st == CW_OK; n++)
            if (!*f->arrays[n].refusal && cwi_vtkhdf_value_name(&f->arrays[n], cells))
                st = put_image_array(h, &f->arrays[n], cells, size, err);
        cwi_vtkhdf_put_data(h, cells, false);
    }
    fprintf(h->xml, "</Piece>");
    end_file(h);
    return st;
}

/* --- partitions --------------------------------------------------------------------------- */

/* The cells of a kind: all of a grid, or those of Vertices, Lines, Polygons or Strips. */
typedef struct cells {
    const char *group; /* with a slash; "": those of a grid */
    const char *tag, *attribute;
    bool is_skipped;               /* they are no faces */
    uint64_t *counts, *id_counts;  /* of each partition */
    uint64_t first, first_id, end; /* of the next partition in the arrays; end: in Offsets */
} cells;

enum { VERTICES, LINES, POLYGONS, STRIPS, KINDS };

typedef struct parts {
    cwi_vtkhdf *h;
    uint64_t first, count; /* partitions */
    uint64_t *points;      /* of each */
    cells kinds[KINDS];
    size_t kind_count;
    uint64_t data[CWI_VTKHDF_ARRAYS]; /* row of each array of values in the next partition */
    uint64_t point;                   /* row of Points */
} parts;

static cw_status find_parts(parts *p, cw_error *err)
{
    cwi_vtkhdf *h = p->h;
    const cwi_vtkhdf_array *a;
    uint64_t arrays = 0;
    cw_status st = cwi_vtkhdf_need(h, "NumberOfPoints", 1, false, &a, err);
    if (st != CW_OK)
        return st;
    p->count = a->dim[0];
    if (h->facts.has_steps) {
        st = cwi_vtkhdf_start(h, "Steps/PartOffsets", 0, &p->first, err);
        if (st == CW_OK && cwi_vtkhdf_find(h, "Steps/NumberOfParts"))
            st = cwi_vtkhdf_counts(h, "Steps/NumberOfParts", 0, 0, 1, &p->count, err);
    }
    for (uint32_t n = 0; n < h->facts.array_count; n++)
        arrays += cwi_vtkhdf_value_name(&h->facts.arrays[n], false) ||
                  cwi_vtkhdf_value_name(&h->facts.arrays[n], true);
    if (st == CW_OK && p->count > MAX_ELEMENTS / (PIECE_ELEMENTS + arrays))
        st = cwi_fail(err, CW_ERR_LIMIT,
                      "it has %" PRIu64 " partitions of %" PRIu64
                      " arrays, more than are read; ParaView merges them",
                      p->count, arrays);
    if (st == CW_OK && p->count == 0)
        st = cwi_fail(err, CW_ERR_FORMAT, "'NumberOfPoints' lists no partition");
    return st;
}

/* Reads a list with a number for each partition. */
static cw_status read_list(parts *p, const char *group, const char *name, uint64_t **list,
                           cw_error *err)
{
    char path[64];
    snprintf(path, sizeof path, "%s%s", group, name);
    *list = cwi_alloc_zeroed(p->count, sizeof **list);
    return *list ? cwi_vtkhdf_counts(p->h, path, 0, p->first, p->count, *list, err)
                 : cwi_fail_memory(err);
}

static bool has_kind(const parts *p, const cells *k)
{
    char path[64];
    snprintf(path, sizeof path, "%sNumberOfCells", k->group);
    return !*k->group || cwi_vtkhdf_find(p->h, path);
}

static cw_status read_kind(parts *p, size_t n, cw_error *err)
{
    cells *k = &p->kinds[n];
    const uint32_t column = (uint32_t)n;
    if (!has_kind(p, k)) {
        k->counts = cwi_alloc_zeroed(p->count, sizeof *k->counts);
        return k->counts ? CW_OK : cwi_fail_memory(err);
    }
    cw_status st = read_list(p, k->group, "NumberOfCells", &k->counts, err);
    if (st == CW_OK)
        st = read_list(p, k->group, "NumberOfConnectivityIds", &k->id_counts, err);
    if (st == CW_OK)
        st = cwi_vtkhdf_start(p->h, "Steps/CellOffsets", column, &k->first, err);
    if (st == CW_OK)
        st = cwi_vtkhdf_start(p->h, "Steps/ConnectivityIdOffsets", column, &k->first_id, err);
    k->end = k->first + p->first; /* each partition has one offset more than cells */
    return st;
}

static cw_status start_values(parts *p, cw_error *err)
{
    cw_status st = cwi_vtkhdf_start(p->h, "Steps/PointOffsets", 0, &p->point, err);
    for (uint32_t n = 0; n < p->h->facts.array_count && st == CW_OK; n++)
        for (int of_cells = 0; of_cells < 2 && st == CW_OK; of_cells++) {
            char path[CWI_VTKHDF_NAME + 32];
            const char *name = cwi_vtkhdf_value_name(&p->h->facts.arrays[n], of_cells);
            snprintf(path, sizeof path, "Steps/%sOffsets/%s", data_names[of_cells],
                     name ? name : "");
            if (name)
                st = cwi_vtkhdf_start(p->h, path, 0, &p->data[n], err);
        }
    return st;
}

/* Writes the arrays of values that a partition has, if it has places for them. */
static cw_status put_values(parts *p, bool of_cells, uint64_t count, cw_error *err)
{
    cw_status st = CW_OK;
    cwi_vtkhdf_put_data(p->h, of_cells, true);
    for (uint32_t n = 0; n < p->h->facts.array_count && st == CW_OK; n++) {
        const cwi_vtkhdf_array *a = &p->h->facts.arrays[n];
        const char *name = cwi_vtkhdf_value_name(a, of_cells);
        if (!name || *a->refusal || !count)
            continue;
        const uint64_t components =
            cwi_vtkhdf_row_bytes(a) / cwi_vtkhdf_number_bytes(a->number);
        if (components && components <= INT32_MAX)
            st = cwi_vtkhdf_put_array(p->h, a, name, components, p->data[n], count, err);
        p->data[n] += count;
    }
    cwi_vtkhdf_put_data(p->h, of_cells, false);
    return st;
}

static cw_status put_named(parts *p, const char *group, const char *name, const char *to,
                           uint64_t components, uint64_t first, uint64_t count, cw_error *err)
{
    const cwi_vtkhdf_array *a;
    char path[64];
    snprintf(path, sizeof path, "%s%s", group, name);
    if (!count)
        return CW_OK;
    cw_status st = cwi_vtkhdf_need(p->h, path, components, components > 1, &a, err);
    return st == CW_OK ? cwi_vtkhdf_put_array(p->h, a, to, components, first, count, err) : st;
}

/* Writes the cells of a kind, and advances to those of the next partition. Offsets start with a 0 that XML
 * does not have. */
static cw_status put_cells(parts *p, cells *k, uint64_t part, cw_error *err)
{
    const uint64_t count = k->counts[part], ids = k->id_counts ? k->id_counts[part] : 0;
    if (k->is_skipped)
        return CW_OK;
    fprintf(p->h->xml, "<%s>", k->tag);
    cw_status st =
        put_named(p, k->group, "Connectivity", "connectivity", 1, k->first_id, ids, err);
    if (st == CW_OK)
        st = put_named(p, k->group, "Offsets", "offsets", 1, k->end + 1, count, err);
    if (st == CW_OK && !*k->group)
        st = put_named(p, "", "Types", "types", 1, k->first, count, err);
    fprintf(p->h->xml, "</%s>", k->tag);
    k->first += count;
    k->first_id += ids;
    k->end += count + 1;
    return st;
}

static cw_status put_part(parts *p, uint64_t part, cw_error *err)
{
    FILE *xml = p->h->xml;
    const uint64_t points = p->points[part];
    uint64_t all = 0;
    fprintf(xml, "<Piece NumberOfPoints=\"%" PRIu64 "\"", points);
    for (size_t n = 0; n < p->kind_count; n++) {
        all += p->kinds[n].counts[part];
        fprintf(xml, " %s=\"%" PRIu64 "\"", p->kinds[n].attribute, p->kinds[n].counts[part]);
    }
    fprintf(xml, ">");
    fprintf(xml, "<Points>");
    cw_status st = put_named(p, "", "Points", "Points", 3, p->point, points, err);
    fprintf(xml, "</Points>");
    p->point += points;
    for (size_t n = 0; n < p->kind_count && st == CW_OK; n++)
        st = put_cells(p, &p->kinds[n], part, err);
    if (st == CW_OK)
        st = put_values(p, false, points, err);
    if (st == CW_OK)
        st = put_values(p, true, all, err);
    fprintf(xml, "</Piece>");
    return st;
}

static cw_status put_parts(parts *p, cw_error *err)
{
    cw_status st = find_parts(p, err);
    if (st == CW_OK)
        st = read_list(p, "", "NumberOfPoints", &p->points, err);
    for (size_t n = 0; n < p->kind_count && st == CW_OK; n++)
        st = read_kind(p, n, err);
    if (st == CW_OK)
        st = start_values(p, err);
    if (st == CW_OK)
        st = start_file(p->h, err);
    if (st == CW_OK)
        fprintf(p->h->xml, ">");
    for (uint64_t part = 0; part < p->count && st == CW_OK; part++)
        st = put_part(p, part, err);
    if (st == CW_OK)
        end_file(p->h);
    cwi_free(p->points);
    for (size_t n = 0; n < p->kind_count; n++) {
        cwi_free(p->kinds[n].counts);
        cwi_free(p->kinds[n].id_counts);
    }
    return st;
}

cw_status cwi_vtkhdf_put_grid(cwi_vtkhdf *h, cw_error *err)
{
    parts p = {.h = h,
               .kinds = {{.group = "", .tag = "Cells", .attribute = "NumberOfCells"}},
               .kind_count = 1};
    return put_parts(&p, err);
}

cw_status cwi_vtkhdf_put_surface(cwi_vtkhdf *h, cw_error *err)
{
    parts p = {
        .h = h,
        .kinds = {[VERTICES] = {"Vertices/", "Verts", "NumberOfVerts", .is_skipped = true},
                  [LINES] = {"Lines/", "Lines", "NumberOfLines", .is_skipped = true},
                  [POLYGONS] = {"Polygons/", "Polys", "NumberOfPolys", .is_skipped = false},
                  [STRIPS] = {"Strips/", "Strips", "NumberOfStrips", .is_skipped = false}},
        .kind_count = KINDS};
    return put_parts(&p, err);
}
