/* Analytic fields with known surfaces, sampled into volumes for trying and testing. */
#ifndef CUBEWRIGHT_FIELD_H
#define CUBEWRIGHT_FIELD_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One row per field: constant, name, isovalue of its surface, range of values, millimetres it
 * spans along a volume's longest axis, what it is. */
#define CW_FIELD_TABLE(X)                                                                      \
    X(CW_FIELD_SPHERE, "sphere", 0, -60, 60, 80,                                               \
      "distance to a sphere of radius 30 mm, positive inside")                                 \
    X(CW_FIELD_TORUS, "torus", 0, -60, 60, 80,                                                 \
      "distance to a torus of radii 26 and 10 mm, positive inside")                            \
    X(CW_FIELD_PLANE, "plane", 0, -60, 60, 80, "distance to a plane tilted against all axes")  \
    X(CW_FIELD_GYROID, "gyroid", 0, -1.5, 1.5, 80, "the gyroid, 2.5 periods: high genus")      \
    X(CW_FIELD_MARSCHNER_LOBB, "marschner-lobb", 0.5, 0, 1, 2,                                 \
      "the test signal of [Marschner1994], on its own cube of 2 mm")                           \
    X(CW_FIELD_CT_HEAD, "ct-head", 300, -1024, 2000, 240,                                      \
      "a CT head phantom in HU: skin at -300, bone at 300")

/* The fields. */
typedef enum cw_field {
#define CW_FIELD_ENUM(name, text, iso, low, high, span, about) name,
    CW_FIELD_TABLE(CW_FIELD_ENUM)
#undef CW_FIELD_ENUM
        CW_FIELD_COUNT
} cw_field;

/* Options of cw_field_sample(). Zero fields mean the default named beside them. */
typedef struct cw_field_desc {
    uint32_t version; /* 0: the first version of this struct */
    cw_field field;   /* default: the sphere */
    size_t dim[3];    /* voxels; default 64 each */
    cw_type type;     /* CW_U8 first: name it */
    double noise;  /* standard deviation of Gaussian noise, in the field's unit; default none */
    uint64_t seed; /* of the noise */
    int threads;   /* default: all */
    cw_progress progress; /* default: none */
} cw_field_desc;

/* Returns the fields of a row of CW_FIELD_TABLE; static. */
CW_API const char *cw_field_name(cw_field field);
CW_API const char *cw_field_about(cw_field field);
CW_API double cw_field_isovalue(cw_field field);

/* Finds a field by its name. Returns false if none has it.
 * field  set on success */
CW_API bool cw_field_find(const char *name, cw_field *field);

/* Returns the field's value at a world point in millimetres. */
CW_API double cw_field_value(cw_field field, const double world[3]);

/* Returns the voxel value that stores a value of the field in a volume of a type. Floats, and
 * CT in types that hold -1024 to 2000, keep the value. CT in u16 and u32 adds 1024. Otherwise
 * the field's range is spread over 0..255, -128..127, 0..65535 or -32768..32767, whichever the
 * type holds. */
CW_API double cw_field_stored(cw_field field, cw_type type, double value);

/* Samples a field into a new volume centred on the world's zero, rounded for integer types.
 * Returns CW_ERR_ARGUMENT for an unknown field or type, CW_ERR_LIMIT,
 * CW_ERR_NO_MEMORY, CW_ERR_CANCELLED.
 * The same bytes for the same desc, for any number of threads. */
CW_NODISCARD CW_API cw_status cw_field_sample(const cw_field_desc *desc, cw_volume *volume,
                                              cw_error *err);

/* The form of the objects of a made label map. */
typedef enum cw_label_field {
    CW_LABEL_CELLS,  /* what is nearest to each of many points, in a ball: cells that touch */
    CW_LABEL_SPHERES /* spheres around the points, some of which touch */
} cw_label_field;

/* Options of cw_label_field_sample(). Zero fields mean the default named beside them. */
typedef struct cw_label_field_desc {
    uint32_t version;     /* 0: the first version of this struct */
    cw_label_field field; /* default: cells */
    size_t dim[3];        /* voxels; default 64 each */
    cw_type type;         /* CW_U8 first: name it; it has to hold the labels */
    size_t labels;        /* number of points, one to a cell of a lattice; default 100 */
    uint64_t seed;        /* of the points and radii */
    int threads;          /* default: all */
    cw_progress progress; /* default: none */
} cw_label_field_desc;

/* Samples a label map into a new volume of voxels of 1 mm, centred on the world's zero. Labels
 * are 1 to desc->labels, and 0 is the background. In a small volume some labels have no voxels.
 * Returns CW_ERR_ARGUMENT for an unknown form, and a type that does not hold the labels;
 * CW_ERR_LIMIT, CW_ERR_NO_MEMORY, CW_ERR_CANCELLED.
 * The same bytes for the same desc, for any number of threads.
 * Source  points in a lattice [Worley1996] */
CW_NODISCARD CW_API cw_status cw_label_field_sample(const cw_label_field_desc *desc,
                                                    cw_volume *volume, cw_error *err);

/* How far the points of a mesh are from the exact surface { p : f(p) = isovalue } of a field,
 * over its area. */
typedef struct cw_field_error {
    size_t samples, missed; /* points measured; points from which no surface was reached */
    double max_mm, rms_mm;  /* the largest distance; root of the mean square */
    double p99_mm;          /* 99 % of the area is nearer; known to a thousandth of a voxel */
} cw_field_error;

/* Measures a mesh at its vertices and in the middle of its triangles. Each point walks along the
 * field's gradient by Newton's method, in steps of at most a voxel, until it is on the surface.
 *
 * voxel_mm  the voxels that the mesh was made from: sets the steps
 * mesh      borrowed
 * out       zeroed on failure
 * Returns   CW_ERR_ARGUMENT  an unknown field, isovalue not finite, voxel_mm not above 0, or as
 *                            cw_mesh_check(); CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_field_measure(cw_field field, double isovalue, double voxel_mm,
                                               const cw_mesh *mesh, cw_field_error *out,
                                               cw_error *err);

/* Distances of vertices from that surface, and angles between their normals and its own. */
typedef struct cw_field_vertex_error {
    size_t count, missed;     /* measured; without a surface that is reached */
    double mean_mm, max_mm;   /* distances */
    bool has_normals;         /* the mesh has normals; if not, the angles are 0 */
    double mean_deg, max_deg; /* between lines: their directions do not matter */
} cw_field_vertex_error;

/* Measures every n-th vertex of a mesh, as cw_field_measure() does.
 * voxel_mm  as in cw_field_measure()
 * every     n; 1: all vertices
 * out       filled on success
 * Returns   as cw_field_measure(), and CW_ERR_ARGUMENT for an `every` of 0 */
CW_NODISCARD CW_API cw_status cw_field_measure_vertices(cw_field field, double isovalue,
                                                        double voxel_mm, const cw_mesh *mesh,
                                                        size_t every,
                                                        cw_field_vertex_error *out,
                                                        cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
