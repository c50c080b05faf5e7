/* Finds the elements of VTK's XML PolyData (.vtp), and of lists of such files (.pvtp). */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_sides.h"
#include "formats/vtk/vtp.h"

#include <stdio.h>
#include <string.h>

enum { MAX_ELEMENTS = 100000 };

typedef cwi_vtp_piece piece;

bool cwi_vtp_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return cwi_vtk_xml_sniff(head, size, "PolyData");
}

static piece *at_hand(cwi_vtp *v)
{
    return &v->pieces[v->count - 1];
}

/* --- elements ---------------------------------------------------------------------------- */

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const kinds[2][2] = {{"PolyData", "a surface"},
                                            {"PPolyData", "a surface in files"}};
    cwi_vtp *v = user;
    const char *type = cwi_attribute(a, "type");
    (void)x;
    v->is_list = !v->is_side && type && strcmp(type, kinds[1][0]) == 0;
    return cwi_vtk_xml_file(&v->file, a, kinds[v->is_list], err);
}

static cw_status start_list_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vtk_sides_name(&((cwi_vtp *)user)->names, "Piece", "Source", a, err);
}

static cw_status start_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vtp *v = user;
    int64_t skipped[2] = {0};
    (void)x;
    piece *pieces = cwi_grow_array(v->pieces, v->count, &v->capacity, sizeof *pieces);
    if (!pieces)
        return cwi_fail_memory(err);
    v->pieces = pieces;
    piece *p = &pieces[v->count++];
    *p = (piece){.points = 0};
    const struct {
        const char *name;
        int64_t *count;
    } counts[] = {{"NumberOfPoints", &p->points},
                  {"NumberOfPolys", &p->polygons},
                  {"NumberOfStrips", &p->strips},
                  {"NumberOfVerts", &skipped[0]},
                  {"NumberOfLines", &skipped[1]}};
    cw_status st = CW_OK;
    for (size_t i = 0; i < sizeof counts / sizeof *counts && st == CW_OK; i++)
        st = cwi_vtk_xml_integer(a, counts[i].name, 0, INT64_MAX / 4, counts[i].count, err);
    p->skipped = skipped[0] + skipped[1];
    return st;
}

static void keep_name(char name[CWI_WORD_BYTES], cwi_attributes a, const char *attribute)
{
    const char *value = cwi_attribute(a, attribute);
    snprintf(name, CWI_WORD_BYTES, "%s", value ? value : "");
}

static cw_status start_point_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    piece *p = at_hand(user);
    (void)x, (void)err;
    keep_name(p->normals, a, "Normals");
    keep_name(p->scalars, a, "Scalars");
    keep_name(p->ids, a, "GlobalIds");
    return CW_OK;
}

static cw_status start_cell_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)err;
    keep_name(at_hand(user)->cell_scalars, a, "Scalars");
    return CW_OK;
}

/* Keeps the first array of a role; of arrays in PointData the named one. */
static cw_status keep_array(cwi_vtp *v, cwi_xml *x, cwi_vtp_role r, const cwi_vtk_array *array,
                            bool named)
{
    piece *p = at_hand(v);
    if (p->has[r] && !named)
        return CW_OK;
    p->has[r] = true;
    p->arrays[r] = *array;
    p->arrays[r].start = p->arrays[r].end = cwi_xml_tag_end(x);
    v->open = &p->arrays[r];
    return CW_OK;
}

