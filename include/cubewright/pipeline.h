/* A volume to a finished surface in one call: extraction, and the stages that follow it. */
#ifndef CUBEWRIGHT_PIPELINE_H
#define CUBEWRIGHT_PIPELINE_H

#include <cubewright/atlas.h>
#include <cubewright/bake.h>
#include <cubewright/color.h>
#include <cubewright/cut.h>
#include <cubewright/engrave.h>
#include <cubewright/extract.h>
#include <cubewright/handles.h>
#include <cubewright/labels.h>
#include <cubewright/quality.h>
#include <cubewright/simplify.h>
#include <cubewright/smooth.h>
#include <cubewright/spool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The stages: constant, and name. They run in this order, but that handles are closed between
 * CW_STAGE_FILL_VOIDS and CW_STAGE_SMOOTH, text is engraved between CW_STAGE_CUT and CW_STAGE_SIMPLIFY, texture
 * coordinates are made between CW_STAGE_LOD and CW_STAGE_NORMALS, which parts at creases next, and maps are baked
 * between CW_STAGE_COLOR and CW_STAGE_CHECK. One that a later version adds gets the next number, wherever it runs. */
#define CW_STAGE_TABLE(X)                                                                      \
    X(CW_STAGE_VIEWS, "camera")                                                                \
    X(CW_STAGE_EXTRACT, "extract")                                                             \
    X(CW_STAGE_MIN_VOLUME, "min_volume")                                                       \
    X(CW_STAGE_LARGEST, "largest")                                                             \
    X(CW_STAGE_FILL_VOIDS, "fill_voids")                                                       \
    X(CW_STAGE_SMOOTH, "smooth")                                                               \
    X(CW_STAGE_CUT, "cut_plane")                                                               \
    X(CW_STAGE_SIMPLIFY, "simplify")                                                           \
    X(CW_STAGE_CULL, "cull")                                                                   \
    X(CW_STAGE_LOD, "lod")                                                                     \
    X(CW_STAGE_NORMALS, "normals")                                                             \
    X(CW_STAGE_COLOR, "color_by")                                                              \
    X(CW_STAGE_CHECK, "check")                                                                 \
    X(CW_STAGE_HANDLES, "close_handles")                                                       \
    X(CW_STAGE_ATLAS, "uv")                                                                    \
    X(CW_STAGE_MAPS, "maps")                                                                   \
    X(CW_STAGE_CREASES, "crease_angle")                                                        \
    X(CW_STAGE_ENGRAVE, "engrave")

/* Identifies a stage. */
typedef enum cw_stage {
#define CW_X(name, text) name,
    CW_STAGE_TABLE(CW_X)
#undef CW_X
        CW_STAGE_COUNT
} cw_stage;

/* Returns the name of a stage, such as "fill_voids"; static. NULL for an unknown one.
 * stage  any number */
CW_API const char *cw_stage_name(cw_stage stage);

/* Where a surface comes from. Which stages may follow depends on it. */
typedef enum cw_surface_source {
    CW_SOURCE_MEMORY, /* a volume in memory */
    CW_SOURCE_SLICES, /* slices that are read one after the other: the surface is never whole */
    CW_SOURCE_PARTS,  /* parts of a surface, by several processes, joined later */
    CW_SOURCE_LABELS, /* a label map: several surfaces that share their interfaces */
    CW_SOURCE_MESH,   /* a mesh that is there: nothing is extracted */
    CW_SOURCE_COUNT
} cw_surface_source;

/* How vertices get their colours: from the values of a volume. */
typedef struct cw_pipeline_color {
    /* Sets *volume to the volume, which is borrowed until the pipeline ends. It is called when the
     * surface is there, so that both need not be in memory while that is made. */
    cw_status (*open)(void *user, const cw_volume **volume, cw_error *err);
    void *user;       /* passed to open */
    cw_colormap map;  /* default: viridis */
    bool has_range;   /* default: the ends of the map are the lowest and highest value found */
    double low, high; /* values of its ends, with has_range */
} cw_pipeline_color;

/* Watches a run. Zeroed, nothing does. */
typedef struct cw_pipeline_watch {
    /* A stage begins, on `count` things named by `unit`: "voxel", "triangle" or "vertex". Returns
     * the progress that it reports to. NULL: all report to that of desc->extract */
    cw_progress (*begin)(void *user, cw_stage stage, size_t count, const char *unit);
    /* A stage has ended. May be NULL */
    void (*end)(void *user, cw_stage stage, size_t triangles_before, size_t triangles_after);
    void *user; /* passed to both */
} cw_pipeline_watch;

/* Settings of a surface. Zero-initialise the struct and set what you need; a stage whose field is
 * zero does not run. All pointers are borrowed until the call returns. */
