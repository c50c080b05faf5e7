/* Label maps to meshes: every label a closed manifold, neighbours without a gap. */
#ifndef CUBEWRIGHT_LABELS_H
#define CUBEWRIGHT_LABELS_H

#include <cubewright/mesh.h>
#include <cubewright/stream.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Options of an extraction of labels. Zero-initialise the struct and set what you need. A zero
 * field means the default named beside it. */
typedef struct cw_labels_desc {
    uint32_t version;       /* 0: the first version of this struct */
    const uint32_t *labels; /* label_count of those wanted, in any order; others count as
                               background */
    size_t label_count;     /* default: all but the background */
    uint32_t background;    /* the label of what is no object; also beyond the volume */
    bool no_smoothing;      /* default: interfaces are smoothed together, see below */
    double max_move;        /* of a vertex by smoothing, along each axis of the grid, in voxels:
                               up to 0.5, which is the default */
    bool leave_open;        /* default: cap labels half a voxel beyond the volume's border */
    int threads;            /* default: one per processor */
    size_t max_triangles; /* fail with CW_ERR_LIMIT before allocating more; default: no limit */
    cw_progress progress; /* default: none */
} cw_labels_desc;

/* The interface of two labels: triangles of cw_label_surfaces.mesh. */
typedef struct cw_label_patch {
    uint32_t labels[2];  /* triangles wind counter-clockwise seen from labels[1]. The background
                           is the second, of other labels the larger */
    size_t first, count; /* its triangles in the mesh: the first, and their number */
} cw_label_patch;

/* A label that occurs. */
typedef struct cw_label_count {
    uint32_t label; /* its number */
    size_t voxels;  /* number of its voxels */
} cw_label_count;

/* All interfaces of a label map, which share their vertices. A zeroed struct is valid and
 * empty. */
typedef struct cw_label_surfaces {
    cw_mesh mesh;            /* without normals; not a manifold where three labels meet */
    size_t patch_count;      /* number of patches */
    cw_label_patch *patches; /* in rising order of both labels */
    size_t label_count;      /* number of labels */
    cw_label_count *labels;  /* rising, without the background */
    uint32_t background;     /* the label of what is no object */
} cw_label_surfaces;

/* Extracts the interfaces between all labels of a volume in one pass.
 *
 * Taken alone, each label is a closed, oriented manifold without triangles of zero area; the
 * interface of two labels is the same triangles for both. That holds by construction. The cubes
 * between 2 x 2 x 2 voxels are cut into six tetrahedra around the diagonal that rises along all
 * axes. The interfaces are faces of the dual cells, of which four meet in a point and three
 * along an edge, so no union of cells touches itself along an edge or in a point. Voxels of one
 * label are joined if an edge of tetrahedra joins them: along an axis, or along a diagonal that
 * rises along two or three axes. Across the other diagonals they are apart. Where a cube of
 * tetrahedra can be one point without a change of topology, it is: then the surface is that of
 * surface nets, with a vertex in the middle of the cube. At the volume's border other cubes are two
 * prisms, with a vertex each.
 *
 * Smoothing moves vertices towards the mean of those in the cubes beside, in 12 rounds, and those
 * on curves where three labels meet along the curves, each within max_move of where it was. Then
 * pressures, which move each interface along its normal by the difference of its labels'
 * pressures, preserve the volume of every label's voxels, except for open borders. Where
 * triangles would cross, vertices go back, and others make up for the volume. In cubes with more than
 * one vertex they stay. Every label has the volume of its voxels to 0.5 %, unless max_move does not
 * allow it, or it is a few voxels that touch in edges: cw_label_volumes() tells.
 *
 * Where a label reaches the volume's border, a cap closes it half a voxel beyond: flat, with straight
 * edges and sharp corners, so that those of neighbouring crops lie in one plane.
 *
 * Vertices are in the world (LPS, millimetres).
 *
 * volume    evenly spaced or rectilinear; values are whole numbers from 0 to 2^32 - 1, stored in
 *           any type. Voxels without a value are background
 * surfaces  filled on success, emptied on failure; free it with cw_label_surfaces_free()
 * Returns   CW_ERR_ARGUMENT  a value is no label, naming the voxel; max_move is out of range; as
 *           cw_volume_resolve()
 *           CW_ERR_UNSUPPORTED  sparse and irregular grids; CW_ERR_LIMIT: max_triangles, or
 *           2^32 - 1 vertices; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost      two passes over the voxels, and time in proportion to the interfaces
 * Threads   the same bytes for any number
 * Source    surface nets [Gibson1998]; tetrahedra [Freudenthal1942]; dual cells as regular
 *           neighbourhoods [RourkeSanderson1972] */
