/* The state of reading a glTF scene into a mesh, which the parts of the reader share. */
#ifndef FORMATS_GLTF_GLTF_READER_H
#define FORMATS_GLTF_GLTF_READER_H

#include "formats/gltf/gltf_decompress.h"
#include "formats/gltf/gltf_scene.h"
#include "formats/mesh/face_colors.h"

/* A skin at rest: the maps of its joints, from the mesh to LPS millimetres. */
typedef struct cwi_gltf_pose {
    double (*joints)[12]; /* count of them; NULL: not computed yet */
    size_t count;
    bool is_hidden; /* every joint has a scale of 0 */
} cwi_gltf_pose;

/* A mesh that a node of the scene places. */
typedef struct cwi_gltf_instance {
    int mesh;
    const cwi_gltf_node *node;
    size_t number;          /* among the instances of its node, from 1 on; 0: it is the node */
    double transform[3][4]; /* to LPS millimetres */
    bool unturned;          /* only a translation */
    const cwi_gltf_pose *pose; /* it places the vertices; NULL: the transform does */
} cwi_gltf_instance;

/* The elements that drawing a mesh adds, as the file states them. */
typedef struct cwi_gltf_drawing {
    uint64_t vertices, triangles, displaced; /* displaced: vertices of morph targets */
    bool counted;
} cwi_gltf_drawing;

/* The opened arrays of a primitive. */
typedef struct cwi_gltf_shape {
    cwi_gltf_numbers position, normal, color, place, indices;
    double *morphed[2]; /* positions and normals of morphed vertices, 3 each; NULL: unchanged */
    cwi_gltf_numbers joints[CWI_GLTF_SETS], weights[CWI_GLTF_SETS];
    size_t sets;    /* sets of joints that place the vertices */
    bool is_loaded; /* all are open that are used */
} cwi_gltf_shape;

/* Features of a scene that viewers apply, and this reader does not. */
enum {
    CWI_GLTF_PACKED_SKINS = 1,      /* those of meshes that Draco compressed */
    CWI_GLTF_INSTANCED_SKINS = 2,   /* those of nodes with instances */
    CWI_GLTF_MORPHED_COLORS = 4,    /* colours of morph targets */
    CWI_GLTF_OTHER_SETS = 8,        /* pictures by further sets of texture coordinates */
    CWI_GLTF_OTHER_TRANSFORMS = 16, /* those that differ among a material's pictures */
    CWI_GLTF_OTHER_WRAPS = 32       /* a texture that is mirrored, or repeated along one side */
};

/* The pictures of a material, and how they lie on the surface. */
typedef struct cwi_gltf_look {
    double transform[2][3]; /* of texture coordinates, ... */
    bool moves;             /* ... unless it changes nothing */
    uint32_t textures;      /* of the file's sets of pictures; 0: none */
} cwi_gltf_look;

typedef struct cwi_gltf_reader {
    cwi_mesh_input *in;
    cwi_gltf_bytes bytes;
    cwi_gltf_unpacker unpacker;
    cwi_arrays arrays; /* of the primitive that was decoded last */
    cwi_gltf_scene scene;
    double (*world)[12]; /* of each node */
    bool *visited;       /* of each node: it is in the scene, and world is set */
    cwi_gltf_instance *instances;
    size_t instance_count, instance_capacity;
    cwi_gltf_pose *poses;       /* of each skin */
    cwi_gltf_drawing *drawings; /* of each mesh */
    cwi_gltf_drawing drawn;     /* repeatedly, by all instances so far */
    cwi_gltf_shape *shapes;     /* of the primitives of a mesh that is drawn repeatedly, ... */
    size_t shape_count;
    bool keeps_shapes;    /* ... which stay open for the next instance of its node */
    bool is_mirrored;     /* the vertices added last have their triangles reversed */
    unsigned not_applied; /* features */
    bool shifted;         /* every instance is moved by the mesh's origin, and nothing else */
    uint64_t max;         /* maximum of vertices, and of triangles, that may be drawn */
    cwi_mesh_build build;
    float *normals;            /* room for one per point; NULL: none so far */
    uint8_t *colors;           /* of vertices, where a primitive has COLOR_0 */
    cwi_face_colors materials; /* colours of triangles by their materials */
    bool any_base;             /* some material has a base colour that counts */
    bool has_colors;           /* of what was drawn */
    cwi_gltf_look *looks;      /* of materials; NULL: none has pictures */
    float *places;             /* of vertices x 2, where a primitive has TEXCOORD_0 */
    size_t normal_capacity, color_capacity, place_capacity;
    bool no_normals; /* some primitive has none: then none are kept */
} cwi_gltf_reader;

/* Walks over the scene's nodes, and finds those that have a mesh, and its transform.
 * Returns CW_ERR_FORMAT for nodes that are no forest, or nest too deeply. */
CW_NODISCARD cw_status cwi_gltf_find_instances(cwi_gltf_reader *r, cw_mesh_file *metadata,
                                               cw_error *err);

