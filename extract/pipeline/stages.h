/* Declares the stages of the pipeline: a stage is a row of the recipe in stages.c and a function. */
#ifndef EXTRACT_PIPELINE_STAGES_H
#define EXTRACT_PIPELINE_STAGES_H

#include <cubewright/pipeline.h>

/* Needs of a stage, and sources beside a volume and its slices that it is made for. Without any, it
 * takes a mesh in memory or, of slices, the spool of the run. */
enum {
    CWI_WHOLE_MESH = 1,  /* the whole surface in memory */
    CWI_SPOOL = 2,       /* the whole surface: in memory or in the spool */
    CWI_VOXELS = 4,      /* the volume that it came from, in memory */
    CWI_CLOSED = 8,      /* no part of it was left out that cameras do not see */
    CWI_ON_LABELS = 16,  /* made for labels, which share their interfaces: see run_labels.c */
    CWI_ON_PARTS = 32,   /* made for parts: they or what joins them do it, not the pipeline */
    CWI_OR_REDUCED = 64, /* or what simplification left of slices, which is in memory */
};

/* Properties of a surface that a stage spoils. */
enum {
    CWI_FIELD_NORMALS = 1, /* normals of the field are no longer those of the surface */
    CWI_CLOSEDNESS = 2,    /* it is open */
};

/* A run of the pipeline: the surface and what is known of it. */
typedef struct cwi_pipeline {
    const cw_pipeline_desc *desc;
    cw_simplify_desc simplify;     /* with the views and the threads of the run */
    const cw_volume *volume;       /* in memory; or NULL */
    cw_volume part;                /* of the volume: what the views may see; else all of it */
    cw_extractor *extractor;       /* of the volume; or NULL */
    const cw_slice_source *slices; /* or NULL */
    const cw_pipeline_labels *labels; /* or NULL */
    const cw_mesh *given;             /* the surface itself; or NULL */
    cw_mesh mesh;
    cw_mesh_spool *spool;           /* the surface, of slices; or NULL */
    cw_mesh full;                   /* with maps: the surface before it was simplified */
    cw_label_surfaces *full_labels; /* of each layer, before it was simplified; or NULL */
    cw_mesh *levels;                /* lod_count; NULL: there is one surface */
    cw_image maps[CW_MAP_COUNT];    /* of CW_STAGE_MAPS */
    bool is_simplified;             /* while it was extracted */
    bool is_checked;                /* the same */
    bool needs_whole;               /* before it is simplified */
    bool adds_normals;              /* those of the field, to finished surfaces */
    /* Makes the surface without what simplifies, colours or measures it. mesh: filled on success */
    cw_status (*make_full)(const struct cwi_pipeline *p, const cw_volume *volume,
                           bool no_normals, cw_mesh *mesh, cw_error *err);
    cw_pipeline_facts facts;
} cwi_pipeline;

/* A stage. */
typedef struct cwi_stage {
    cw_stage stage;
    bool (*is_wanted)(const cw_pipeline_desc *desc);
    unsigned needs, spoils;
    /* Works on each finished surface: those of levels of detail, too. */
    bool finishes;
    cw_status (*run)(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
} cwi_stage;

/* The stages in the order in which they run. */
extern const cwi_stage cwi_recipe[CW_STAGE_COUNT];

/* Returns what the wanted stages spoil. */
unsigned cwi_spoils(const cw_pipeline_desc *desc);

/* Returns true if the surface is needed as a whole before it can be simplified. */
bool cwi_needs_whole(const cw_pipeline_desc *desc);

/* Reports the begin of a stage. Returns its progress. */
static inline cw_progress cwi_begin_stage(const cwi_pipeline *p, cw_stage stage, size_t count,
                                          const char *unit)
{
    const cw_pipeline_watch *w = &p->desc->watch;
    return w->begin ? w->begin(w->user, stage, count, unit) : p->desc->extract.progress;
}

/* Checks the settings, and sets what follows from them. */
CW_NODISCARD cw_status cwi_begin_pipeline(cwi_pipeline *p, cw_surface_source source,
                                          cw_pipeline_sink sink, cw_error *err);

/* Runs the pipeline, and frees what it holds. */
CW_NODISCARD cw_status cwi_start_pipeline(cwi_pipeline *p, cw_surface_source source,
                                          cw_pipeline_sink sink, cw_pipeline_facts *facts,
                                          cw_error *err);

/* Finishes a surface by the stages that do, and gives it away. */
CW_NODISCARD cw_status cwi_finish_surface(cwi_pipeline *p, cw_pipeline_surface *surface,
                                          cw_pipeline_sink sink, cw_error *err);

/* Copies the facts that the version of the caller's struct has. facts: NULL: nothing is copied */
void cwi_give_facts(const cwi_pipeline *p, cw_pipeline_facts *facts);

/* Fails with CW_ERR_EMPTY if all components are small. */
CW_NODISCARD cw_status cwi_expect_kept(const cwi_pipeline *p, cw_error *err);

/* The functions of the rows, each in a file of its own or with its like. */
cw_status cwi_draw_views(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_extract_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_copy_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_extract_slices(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_drop_small(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_keep_largest(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_fill_voids(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_close_handles(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_smooth(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_cut_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_engrave_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_simplify_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_cull_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_make_levels(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_lay_flat(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_add_normals(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_part_normals(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_color_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_bake_maps(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);
cw_status cwi_check_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err);

#endif