CW_NODISCARD CW_API cw_status cw_extract_labels(const cw_volume *volume,
                                                const cw_labels_desc *desc,
                                                cw_label_surfaces *surfaces, cw_error *err);

/* Extracts labels as cw_extract_labels() does, to the bit, from slices that are read twice. In
 * memory are some slices, and the surfaces.
 *
 * source   borrowed; at least 1 voxel along each axis
 * Returns  as cw_extract_labels(); or what source returned
 * Cost     memory: 32 MiB of slices, or 19 if those are more; 22 bytes a thread for each voxel of a
 *          slice; the surfaces, whose arrays may go to files with cw_memory_overflow() */
CW_NODISCARD CW_API cw_status cw_extract_labels_stream(const cw_slice_source *source,
                                                       const cw_labels_desc *desc,
                                                       cw_label_surfaces *surfaces,
                                                       cw_error *err);

/* Counts and costs of an extraction of labels. */
typedef struct cw_label_prediction {
    size_t labels;    /* that occur, but the background */
    size_t patches;   /* interfaces of two labels */
    size_t vertices;  /* of all interfaces */
    size_t triangles; /* of all interfaces, each once */
    size_t
        own_triangles; /* of all labels' own meshes: a triangle between two labels is in both */
    size_t bytes;      /* of the surfaces and the working memory together, about; without the
                             voxels */
} cw_label_prediction;

/* Counts what cw_extract_labels() would make, without making it. Counts are exact, and
 * desc->max_triangles is ignored.
 *
 * prediction  filled on success
 * Returns     as cw_extract_labels()
 * Cost        one pass over the voxels */
CW_NODISCARD CW_API cw_status cw_extract_labels_predict(const cw_volume *volume,
                                                        const cw_labels_desc *desc,
                                                        cw_label_prediction *prediction,
                                                        cw_error *err);

/* Counts what cw_extract_labels_stream() would make, from slices that are read once.
 *
 * source      borrowed
 * prediction  filled on success
 * Returns     as cw_extract_labels_stream()
 * Cost        as cw_extract_labels_stream(), without the surfaces */
CW_NODISCARD CW_API cw_status cw_extract_labels_stream_predict(const cw_slice_source *source,
                                                               const cw_labels_desc *desc,
                                                               cw_label_prediction *prediction,
                                                               cw_error *err);

/* The rule for the background: how large a field of labels must be. */
typedef enum cw_background_rule {
    CW_BACKGROUND_VALUE, /* a value that a label's field must exceed: for fields that are made one by
                            one, such as sigmoids, whose sum may be anything */
    CW_BACKGROUND_FIELD, /* a field of its own, that of the label cw_labels_desc.background: for
                            softmax outputs, whose first channel it is as a rule */
    CW_BACKGROUND_REST, /* 1 minus the sum of all fields: for such outputs without that channel */
    CW_BACKGROUND_RULE_COUNT
} cw_background_rule;

/* Fields of labels: at each voxel the label of the largest is there. They are probabilities, or any
 * scores that can be compared. Zero-initialise the struct and set what you need. */
typedef struct cw_label_scores {
    uint32_t version; /* 0: the first version of this struct */
    const cw_volume
        *fields;  /* count of them, in one grid, of any types: the first component and step of
                                each. Several components of a volume: cw_volume_select() */
    size_t count; /* number of fields: 1 or more */
    const uint32_t *labels;   /* count: the label of each; default: their numbers, from 0 with
                                CW_BACKGROUND_FIELD, else from 1 */
    const char *const *names; /* count, for messages; default: none */
    cw_background_rule rule;  /* default: CW_BACKGROUND_VALUE */
    double value;             /* with CW_BACKGROUND_VALUE and has_value; default: 0.5 */
    bool has_value;           /* value is set */
} cw_label_scores;