/* Keeps an array of Points, Polys or Strips. */
static cw_status keep_structure(cwi_vtp *v, cwi_xml *x, cwi_attributes a, cwi_vtp_role first,
                                cwi_vtp_role ends, cw_error *err)
{
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    const bool points = first == CWI_VTP_POINTS;
    const bool is_end = !points && strcmp(array.name, "offsets") == 0;
    const size_t expected = points ? 3 : 1;
    if (st != CW_OK || (!points && !is_end && strcmp(array.name, "connectivity") != 0))
        return st;
    if (!array.is_known || array.components != expected ||
        (!points && (array.type == CW_F32 || array.type == CW_F64)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' has %zu numbers of type '%s'; %zu %s expected",
                        array.name, array.components, array.type_name, expected,
                        points ? "were" : "whole one was");
    return keep_array(v, x, is_end ? ends : first, &array, false);
}

static cw_status start_points(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_structure(user, x, a, CWI_VTP_POINTS, CWI_VTP_POINTS, err);
}

static cw_status start_polygons(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_structure(user, x, a, CWI_VTP_POLYGONS, CWI_VTP_POLYGON_ENDS, err);
}

static cw_status start_strips(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_structure(user, x, a, CWI_VTP_STRIPS, CWI_VTP_STRIP_ENDS, err);
}

static bool is_real(const cwi_vtk_array *array)
{
    return array->type == CW_F32 || array->type == CW_F64;
}

/* Returns true for the numbers that points have in all pieces: VTK names them so where no attribute
 * does. */
static bool are_ids(const cwi_vtk_array *array, const char *stated)
{
    static const char *const names[] = {"GlobalPointIds", "GlobalNodeIds", "GlobalNodeId",
                                        "vtkGlobalIds"};
    if (is_real(array) || array->components != 1)
        return false;
    if (*stated)
        return strcmp(array->name, stated) == 0;
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strcmp(array->name, names[n]) == 0)
            return true;
    return false;
}

/* Returns the role of an array of PointData; CWI_VTP_ROLE_COUNT: none. */
static cwi_vtp_role role_of(const cwi_vtk_array *array)
{
    const bool real = is_real(array);
    if (!array->is_known || strncmp(array->name, "vtkGhost", 8) == 0)
        return CWI_VTP_ROLE_COUNT;
    if (array->type == CW_U8 && (array->components == 3 || array->components == 4))
        return CWI_VTP_COLORS;
    if (array->components == 3 && real)
        return CWI_VTP_NORMALS;
    if (array->components == 1 && !real && strcmp(array->name, "label") == 0)
        return CWI_VTP_LABELS;
    return array->components == 1 ? CWI_VTP_SCALARS : CWI_VTP_ROLE_COUNT;
}

static cw_status start_point_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vtp *v = user;
    const piece *p = at_hand(v);
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    if (st != CW_OK)
        return st;
    if (array.is_known && are_ids(&array, p->ids))
        return keep_array(v, x, CWI_VTP_IDS, &array, true);
    const cwi_vtp_role r = role_of(&array);
    const char *expected = r == CWI_VTP_NORMALS ? p->normals : p->scalars;
    const bool named = *expected && strcmp(array.name, expected) == 0;
    if (r == CWI_VTP_ROLE_COUNT ||
        (r == CWI_VTP_NORMALS && !named && strcmp(array.name, "Normals") != 0))
        return CW_OK;
    return keep_array(v, x, r, &array, named);
}

static cw_status start_cell_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vtp *v = user;
    piece *p = at_hand(v);
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    if (st != CW_OK)
        return st;
    const bool type = strcmp(array.name, "vtkGhostType") == 0,
               levels = strcmp(array.name, "vtkGhostLevels") == 0;
    if (array.is_known && array.components == 1 && (type || levels)) {
        p->marks_are_levels = levels && (p->marks_are_levels || !p->has[CWI_VTP_CELL_MARKS]);
        return keep_array(v, x, CWI_VTP_CELL_MARKS, &array, type);
    }
    if (role_of(&array) != CWI_VTP_COLORS)
        return CW_OK;
    const bool named = *p->cell_scalars && strcmp(array.name, p->cell_scalars) == 0;
    return keep_array(v, x, CWI_VTP_CELL_COLORS, &array, named);
}

static cw_status start_appended(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cwi_vtp *v = user;
    v->file.appended = cwi_xml_tag_end(x);
    cwi_xml_stop(x);
    return cwi_vtk_xml_appended(&v->file, a, err);
}

static cw_status end_text(void *user, cwi_xml *x, cw_error *err)
{
    cwi_vtp *v = user;
    (void)err;
    if (v->open && cwi_xml_tag_start(x) > v->open->start)
        v->open->end = cwi_xml_tag_start(x);
    v->open = NULL;
    return CW_OK;
}

