/* The state of reading a glTF scene into a mesh, which the parts of the reader share. */
#ifndef FORMATS_GLTF_GLTF_READER_H
#define FORMATS_GLTF_GLTF_READER_H

#include "formats/gltf/gltf_decompress.h"
#include "formats/gltf/gltf_scene.h"
#include "formats/mesh/face_colors.h"

/* A node of the scene that has a mesh. */
typedef struct cwi_gltf_instance {
    int mesh;
    const cwi_gltf_node *node;
    double transform[3][4]; /* to LPS millimetres */
    bool unturned;          /* only a translation */
} cwi_gltf_instance;

typedef struct cwi_gltf_reader {
    cwi_mesh_input *in;
    cwi_gltf_bytes bytes;
    cwi_gltf_unpacker unpacker;
    cwi_arrays arrays; /* of the primitive that was decoded last */
    cwi_gltf_scene scene;
    double (*world)[12]; /* of each node */
    cwi_gltf_instance *instances;
    size_t instance_count;
    bool shifted; /* every instance is moved by the mesh's origin, and nothing else */
    uint64_t max; /* maximum of vertices, and of triangles, that may be drawn */
    cwi_mesh_build build;
    float *normals;            /* room for one per point; NULL: none so far */
    uint8_t *colors;           /* of vertices, where a primitive has COLOR_0 */
    cwi_face_colors materials; /* colours of triangles by their materials */
    bool any_base;             /* some material has a base colour that counts */
    bool has_colors, has_texture, has_texcoords; /* of what was drawn */
    size_t normal_capacity, color_capacity;
    bool no_normals; /* some primitive has none: then none are kept */
} cwi_gltf_reader;

/* Walks over the scene's nodes, and finds those that have a mesh, and its transform.
 * Returns CW_ERR_FORMAT for nodes that are no forest, or nest too deeply. */
CW_NODISCARD cw_status cwi_gltf_find_instances(cwi_gltf_reader *r, cw_mesh_file *metadata,
                                               cw_error *err);

/* Adds the vertices and triangles of one instance. */
CW_NODISCARD cw_status cwi_gltf_add_instance(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                             cw_mesh_file *metadata, cw_error *err);

/* Returns the material of a primitive, or NULL. */
const cwi_gltf_material *cwi_gltf_material_of(const cwi_gltf_reader *r,
                                              const cwi_gltf_primitive *p);

/* Converts the base colour of a material to sRGB and opacity; that of NULL is white. */
void cwi_gltf_base_color(const cwi_gltf_material *m, uint8_t color[4]);

/* Returns CW_ERR_LIMIT for more vertices or triangles than r->most. */
CW_NODISCARD cw_status cwi_gltf_limit(const cwi_gltf_reader *r, uint64_t count, cw_error *err);

#endif