/* Extracts the interfaces between the labels of fields, where neighbouring labels' fields are equal.
 *
 * The label of a voxel is that of the largest field, of equal ones that of the first; the background's
 * value or rest is before all. Fields without a value at a voxel (NaN, no-data) are left out there, and
 * without any it is background. This map has the interfaces of cw_extract_labels(), with all that
 * is said there of closed, oriented manifolds and of caps at the border.
 *
 * Vertices then go to where the fields are. On edges of a cube whose ends have different labels, fields
 * are linear, and their two labels' are equal in one point. From the mean of those points a vertex goes
 * on to where the fields of all labels of its cube are equal, as trilinear functions there, by steps of
 * Gauss and Newton. It stays within max_move of the cube's middle, and in its cube. In cubes of several
 * vertices each stands in the mean of the points of its tetrahedra's edges. Where triangles would cross,
 * vertices go back to their cubes' middles. Surfaces are not smoothed, and volumes are those of
 * the fields, not of the voxels.
 *
 * fields    borrowed
 * desc      as for cw_extract_labels(); labels that are not wanted are background, too.
 *           no_smoothing leaves vertices in the middle of their cubes
 * surfaces  filled on success, emptied on failure; free it with cw_label_surfaces_free(). The voxels of
 *           labels are those of the largest field
 * Returns   CW_ERR_ARGUMENT  no fields; grids that differ, naming two fields; a label twice, or that of the
 *           background where no field is its; no field has it with CW_BACKGROUND_FIELD; no such
 *           rule; a value that is not finite; else as cw_extract_labels()
 * Cost      one pass over the fields, then as cw_extract_labels() of a map of 1, 2 or 4 bytes a voxel, which
 *           is made. CW_BACKGROUND_REST takes 4 bytes a voxel more
 * Threads   the same bytes for any number
 * Source    points on edges of several materials [JuLosassoSchaeferWarren2002]; surface nets
 *           [Gibson1998] */
CW_NODISCARD CW_API cw_status cw_extract_label_scores(const cw_label_scores *fields,
                                                      const cw_labels_desc *desc,
                                                      cw_label_surfaces *surfaces,
                                                      cw_error *err);

/* Makes the label map of the largest fields, as cw_extract_label_scores() has it.
 *
 * fields      borrowed
 * background  the label of what is no object
 * threads     0: one per processor
 * map         filled with CW_U8, CW_U16 or CW_U32, as the largest label needs it; emptied on failure. Free
 *             it with cw_volume_free()
 * Returns     as cw_extract_label_scores() */
CW_NODISCARD CW_API cw_status cw_label_scores_largest(const cw_label_scores *fields,
                                                      uint32_t background, int threads,
                                                      cw_volume *map, cw_error *err);

/* Counts the voxels of all labels but the background.
 *
 * volume      as for cw_extract_labels()
 * background  the label that is not counted
 * counts      set to *count of them, in rising order; free it with cw_label_counts_free()
 * Returns     as cw_extract_labels()
 * Cost        one pass over the voxels */
CW_NODISCARD CW_API cw_status cw_label_counts(const cw_volume *volume, uint32_t background,
                                              cw_label_count **counts, size_t *count,
                                              cw_error *err);

/* Frees the counts of cw_label_counts(). Harmless on NULL. */
CW_API void cw_label_counts_free(cw_label_count *counts);

/* Options of cleaning a label map. Zero-initialise the struct and set what you need. */
typedef struct cw_label_clean_desc {
    uint32_t version;    /* 0: the first version of this struct */
    uint32_t background; /* the label of what is no object */
    size_t
        min_voxels; /* components of labels with fewer voxels go to a neighbour; default: none do */
    size_t largest; /* components of each label that stay, those of most voxels; default: all */
    bool
        fill_voids; /* background that lies in one label, without a way to the volume's border, goes to
                            it; default: it stays */
} cw_label_clean_desc;

/* A label before and after cleaning. */
typedef struct cw_label_change {
    uint32_t label;            /* its number */
    size_t voxels_before;      /* number of its voxels in the map */
    size_t voxels;             /* and in the cleaned one */
    size_t components_removed; /* of it, which went to neighbours */
    size_t voxels_removed;     /* of those */
    size_t voxels_added;       /* of voids, and of other labels' components */
} cw_label_change;