/* Counts another drawing of a node's mesh, before it is drawn.
 * Returns CW_ERR_LIMIT where the scene repeats its meshes too often. */
CW_NODISCARD cw_status cwi_gltf_count_drawing(cwi_gltf_reader *r, const cwi_gltf_node *node,
                                              cw_error *err);

/* The map of glTF's metres, +Y up, to LPS millimetres. */
extern const double cwi_gltf_to_lps[12];

/* Multiplies two affine maps: the result applies b first. */
void cwi_gltf_multiply(const double *a, const double *b, double *out);

/* Adds an instance of a node's mesh with a map to the scene. number: as in cwi_gltf_instance. */
CW_NODISCARD cw_status cwi_gltf_place(cwi_gltf_reader *r, const cwi_gltf_node *node,
                                      const double *world, size_t number,
                                      cw_mesh_file *metadata, cw_error *err);

/* Adds the instances that EXT_mesh_gpu_instancing gives a node. */
CW_NODISCARD cw_status cwi_gltf_place_instances(cwi_gltf_reader *r, const cwi_gltf_node *node,
                                                const double *world, cw_mesh_file *metadata,
                                                cw_error *err);

/* Returns true if a skin moves the primitives of a node's mesh. */
bool cwi_gltf_is_skinned(const cwi_gltf_reader *r, const cwi_gltf_node *node);

/* Poses the instances that have skins, when all nodes of the scene have their place.
 * Returns CW_ERR_FORMAT for joints or matrices that do not fit, CW_ERR_LIMIT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_gltf_pose_skins(cwi_gltf_reader *r, cw_mesh_file *metadata,
                                           cw_error *err);
void cwi_gltf_free_poses(cwi_gltf_reader *r);

/* Opens the joints and weights of a primitive with `count` vertices, if a skin moves it. */
CW_NODISCARD cw_status cwi_gltf_open_influences(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                                const cwi_gltf_primitive *p, size_t count,
                                                cwi_gltf_shape *shape, cw_error *err);

/* Computes the map of vertex v to LPS millimetres: the weighted sum of its joints' maps.
 * Returns CW_ERR_FORMAT for a joint that the skin does not have, or a negative weight. */
CW_NODISCARD cw_status cwi_gltf_blend_joints(const cwi_gltf_pose *pose,
                                             const cwi_gltf_shape *shape, size_t v,
                                             double out[12], cw_error *err);

/* Computes the positions, or the normals, of a primitive that weights of morph targets displace:
 * 3 for each of the numbers. *morphed stays NULL where none does. */
CW_NODISCARD cw_status cwi_gltf_morph(cwi_gltf_reader *r, const cwi_gltf_node *node,
                                      const cwi_gltf_primitive *p, bool normals,
                                      const cwi_gltf_numbers *numbers, double **morphed,
                                      cw_mesh_file *metadata, cw_error *err);

/* Opens an accessor of `count` elements of min to max numbers. what: its use, for messages. */
CW_NODISCARD cw_status cwi_gltf_open_attribute(const cwi_gltf_reader *r, int accessor,
                                               const char *what, size_t count, int min, int max,
                                               cwi_gltf_numbers *numbers, cw_error *err);

/* Adds the vertices of a primitive that an instance places. */
CW_NODISCARD cw_status cwi_gltf_add_vertices(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                             const cwi_gltf_primitive *p, cwi_gltf_shape *shape,
                                             cw_mesh_file *metadata, cw_error *err);

/* Adds the vertices and triangles of one instance. */
CW_NODISCARD cw_status cwi_gltf_add_instance(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                             cw_mesh_file *metadata, cw_error *err);

/* Closes the arrays that stay open for the next instance. */
void cwi_gltf_free_shapes(cwi_gltf_reader *r);

/* Parses the JSON of a file with textures, before cwi_gltf_blind(). Returns NULL for one without. Free
 * it with cwi_gltf_free_materials(). */
struct json_t *cwi_gltf_keep_materials(const char *json, size_t size);
void cwi_gltf_free_materials(struct json_t *root);

/* Reads the pictures of materials, when the scene is there. Pictures whose files are missing are left out. */
CW_NODISCARD cw_status cwi_gltf_read_materials(cwi_gltf_reader *r, struct json_t *root,
                                               cw_error *err);

/* Returns how the pictures of a primitive lie; NULL: it has none. */
const cwi_gltf_look *cwi_gltf_look_of(const cwi_gltf_reader *r, const cwi_gltf_primitive *p);

/* Returns the material of a primitive, or NULL. */
const cwi_gltf_material *cwi_gltf_material_of(const cwi_gltf_reader *r,
                                              const cwi_gltf_primitive *p);

/* Converts the base colour of a material to sRGB and opacity; that of NULL is white. */
void cwi_gltf_base_color(const cwi_gltf_material *m, uint8_t color[4]);

/* Returns CW_ERR_LIMIT for more vertices or triangles than r->most. */
CW_NODISCARD cw_status cwi_gltf_limit(const cwi_gltf_reader *r, uint64_t count, cw_error *err);

#endif
