/* The content of a glTF file as plain numbers, as far as a mesh needs it. Nothing here has been
 * checked; indices are as in the file, -1 where there is none. */
#ifndef FORMATS_GLTF_GLTF_SCENE_H
#define FORMATS_GLTF_GLTF_SCENE_H

#include "formats/mesh/mesh_reader.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_gltf_buffer {
    char *uri;      /* NULL: the binary chunk */
    uint64_t bytes; /* as the JSON states */
} cwi_gltf_buffer;

typedef enum cwi_gltf_mode {
    CWI_GLTF_ATTRIBUTES,
    CWI_GLTF_TRIANGLES,
    CWI_GLTF_SEQUENCE
} cwi_gltf_mode;

typedef struct cwi_gltf_view {
    int64_t buffer;
    uint64_t offset, bytes, stride; /* stride 0: packed */
    int64_t packed_buffer;          /* of EXT_meshopt_compression; -1: not compressed */
    uint64_t packed_offset, packed_bytes, packed_stride, packed_count;
    int packed_mode, packed_filter;
} cwi_gltf_view;

/* Elements that replace others. */
typedef struct cwi_gltf_sparse {
    uint64_t count; /* 0: none */
    int64_t index_view, value_view;
    uint64_t index_offset, value_offset;
    int index_component;
} cwi_gltf_sparse;

typedef struct cwi_gltf_accessor {
    int64_t view; /* -1: none */
    uint64_t offset, count;
    int component; /* 5120 to 5126 */
    int numbers;   /* 1 to 4, or 16 of a matrix of floats; 0: another matrix */
    bool normalized;
    cwi_gltf_sparse sparse;
    bool has_bounds; /* of 3 numbers */
    double min[3], max[3];
} cwi_gltf_accessor;

/* The displacements of a morph target: accessors, or -1. */
typedef struct cwi_gltf_target {
    int position, normal;
    bool has_color; /* it changes COLOR_0, too */
} cwi_gltf_target;

/* The sets of four joints and weights of a vertex that are read. */
enum { CWI_GLTF_SETS = 2 };

typedef struct cwi_gltf_primitive {
    int mode; /* 0 to 6 */
    int indices, position, normal, color, texture;
    int draco; /* the view of KHR_draco_mesh_compression; -1: not compressed */
    int draco_position, draco_normal, draco_color,
        draco_texture; /* Draco's numbers of attributes; or -1 */
    int material;
    int joints[CWI_GLTF_SETS], weights[CWI_GLTF_SETS];
    size_t first_target, end_target;
} cwi_gltf_primitive;

typedef struct cwi_gltf_material {
    double base[4]; /* linear light and opacity */
    bool is_plain;  /* the base colour says nothing: white, or 0.8 of it */
} cwi_gltf_material;

typedef struct cwi_gltf_mesh {
    size_t first, end;               /* of primitives */
    char *name;                      /* or NULL */
    size_t first_weight, end_weight; /* of morph targets */
} cwi_gltf_mesh;

typedef struct cwi_gltf_skin {
    size_t first, end; /* of joints */
    int inverse_bind;  /* accessor of matrices; -1: they are the identity */
} cwi_gltf_skin;

enum { CWI_GLTF_CODES = 6, CWI_GLTF_PLACINGS = 3 };

typedef struct cwi_gltf_node {
    int mesh;
    size_t first, end;                /* of children */
    double local[3][4];               /* to the parent's frame */
    bool lps, has_origin, has_affine; /* flags that our writer stores in extras */
    double origin[3], affine[3][4];
    int skin;
    size_t first_weight, end_weight; /* of morph targets; none: those of the mesh */
    bool is_hidden;                  /* by KHR_node_visibility, with its children */
    int placings[CWI_GLTF_PLACINGS]; /* of EXT_mesh_gpu_instancing: accessors of translations,
                                        rotations and scales; -1: none */
    size_t levels;                   /* number of levels that MSFT_lod names */
    char *name;                      /* or NULL */
    bool has_label;                  /* as our writer stores it in extras: */
    bool has_color;
    uint32_t label, layer;
    uint64_t label_id; /* as in cw_label */
    bool label_is_negative;
    uint8_t color[4];
    char *codes
        [CWI_GLTF_CODES]; /* category and type: scheme, value and meaning of each; or NULL */
} cwi_gltf_node;

/* A zeroed scene is empty. */
typedef struct cwi_gltf_scene {
    cwi_gltf_buffer *buffers;
    cwi_gltf_view *views;
    cwi_gltf_accessor *accessors;
    cwi_gltf_primitive *primitives;
    cwi_gltf_mesh *meshes;
    cwi_gltf_node *nodes;
    cwi_gltf_material *materials;
    cwi_gltf_target *targets;
    cwi_gltf_skin *skins;
    int *children, *roots, *joints; /* nodes */
    double *weights;                /* of morph targets */
    size_t buffer_count, view_count, accessor_count, primitive_count, mesh_count, node_count,
        child_count, root_count, material_count, target_count, skin_count, joint_count,
        weight_count;
} cwi_gltf_scene;