/* Removes small components of labels, and fills voids. A component is a set of voxels that are joined as
 * cw_extract_labels() joins them, so it is one of the label's surface. One that goes gets the label,
 * or the background, with which it shares the most faces; of equal ones the lowest. Components among
 * others that go follow when those have gone. Voids are filled first.
 *
 * volume   as for cw_extract_labels(); its first component and step
 * desc     borrowed
 * cleaned  filled with CW_U32 on success, emptied on failure; free it with cw_volume_free()
 * changes  set to *count of them, one a label in rising order; free it with cw_label_changes_free(). Both
 *          may be NULL
 * count    their number
 * Returns  CW_ERR_ARGUMENT: a value is no label, naming the voxel; CW_ERR_UNSUPPORTED: sparse and irregular
 *          grids; CW_ERR_LIMIT; CW_ERR_NO_MEMORY
 * Cost     two passes over the voxels, and 16 bytes for each run of a label in a row
 * Source   union of sets [TarjanVanLeeuwen1984] */
CW_NODISCARD CW_API cw_status cw_labels_clean(const cw_volume *volume,
                                              const cw_label_clean_desc *desc,
                                              cw_volume *cleaned, cw_label_change **changes,
                                              size_t *count, cw_error *err);

/* Frees the changes of cw_labels_clean(). Harmless on NULL. */
CW_API void cw_label_changes_free(cw_label_change *changes);

/* How a label map is sampled between its voxels. */
typedef enum cw_label_kernel {
    CW_LABEL_KERNEL_MAJORITY, /* the label with the largest share of a Gaussian around */
    CW_LABEL_KERNEL_NEAREST,  /* the label of the nearest voxel */
    CW_LABEL_KERNEL_COUNT
} cw_label_kernel;

/* Returns the name of a kernel, such as "majority"; static. NULL for an unknown one.
 * kernel  any number */
CW_API const char *cw_label_kernel_name(cw_label_kernel kernel);

/* Options of sampling a label map at other distances. Zero-initialise the struct and set what you need. */
typedef struct cw_label_resample_desc {
    uint32_t version;       /* 0: the first version of this struct */
    double spacing_mm[3];   /* new distance of voxels along each axis; 0: as it is */
    cw_label_kernel kernel; /* default: CW_LABEL_KERNEL_MAJORITY */
    uint32_t background;    /* the label of voxels without a value */
    int threads;            /* default: one per processor */
    size_t max_bytes;       /* memory for the result and the work on it; default: no limit */
    cw_progress progress;   /* default: none */
} cw_label_resample_desc;

/* Samples a label map at other distances. The grid is that of cw_volume_resample(): the first voxel stays
 * where it is, and the last sample is not beyond the last voxel.
 *
 * By majority, a sample gets the label whose voxels have the largest sum of weights. The weight of a
 * voxel is a Gaussian of its distance, cut off at four standard deviations. Along each axis one is
 * half of the old or the new distance between voxels, whichever is larger. Beyond the border voxels go
 * on as they are there. Of equal sums the label of the nearest voxel wins, else the lowest. Of two
 * voxels as near as each other the one of the lower index counts as the nearest. The background is a label
 * like others. No label appears where none of its voxels is within reach. Parts that are thinner than
 * the new distance may vanish.
 *
 * volume   as for cw_extract_labels(); its first component and step. The result of a rectilinear grid is
 *          evenly spaced, and voxels weigh by their index
 * desc     borrowed
 * out      filled with CW_U32 on success, emptied on failure; free it with cw_volume_free()
 * Returns  CW_ERR_ARGUMENT: a value is no label, naming the voxel; spacing_mm is not above 0; there
 *          is no such kernel; CW_ERR_UNSUPPORTED: sparse and irregular grids; CW_ERR_LIMIT: max_bytes is too low;
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     one pass over the voxels, and up to 125 weights a voxel where labels meet; memory: a thread
 *          holds some rows of some slices
 * Threads  the same bytes for any number */
CW_NODISCARD CW_API cw_status cw_labels_resample(const cw_volume *volume,
                                                 const cw_label_resample_desc *desc,
                                                 cw_volume *out, cw_error *err);

/* Frees the surfaces and zeroes the struct. Harmless on a zeroed or already freed one. */
CW_API void cw_label_surfaces_free(cw_label_surfaces *surfaces);