typedef struct cw_pipeline_desc {
    uint32_t version;        /* 0: the first version of this struct */
    cw_extract_desc extract; /* its threads and progress are those of all stages */
    double min_volume_mm3;   /* leave out components that enclose less */
    size_t largest;          /* components to keep, those that enclose the most; default: all */
    bool fill_voids;         /* leave out the cavities of solids, and what is in them */
    const cw_smooth_desc *smooth;     /* smooth the surface */
    const cw_cut_desc *cut;           /* cut it by a plane */
    const cw_simplify_desc *simplify; /* simplify it, for these views instead of its own: */
    cw_simplify_view *views; /* view_count; their depths are replaced, and stay: free them
                                       with cw_simplify_view_free() */
    size_t view_count;       /* default: no views */
    bool cull;               /* leave out what none of the views sees */
    const size_t *lod;       /* lod_count triangle counts, falling: levels of detail */
    size_t lod_count;        /* default: no levels, but one surface */
    const cw_pipeline_color *color; /* colour its vertices */
    bool check;                     /* measure it: facts.quality */
    size_t layers;           /* of slices that are extracted together; as cw_stream_desc */
    const char *spool_path;  /* of slices: temporary files stand in the folder of this path */
    cw_pipeline_watch watch; /* default: none */
    const cw_close_handles_desc *close_handles; /* close its small handles and tunnels */
    const cw_atlas_desc
        *atlas;               /* give it texture coordinates; levels of detail share a square */
    const cw_bake_desc *bake; /* bake maps of the surface before simplify or lod; needs atlas.
                                   Size and margin are those of the atlas */
    double
        crease_degrees; /* let normals part at edges with a larger angle: cw_mesh_crease_normals() */
    bool crease_caps; /* the same where caps close the surface at the end of the volume */
    const cw_engrave_desc *engrave; /* engrave a text; its threads and progress are not used */
} cw_pipeline_desc;

/* Results of the stages that ran; those of others are zero. Zero-initialise the struct before it is
 * filled. */
typedef struct cw_pipeline_facts {
    uint32_t version;               /* 0: the first version of this struct */
    unsigned ran;                   /* a bit 1u << stage for each stage that ran */
    cw_extract_counts extracted;    /* of the surface as it came from the volume */
    cw_drop_counts small;           /* CW_STAGE_MIN_VOLUME */
    cw_drop_counts others;          /* CW_STAGE_LARGEST */
    cw_drop_counts voids;           /* CW_STAGE_FILL_VOIDS */
    cw_smooth_facts smoothed;       /* CW_STAGE_SMOOTH */
    cw_cut_facts cut;               /* CW_STAGE_CUT */
    size_t culled;                  /* triangles: CW_STAGE_CULL */
    size_t voxels, seen_voxels;     /* of all, and of the bricks that the views see */
    cw_sample_facts color;          /* CW_STAGE_COLOR: of the surface given away last */
    double color_low, color_high;   /* the ends of its map */
    cw_quality quality;             /* CW_STAGE_CHECK: of the surface given away last */
    cw_close_handles_facts handles; /* CW_STAGE_HANDLES */
    cw_atlas_facts atlas;           /* CW_STAGE_ATLAS: of the surface, or of all levels */
    cw_bake_facts baked;            /* CW_STAGE_MAPS: the same */
    size_t creases;            /* edges: CW_STAGE_CREASES, of the surface given away last */
    cw_engrave_facts engraved; /* CW_STAGE_ENGRAVE */
} cw_pipeline_facts;

/* A finished surface, or a level of detail. */
typedef struct cw_pipeline_surface {
    cw_mesh *mesh; /* to take it, move the struct and zero it; NULL: it is in the spool */
    cw_mesh_spool *spool; /* of slices; NULL else. To take it, set it to NULL */
    size_t level;         /* of detail, from 0 */
    size_t layer;         /* of labels, from 0 */
    uint32_t label;       /* of labels: whose surface it is */
    cw_mesh *
        full; /* of levels, with maps, and of simplified labels: the surface that it was made of; else NULL */
    /* CW_MAP_COUNT images, of the surface or of all its levels. Those that were not
     * baked have no pixels. Borrowed until the pipeline ends; NULL: there are none */
    const cw_image *maps;
} cw_pipeline_surface;

/* Receives finished surfaces, one after the other. A status other than CW_OK stops the pipeline,
 * which returns it. */
typedef struct cw_pipeline_sink {
    cw_status (*take)(void *user, cw_pipeline_surface *surface, const cw_pipeline_facts *facts,
                      cw_error *err); /* on the calling thread */
    void *user;                       /* passed to take */
} cw_pipeline_sink;

/* Returns the stages that the settings ask for, a bit 1u << stage for each.
 * desc  borrowed; NULL, and a version that this library does not know, ask for none */
CW_API unsigned cw_pipeline_stages(const cw_pipeline_desc *desc);

/* Finds out whether stages go together, on a source: some need the whole surface in memory, some
 * a single surface, and a culled surface is no longer closed.
 *
 * source   where the surface comes from
 * stages   as of cw_pipeline_stages()
 * first, second  set to the stages that exclude each other, or to one stage twice that the
 *          source excludes; may be NULL
 * Returns  CW_ERR_ARGUMENT naming them and the reason */