static cw_status take_comment(void *user, const char *text, cw_error *err)
{
    cwi_vtp *v = user;
    (void)err;
    cwi_take_comment(text + strspn(text, " "), &v->ours, &v->frame, &v->facts);
    return CW_OK;
}

typedef enum element {
    E_FILE,
    E_DATA,
    E_PIECE,
    E_POINT_DATA,
    E_POINT_ARRAY,
    E_CELL_DATA,
    E_CELL_ARRAY,
    E_POINTS,
    E_POINTS_ARRAY,
    E_POLYS,
    E_POLYS_ARRAY,
    E_STRIPS,
    E_STRIPS_ARRAY,
    E_LIST,
    E_LIST_PIECE,
    E_APPENDED,
    ELEMENT_COUNT
} element;

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_FILE] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    [E_DATA] = {"PolyData", E_FILE, NULL, NULL},
    [E_PIECE] = {"Piece", E_DATA, start_piece, NULL},
    [E_POINT_DATA] = {"PointData", E_PIECE, start_point_data, NULL},
    [E_POINT_ARRAY] = {"DataArray", E_POINT_DATA, start_point_array, NULL},
    [E_CELL_DATA] = {"CellData", E_PIECE, start_cell_data, NULL},
    [E_CELL_ARRAY] = {"DataArray", E_CELL_DATA, start_cell_array, NULL},
    [E_POINTS] = {"Points", E_PIECE, NULL, NULL},
    [E_POINTS_ARRAY] = {"DataArray", E_POINTS, start_points, NULL},
    [E_POLYS] = {"Polys", E_PIECE, NULL, NULL},
    [E_POLYS_ARRAY] = {"DataArray", E_POLYS, start_polygons, NULL},
    [E_STRIPS] = {"Strips", E_PIECE, NULL, NULL},
    [E_STRIPS_ARRAY] = {"DataArray", E_STRIPS, start_strips, NULL},
    [E_LIST] = {"PPolyData", E_FILE, NULL, NULL},
    [E_LIST_PIECE] = {"Piece", E_LIST, start_list_piece, NULL},
    [E_APPENDED] = {"AppendedData", E_FILE, start_appended, NULL},
};

static const cwi_xml_rules rules = {.elements = elements,
                                    .element_count = ELEMENT_COUNT,
                                    .max_elements = MAX_ELEMENTS,
                                    .tag = end_text,
                                    .comment = take_comment};

/* --- a file ------------------------------------------------------------------------------- */

/* Checks that a file states the same unit and frame as those before. */
static cw_status check_facts(const cw_mesh_file *before, const cw_mesh_file *now, cw_error *err)
{
    if (now->known == before->known && now->axes.unit == before->axes.unit &&
        now->axes.ras == before->axes.ras && now->axes.y_up == before->axes.y_up)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "files of pieces differ: this one states another unit or frame than the "
                    "first");
}

cw_status cwi_vtp_parse(cwi_vtp *v, const cwi_input *in, size_t side, uint32_t group,
                        cw_error *err)
{
    const size_t first = v->count;
    const cw_mesh_file before = v->facts;
    v->file = (cwi_vtk_xml){0};
    v->frame = (cw_mesh){0};
    v->facts = (cw_mesh_file){0};
    v->ours = false;
    cw_status st = cwi_xml_read_file(&rules, v, in, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_find_appended(in, &v->file, err);
    for (size_t n = first; n < v->count; n++) {
        v->pieces[n].file = v->file; /* the place of appended data comes last */
        v->pieces[n].side = side;
        v->pieces[n].group = group;
        memcpy(v->pieces[n].origin, v->frame.origin, sizeof v->frame.origin);
    }
    if (st == CW_OK && first)
        st = check_facts(&before, &v->facts, err);
    v->facts.local = v->facts.local || before.local;
    if (st == CW_OK && v->count == first && !v->is_list)
        st = cwi_fail(err, CW_ERR_FORMAT, "PolyData holds no Piece");
    return st;
}

void cwi_vtp_free(cwi_vtp *v)
{
    cwi_free(v->pieces);
    cwi_names_free(&v->names);
    *v = (cwi_vtp){0};
}