/* Copies the closed mesh of one label out of the interfaces, seen from outside. A label without
 * voxels gives an empty mesh and CW_OK.
 * label    one of surfaces->labels
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * Returns  CW_ERR_NO_MEMORY
 * Cost     in proportion to the patches, and to the label's triangles */
CW_NODISCARD CW_API cw_status cw_label_mesh(const cw_label_surfaces *surfaces, uint32_t label,
                                            cw_mesh *mesh, cw_error *err);

/* Copies one patch, with the vertices that its triangles name: seen from labels[1].
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_label_patch_mesh(const cw_label_surfaces *surfaces,
                                                  const cw_label_patch *patch, cw_mesh *mesh,
                                                  cw_error *err);

/* Makes one mesh of all interfaces for a picture. Each is there once, so that no two triangles lie
 * in one place: in the colour of the more opaque of its two labels (of equal ones the first), and
 * seen from outside of that. An interface of two labels with opacity 0, or of one with the
 * background, is left out. Where labels meet, each has vertices of its own: edges are sharp.
 * colors   label_count x 4, of surfaces->labels: sRGB and opacity
 * mesh     filled on success, emptied on failure; with normals, colours, and the label that each
 *          vertex belongs to, whose triangles follow each other. Free it with cw_mesh_free()
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_LIMIT: 2^32 - 1 vertices
 * Cost     in proportion to the triangles */
CW_NODISCARD CW_API cw_status cw_label_colored_mesh(const cw_label_surfaces *surfaces,
                                                    const uint8_t (*colors)[4], cw_mesh *mesh,
                                                    cw_error *err);

/* Returns the area of a patch in square millimetres. */
CW_API double cw_label_patch_area(const cw_label_surfaces *surfaces,
                                  const cw_label_patch *patch);

/* Measures the volumes that the surfaces of all labels enclose, in cubic millimetres. Volumes of labels
 * that are open at the volume's border mean nothing.
 * volumes  filled: label_count, of surfaces->labels
 * Cost     in proportion to the triangles */
CW_API void cw_label_volumes(const cw_label_surfaces *surfaces, double *volumes);

/* Targets of a simplification of label surfaces. Zero-initialise the struct and set what you
 * need. At least one of error_mm, triangles and ratio is needed. The first one reached ends the
 * simplification. */
typedef struct cw_label_simplify_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double error_mm;      /* no point of a patch, before or after, is farther than this from the
                             same patch of the other surfaces; default: no such promise */
    size_t triangles;     /* stop at this number of triangles; default: no limit */
    double ratio;         /* the same as a fraction of the input's; above 0, below 1; default:
                             none */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_label_simplify_desc;

/* Simplifies all interfaces of a label map together by edge collapses, those first that move
 * them least. Patches share their vertices afterwards as before, so neighbours stay without a
 * gap.
 *
 * The complex of all patches stays homeomorphic to the input, with its curves and points. So
 * each label taken alone is closed, oriented and a manifold where it was, with as many
 * components and handles. No label is lost. Where patches meet, vertices move along their curve
 * alone. Points where curves meet or end stay where they are, and borders stay borders. No
 * triangle loses its area, or turns by more than 78 degrees in a collapse. No triangles meet
 * that did not meet before, and no part changes to the other side of a surface.
 *
 * With triangles or ratio alone the result may have more triangles than requested. That happens
 * where every edge that is left would break one of these rules.
 *
 * in       borrowed; such as from cw_extract_labels(). Patches are in order, and each triangle
 *          is in one
 * out      the same labels and patches, without attributes of vertices; filled on success,
 *          emptied on failure. Free it with cw_label_surfaces_free()
 * Returns  CW_ERR_ARGUMENT  no target; a target that is negative or not finite; patches that do
 *          not cover the triangles; a triangle that names a vertex twice; as cw_mesh_check()
 *          CW_ERR_LIMIT  beyond 2^32 / 3 triangles or vertices; CW_ERR_NO_MEMORY;
 *          CW_ERR_CANCELLED
 * Cost     a few microseconds of one processor for a triangle that is removed
 * Threads  the same bytes for any number
 * Source   link condition [Dey1999]; quadrics [Garland1997] */
CW_NODISCARD CW_API cw_status cw_label_simplify(const cw_label_surfaces *in,
                                                const cw_label_simplify_desc *desc,
                                                cw_label_surfaces *out, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
