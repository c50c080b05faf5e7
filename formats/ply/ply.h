/* The header of a PLY file: its elements, and the properties of each. */
#ifndef FORMATS_PLY_PLY_H
#define FORMATS_PLY_PLY_H

#include "formats/mesh/mesh_reader.h"

/* The types of numbers in a file, by their names: "char" or "int8" and so on. */
typedef enum cwi_ply_type {
    CWI_PLY_I8,
    CWI_PLY_U8,
    CWI_PLY_I16,
    CWI_PLY_U16,
    CWI_PLY_I32,
    CWI_PLY_U32,
    CWI_PLY_F32,
    CWI_PLY_F64,
    CWI_PLY_TYPE_COUNT
} cwi_ply_type;

/* The use of a vertex's or face's property. */
typedef enum cwi_ply_role {
    CWI_PLY_X,
    CWI_PLY_Y,
    CWI_PLY_Z,
    CWI_PLY_NX,
    CWI_PLY_NY,
    CWI_PLY_NZ,
    CWI_PLY_RED,
    CWI_PLY_GREEN,
    CWI_PLY_BLUE,
    CWI_PLY_ALPHA,
    CWI_PLY_SCALAR,
    CWI_PLY_LABEL,
    CWI_PLY_INDICES,
    CWI_PLY_FACE_RED,
    CWI_PLY_FACE_GREEN,
    CWI_PLY_FACE_BLUE,
    CWI_PLY_FACE_ALPHA,
    CWI_PLY_NOTHING /* read and ignored */
} cwi_ply_role;

typedef struct cwi_ply_property {
    cwi_ply_role role;
    cwi_ply_type type;
    bool is_list;
    cwi_ply_type count_type; /* of a list */
} cwi_ply_property;

enum { CWI_PLY_ELEMENTS = 32, CWI_PLY_PROPERTIES = 256, CWI_PLY_NAME = 24 };

typedef struct cwi_ply_element {
    char name[CWI_PLY_NAME];      /* shortened */
    char what[CWI_PLY_NAME + 12]; /* "element 'NAME'", for messages */
    uint64_t count;
    size_t first, end; /* in properties */
} cwi_ply_element;

typedef struct cwi_ply_header {
    bool text, big_endian;
    cwi_ply_element elements[CWI_PLY_ELEMENTS];
    cwi_ply_property properties[CWI_PLY_PROPERTIES];
    size_t element_count, property_count;
    uint64_t body;    /* offset of the first element */
    size_t lines;     /* of the header */
    double origin[3]; /* stated by our local files; else 0 */
} cwi_ply_header;

size_t cwi_ply_type_size(cwi_ply_type type);

/* Reads the header, and checks that the file is long enough for its counts. Sets known and
 * local of metadata. */
CW_NODISCARD cw_status cwi_ply_parse(const cwi_input *in, cwi_ply_header *h,
                                     cw_mesh_file *metadata, cw_error *err);

#endif
