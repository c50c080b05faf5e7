/* VTK's XML image data (.vti). The elements are read as a stream: the text of arrays only
 * passes through, and reading stops where appended data start, which need be no XML at all. */
#include "core/status.h"
#include "formats/readers.h"
#include "formats/vti.h"

#include <string.h>

enum { MOST_ELEMENTS = 10000 };

/* The first element is VTKFile: of image data or of something else, which is then refused. */
bool cwi_vti_sniff(const unsigned char *head, size_t size)
{
    static const char tag[] = "<VTKFile";
    for (size_t i = 0; i + sizeof tag - 1 <= size; i++)
        if (memcmp(head + i, tag, sizeof tag - 1) == 0)
            return true;
    return false;
}

/* --- elements ---------------------------------------------------------------------------- */

typedef struct parsing {
    cwi_vti vti;
    bool in_array; /* the best one: the next tag ends its text */
} parsing;

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const kind[2] = {"ImageData", "a volume"};
    parsing *p = user;
    (void)x;
    return cwi_vtk_xml_file(&p->vti.file, a, kind, err);
}

static cw_status start_image(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vti_image(&((parsing *)user)->vti, a, err);
}

static cw_status start_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vti_piece(&((parsing *)user)->vti, a, err);
}

static cw_status start_point_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x;
    return cwi_vti_point_data(&((parsing *)user)->vti, a, err);
}

static cw_status start_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    cw_status st = cwi_vti_data_array(&p->vti, a, &p->in_array, err);
    if (p->in_array)
        p->vti.best.data.start = cwi_xml_tag_end(x);
    return st;
}

static cw_status start_cell_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)a, (void)err;
    ((parsing *)user)->vti.cell_arrays++;
    return CW_OK;
}

static cw_status start_appended(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    p->vti.file.appended = cwi_xml_tag_end(x);
    cwi_xml_stop(x);
    return cwi_vtk_xml_appended(&p->vti.file, a, err);
}

static cw_status end_text(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)err;
    if (p->in_array)
        p->vti.best.data.end = cwi_xml_tag_start(x);
    p->in_array = false;
    return CW_OK;
}

typedef enum element {
    E_FILE,
    E_IMAGE,
    E_PIECE,
    E_POINT_DATA,
    E_CELL_DATA,
    E_ARRAY,
    E_CELL_ARRAY,
    E_APPENDED,
    ELEMENT_COUNT
} element;

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_FILE] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    [E_IMAGE] = {"ImageData", E_FILE, start_image, NULL},
    [E_PIECE] = {"Piece", E_IMAGE, start_piece, NULL},
    [E_POINT_DATA] = {"PointData", E_PIECE, start_point_data, NULL},
    [E_CELL_DATA] = {"CellData", E_PIECE, NULL, NULL},
    [E_ARRAY] = {"DataArray", E_POINT_DATA, start_array, NULL},
    [E_CELL_ARRAY] = {"DataArray", E_CELL_DATA, start_cell_array, NULL},
    [E_APPENDED] = {"AppendedData", E_FILE, start_appended, NULL},
};

static const cwi_xml_rules rules = {.elements = elements,
                                    .element_count = ELEMENT_COUNT,
                                    .most_elements = MOST_ELEMENTS,
                                    .tag = end_text};

/* --- to a source ------------------------------------------------------------------------- */

static cw_status check_found(const cwi_vti *v, cw_error *err)
{
    if (v->best.rank != CWI_VTI_NONE)
        return CW_OK;
    if (v->cell_arrays && !*v->others)
        return cw_fail(err, CW_ERR_FORMAT,
                       "the arrays are CellData; only values at points (PointData) are read");
    return cw_fail(err, CW_ERR_FORMAT, "PointData holds no array that is read%s%s",
                   *v->others ? "; there are " : "", v->others);
}

static cw_status set_sizes(const cwi_vti *v, cwi_source *src, cw_error *err)
{
    cwi_axis axes[] = {{CWI_AXIS_COMPONENT, v->best.data.components},
                       {CWI_AXIS_X, 0},
                       {CWI_AXIS_Y, 0},
                       {CWI_AXIS_Z, 0}};
    for (int a = 0; a < 3; a++)
        axes[1 + a].size = (size_t)(v->extent[2 * a + 1] - v->extent[2 * a] + 1);
    src->shape.type = v->best.data.type;
    src->shape.slope = 1;
    return cwi_source_set_axes(src, axes, 4, err);
}

/* World = Origin + Direction (Spacing * index), the index counted from the extent's. */
static void set_frame(const cwi_vti *v, cw_volume *shape)
{
    for (int r = 0; r < 3; r++)
        shape->affine[r][3] = v->origin[r];
    for (int c = 0; c < 3; c++) {
        const double spacing = shape->dim[c] == 1 && v->spacing[c] == 0 ? 1 : v->spacing[c];
        for (int r = 0; r < 3; r++) {
            shape->affine[r][c] = v->direction[3 * r + c] * spacing;
            shape->affine[r][3] += shape->affine[r][c] * (double)v->extent[2 * c];
        }
    }
}

cw_status cwi_vti_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    parsing p = {.in_array = false};
    cwi_vti *v = &p.vti;
    src->size_field = "Extent";
    src->frame_field = "Direction, Spacing, Origin";
    cw_status st = cwi_xml_read_file(&rules, &p, in, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_find_appended(in, &v->file, err);
    if (st == CW_OK)
        st = check_found(v, err);
    if (st == CW_OK)
        st = set_sizes(v, src, err);
    if (st != CW_OK)
        return st;
    set_frame(v, &src->shape);
    return cwi_vtk_xml_place(&v->file, &v->best.data, in, src, err);
}
