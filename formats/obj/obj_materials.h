/* The colours of OBJ: materials of .mtl files by name, and colours of vertices. */
#ifndef FORMATS_OBJ_OBJ_MATERIALS_H
#define FORMATS_OBJ_OBJ_MATERIALS_H

#include "formats/mesh/face_colors.h"
#include "formats/mesh/picture_store.h"

/* A material: its diffuse colour and opacity. */
typedef struct cwi_obj_material {
    size_t name;      /* start of its name among the names */
    const char *text; /* the same, while sorting */
    size_t order;
    uint8_t color[4]; /* sRGB, as other programs write it */
    bool has_color,
        has_normal_map; /* the last: by `norm`, which counts for more than a bump map */
    cw_textures set;
    uint32_t textures; /* those of the file, once its set was added; 0: none */
} cwi_obj_material;

/* The materials of a file, sorted by name; of equal names the first counts. Zero it, except for `in`. */
typedef struct cwi_obj_materials {
    cwi_mesh_input *in; /* borrowed */
    cwi_obj_material *items;
    char *names; /* each ends with a zero */
    size_t count, capacity, name_bytes, name_capacity, files;
    bool is_missing;              /* a file of materials is not there, or damaged */
    bool has_options, has_others; /* placings of textures; pictures that are not read */
} cwi_obj_materials;

/* Reads the file of materials that the line "mtllib NAME" names. One that is missing, unsafe or no text is
 * passed over, since shapes do not depend on it.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_LIMIT, CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_obj_read_materials(cwi_obj_materials *m, const char *name,
                                              cw_error *err);

/* Finds a material by its name. Returns NULL if no material has it. */
const cwi_obj_material *cwi_obj_find_material(const cwi_obj_materials *m, const char *name);

void cwi_obj_materials_free(cwi_obj_materials *m);

/* Converts numbers from 0 to 1 into bytes, or those from 0 to 255 (scale 1 / 255). */
uint8_t cwi_obj_color(double number, double scale);

#endif