/* Computes translation times rotation times scale. The quaternion need not have unit length. */
static inline void cwi_gltf_compose(const double translation[3], const double rotation[4],
                                    const double scale[3], double out[12])
{
    const double *q = rotation, *s = scale;
    const double f = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double turned[3][3] = {
        {1 - f * (q[1] * q[1] + q[2] * q[2]), f * (q[0] * q[1] - q[2] * q[3]),
         f * (q[0] * q[2] + q[1] * q[3])},
        {f * (q[0] * q[1] + q[2] * q[3]), 1 - f * (q[0] * q[0] + q[2] * q[2]),
         f * (q[1] * q[2] - q[0] * q[3])},
        {f * (q[0] * q[2] - q[1] * q[3]), f * (q[1] * q[2] + q[0] * q[3]),
         1 - f * (q[0] * q[0] + q[1] * q[1])}};
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            out[4 * r + c] = turned[r][c] * s[c];
        out[4 * r + 3] = translation[r];
    }
}

void cwi_gltf_scene_free(cwi_gltf_scene *scene);

/* Writes a scene as bytes, for transfer between processes; false when there is no room. The
 * second function reads it back into a zeroed scene that the caller frees. It returns
 * CW_ERR_BACKEND for impossible lengths, ranges or kinds. */
bool cwi_gltf_put_scene(const cwi_gltf_scene *scene, void *to, size_t capacity);
CW_NODISCARD cw_status cwi_gltf_take_scene(const void *from, size_t size, cwi_gltf_scene *scene,
                                           cw_error *err);

/* Checks the members of the JSON that are read: type, range, and presence of required ones.
 * Other members may hold anything.
 * Returns CW_ERR_FORMAT, which names the member as "meshes[0].primitives[1].indices". */
CW_NODISCARD cw_status cwi_gltf_check(const char *json, size_t size, cw_error *err);

/* Checks members that describe how a surface looks, which are not read.
 * Returns CW_ERR_FORMAT as cwi_gltf_check() does. */
CW_NODISCARD cw_status cwi_gltf_check_look(const char *json, size_t size, cw_error *err);

#define CWI_GLTF_HIDDEN_LOD "MSFT_LOD"

/* Sanitizes JSON for a library that trusts it. Refuses nesting deeper than 64 and more than 32
 * MiB besides strings. Renames keys that no mesh needs (images, materials, extensions, ...), so
 * that the library ignores them. The indices of primitives become their "extras", since those
 * that Draco compressed have no view. MSFT_lod becomes CWI_GLTF_HIDDEN_LOD, since a library may
 * refuse what is no list of levels. keeps_look: "materials" stay. "buffers" becomes "extras", which only describe: only
 * cwi_gltf_load() reads the bytes of buffers. */
CW_NODISCARD cw_status cwi_gltf_blind(char *json, size_t size, bool keeps_look, cw_error *err);

/* The place of the buffers' bytes. */
typedef struct cwi_gltf_bytes {
    const cwi_input *in;
    uint64_t chunk, chunk_size; /* the binary chunk of a .glb file */
    struct cwi_gltf_unpacker *unpacker;
    const cwi_gltf_primitive *unpacked; /* a decoded primitive: its arrays are here, not in the
                                           buffers */
    const struct cwi_arrays *arrays;
} cwi_gltf_bytes;

/* Copies the bytes from an offset of a buffer on, to be freed with cwi_free().
 * Returns CW_ERR_FORMAT where the buffer or its container is shorter; CW_ERR_UNSAFE,
 * CW_ERR_IO for a separate file; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_gltf_load(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                                     uint64_t buffer, uint64_t offset, uint64_t size,
                                     unsigned char **bytes, cw_error *err);

/* Returns true for a data: URI; decodes one, to be freed with cwi_free(); decodes the name of a file. */
bool cwi_gltf_is_data(const char *uri);
CW_NODISCARD cw_status cwi_gltf_load_data(const char *uri, unsigned char **bytes, size_t *size,
                                          cw_error *err);
CW_NODISCARD cw_status cwi_gltf_decode_name(const char *uri, char name[1024], cw_error *err);

/* Returns the size of a buffer's separate file; 0 when there is none. */
uint64_t cwi_gltf_file_bytes(const cwi_gltf_bytes *from, const cwi_gltf_buffer *buffer);

/* The numbers of an accessor, checked against view and buffer, one after another. */
typedef struct cwi_gltf_numbers {
    unsigned char *bytes; /* freed with cwi_free() */
    size_t count, stride;
    int component, numbers;
    bool normalized;
} cwi_gltf_numbers;

/* Opens the numbers of an accessor. what: the accessor's use, for messages: "POSITION". */
CW_NODISCARD cw_status cwi_gltf_open_numbers(const cwi_gltf_bytes *from,
                                             const cwi_gltf_scene *scene, int accessor,
                                             const char *what, cwi_gltf_numbers *numbers,
                                             cw_error *err);

/* Returns number c of element i: unchanged, or (normalized) as a fraction of its type's
 * maximum. */
double cwi_gltf_number(const cwi_gltf_numbers *numbers, size_t i, int c);

#ifdef __cplusplus
}
#endif

#endif
