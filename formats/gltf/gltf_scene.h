/* What a glTF file says, as plain numbers: the parts of it that a mesh needs. Nothing here has
 * been checked; indices are as in the file, -1 where there is none. */
#ifndef FORMATS_GLTF_GLTF_SCENE_H
#define FORMATS_GLTF_GLTF_SCENE_H

#include "formats/mesh/mesh_reader.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_gltf_buffer {
    char *uri;      /* NULL: the binary chunk */
    uint64_t bytes; /* as the JSON says */
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

/* Elements that take the place of others. */
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
    int numbers;   /* 1 to 4; 0: a matrix */
    bool normalized;
    cwi_gltf_sparse sparse;
} cwi_gltf_accessor;

typedef struct cwi_gltf_primitive {
    int mode; /* 0 to 6 */
    int indices, position, normal, color;
    int draco; /* the view of KHR_draco_mesh_compression; -1: not compressed */
    int draco_position, draco_normal, draco_color; /* Draco's numbers for attributes; or -1 */
} cwi_gltf_primitive;

typedef struct cwi_gltf_mesh {
    size_t first, end; /* of primitives */
} cwi_gltf_mesh;

typedef struct cwi_gltf_node {
    int mesh;
    size_t first, end;                /* of children */
    double local[3][4];               /* to the parent's frame */
    bool lps, has_origin, has_affine; /* what our writer leaves in extras */
    double origin[3], affine[3][4];
    size_t levels; /* that MSFT_lod names */
} cwi_gltf_node;

/* A zeroed scene is empty. */
typedef struct cwi_gltf_scene {
    cwi_gltf_buffer *buffers;
    cwi_gltf_view *views;
    cwi_gltf_accessor *accessors;
    cwi_gltf_primitive *primitives;
    cwi_gltf_mesh *meshes;
    cwi_gltf_node *nodes;
    int *children, *roots; /* nodes */
    size_t buffer_count, view_count, accessor_count, primitive_count, mesh_count, node_count,
        child_count, root_count;
} cwi_gltf_scene;

void cwi_gltf_scene_free(cwi_gltf_scene *scene);

/* A scene as bytes, to leave a process: false when there is no room. And back, into a zeroed
 * scene that the caller frees: CW_ERR_BACKEND for lengths, ranges or kinds that cannot be. */
bool cwi_gltf_put_scene(const cwi_gltf_scene *scene, void *to, size_t room);
CW_NODISCARD cw_status cwi_gltf_take_scene(const void *from, size_t size, cwi_gltf_scene *scene,
                                           cw_error *err);

/* Holds JSON against the members that are read of it: type, range, and that what must be there
 * is. What is not read may hold anything.
 * Returns CW_ERR_FORMAT, which names the member as "meshes[0].primitives[1].indices". */
CW_NODISCARD cw_status cwi_gltf_check(const char *json, size_t size, cw_error *err);

/* Makes JSON fit for a library that trusts it: refuses nesting deeper than 64 and more than 32
 * MiB beside strings, and renames what no mesh needs (images, materials, extensions, ...), so
 * that it is never looked at. The indices of primitives become their "extras", for those that
 * Draco compressed have no view. "buffers" becomes "extras", which only describes: the bytes of
 * buffers are for cwi_gltf_load() alone. */
CW_NODISCARD cw_status cwi_gltf_blind(char *json, size_t size, cw_error *err);

/* Where the bytes of buffers are. */
typedef struct cwi_gltf_bytes {
    const cwi_input *in;
    uint64_t chunk, chunk_size; /* the binary chunk of a .glb file */
    struct cwi_gltf_unpacker *unpacker;
    const cwi_gltf_primitive *unpacked; /* the one whose arrays are these, not the buffers' */
    const struct cwi_arrays *arrays;
} cwi_gltf_bytes;

/* The bytes from an offset of a buffer on: copied, to be freed with cwi_free().
 * Returns CW_ERR_FORMAT where the buffer or what holds it is shorter; CW_ERR_UNSAFE,
 * CW_ERR_IO for a file of its own; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_gltf_load(const cwi_gltf_bytes *from, const cwi_gltf_scene *scene,
                                     uint64_t buffer, uint64_t offset, uint64_t size,
                                     unsigned char **bytes, cw_error *err);

/* The size of the file that a buffer has of its own; 0 when there is none. */
uint64_t cwi_gltf_file_bytes(const cwi_gltf_bytes *from, const cwi_gltf_buffer *buffer);

/* The numbers of an accessor, checked against view and buffer, one after another. */
typedef struct cwi_gltf_numbers {
    unsigned char *bytes; /* freed with cwi_free() */
    size_t count, stride;
    int component, numbers;
    bool normalized;
} cwi_gltf_numbers;

/* what names the accessor's use in messages: "POSITION". */
CW_NODISCARD cw_status cwi_gltf_open_numbers(const cwi_gltf_bytes *from,
                                             const cwi_gltf_scene *scene, int accessor,
                                             const char *what, cwi_gltf_numbers *numbers,
                                             cw_error *err);

/* Number c of element i: as it is, or (normalized) as a share of its type's largest. */
double cwi_gltf_number(const cwi_gltf_numbers *numbers, size_t i, int c);

#ifdef __cplusplus
}
#endif

#endif