CW_NODISCARD CW_API cw_status cw_pipeline_check(cw_surface_source source, unsigned stages,
                                                cw_stage *first, cw_stage *second,
                                                cw_error *err);

/* Makes the surface of a volume at an isovalue, runs the stages of CW_STAGE_TABLE that the settings
 * ask for, and gives the result away: one surface, or each level of detail.
 *
 * Where it can, a surface is simplified slab by slab while it is extracted, and is never whole.
 * A simplified surface gets normals of the field, unless it was smoothed, cut or engraved, or
 * its handles were closed. Levels of detail share the square of their texture coordinates, each with
 * half of the texels for a mm of the one before, and so their maps. With maps their triangles go where
 * normals bend, too (cw_simplify_desc.normal_weight).
 *
 * volume     borrowed; as in cw_extract()
 * extractor  of this volume, for one of several surfaces; NULL: this one by itself
 * desc       borrowed
 * sink       takes the result; without it, use cw_pipeline_mesh()
 * facts      filled as far as its version goes; may be NULL
 *
 * Returns  CW_ERR_EMPTY  no surface at this isovalue, with the range of the values; or nothing is
 *                        left of it after a stage; or as cw_pipeline_check(), as the functions
 *                        of the stages, and as sink
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_pipeline_run(const cw_volume *volume, cw_extractor *extractor,
                                              const cw_pipeline_desc *desc,
                                              cw_pipeline_sink sink, cw_pipeline_facts *facts,
                                              cw_error *err);

/* Does the same for one surface, and fills a mesh with it.
 * desc     borrowed; lod_count is 0, and bake NULL
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    as in cw_pipeline_run()
 * Returns  as cw_pipeline_run() */
CW_NODISCARD CW_API cw_status cw_pipeline_mesh(const cw_volume *volume, cw_extractor *extractor,
                                               const cw_pipeline_desc *desc, cw_mesh *mesh,
                                               cw_pipeline_facts *facts, cw_error *err);

/* Does the same from slices: the result is in a spool, or simplified in memory.
 *
 * source   borrowed; as in cw_extract_stream()
 * desc     extract.max_bytes limits the memory for slices, components and check together
 * sink     takes the result
 * facts    as in cw_pipeline_run()
 * Returns  as cw_pipeline_run(), cw_extract_stream(), cw_mesh_spool_new() */
CW_NODISCARD CW_API cw_status cw_pipeline_run_slices(const cw_slice_source *source,
                                                     const cw_pipeline_desc *desc,
                                                     cw_pipeline_sink sink,
                                                     cw_pipeline_facts *facts, cw_error *err);

/* Runs the stages on a copy of a mesh, in place of the surface of a volume. Stages that need voxels are
 * refused. A result without normals gets those of the triangles around its vertices, unless
 * desc->extract.no_normals.
 *
 * mesh     borrowed
 * desc     borrowed; of extract only no_normals, threads and progress count
 * sink     takes the result
 * facts    as in cw_pipeline_run(); extracted.triangles are those of the mesh
 * Returns  CW_ERR_EMPTY  the mesh has no triangles; or as cw_pipeline_check(), as the functions of the
 *                        stages, and as sink
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_pipeline_run_mesh(const cw_mesh *mesh,
                                                   const cw_pipeline_desc *desc,
                                                   cw_pipeline_sink sink,
                                                   cw_pipeline_facts *facts, cw_error *err);

/* The interfaces of label maps, and the labels whose surfaces are to be finished. */
typedef struct cw_pipeline_labels {
    /* layer_count, such as of cw_extract_labels(); they are simplified in place */
    cw_label_surfaces *const *layers;
    size_t layer_count; /* 1, or more where labels overlap */
    bool apart; /* simplify each label by itself: interfaces then part. Default: together */
    bool interfaces_only; /* stop when the interfaces are finished: no surface is given away */
    /* Returns false for labels that are left out. Default: none is */
    bool (*wants)(void *user, size_t layer, uint32_t label);
    void *user; /* passed to wants */
} cw_pipeline_labels;

/* Finishes the surfaces of labels: simplifies all interfaces together, makes the closed mesh of each
 * label, and gives one after the other away. Of several levels of detail each is made from the one
 * before; the layers then are those of the last.
 *
 * Stages that need a single surface are refused. Of desc->simplify error_mm and triangles count: the
 * number of triangles is that of all interfaces, or with `apart` of all surfaces. Vertices get normals
 * of the triangles around them, unless desc->extract.no_normals.
 *
 * labels   borrowed
 * desc     borrowed; of extract only no_normals, threads and progress count
 * sink     takes the surfaces, by level, layer and label
 * facts    as in cw_pipeline_run(); extracted.triangles are those before simplification
 * Returns  as cw_pipeline_check(), cw_label_simplify(), cw_simplify(), cw_label_mesh(), and as sink
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_pipeline_run_labels(const cw_pipeline_labels *labels,
                                                     const cw_pipeline_desc *desc,
                                                     cw_pipeline_sink sink,
                                                     cw_pipeline_facts *facts, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
